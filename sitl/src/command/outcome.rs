//! How a flight ended, in a few lines.

use crate::flight::FlightVerdict;
use std::fmt::Write;

/// A table of what the flight has; nothing of a vehicle that never left the ground.
pub fn table(verdict: &FlightVerdict) -> String {
    let mut lines = Vec::new();
    let mut row = |name: &str, text: String| lines.push(format!("  {name:<12} {text}"));
    let rms = |x: Option<f64>, unit: &str| x.map(|x| format!("{x:.2} {unit}"));
    let pair = |[a, b]: [Option<String>; 2]| {
        let parts: Vec<_> = [a, b].into_iter().flatten().collect();
        (!parts.is_empty()).then(|| parts.join(", "))
    };
    row("flown", {
        let tilt = verdict.max_tilt_rad.to_degrees();
        format!("up to {:.1} m, tilt up to {tilt:.0} deg", verdict.max_height_m)
    });
    if let Some(text) = pair([
        rms(verdict.hold_horizontal_rms_m, "m level"),
        rms(verdict.hold_vertical_rms_m, "m in height"),
    ]) {
        row("hold, RMS", text);
    }
    if let Some(text) = pair([
        rms(verdict.estimate_error_rms_m, "m"),
        rms(verdict.tension_error_rms_n, "N of tension"),
    ]) {
        row("errors, RMS", text);
    }
    if let Some(sink) = verdict.touch_down_mps {
        let mut text = format!("{sink:.2} m/s down");
        if let Some(aside) = verdict.touch_down_sideways_mps {
            let _ = write!(text, ", {aside:.2} m/s sideways");
        }
        let _ = write!(text, ", {:.1} m from the pad", verdict.distance_from_pad_m);
        row("touch-down", text);
    }
    if !verdict.failures.is_empty() {
        row("failures", verdict.failures.join(", "));
    }
    let state = if verdict.armed { "armed" } else { "disarmed" };
    row("at the end", format!("{}, {state}", verdict.final_mode));
    lines.join("\n")
}
