//! One flight, judged: flown to its end, not lost, within all limits?

use crate::flight::{Flight, Progress};
use crate::metrics::Summary;
use crate::scenario::Scenario;
use serde::{Deserialize, Serialize};

/// Largest values; absent ones are only reported.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Limits {
    /// m.
    pub hold_horizontal_rms_m: Option<f64>,
    /// m.
    pub hold_vertical_rms_m: Option<f64>,
    /// m/s.
    pub touch_down_mps: Option<f64>,
    /// Sideways, m/s.
    pub touch_down_drift_mps: Option<f64>,
    /// From where it stood, m.
    pub touch_down_from_pad_m: Option<f64>,
    /// rad.
    pub tilt_max_rad: Option<f64>,
    /// rad.
    pub attitude_rms_rad: Option<f64>,
}

/// One flight.
#[derive(Clone, Debug, Serialize)]
pub struct Outcome {
    /// Its seed.
    pub seed: u64,
    /// The mission was flown to its end and the vehicle was not lost.
    pub complete: bool,
    /// Within all limits.
    pub pass: bool,
    /// Why not, if not.
    pub reason: String,
    /// Figures.
    #[serde(flatten)]
    pub summary: Summary,
}

/// Longest flight, simulated s.
pub(super) const LONGEST: f64 = 600.0;

/// One flight, checked.
#[must_use]
pub fn fly(scenario: &Scenario, seed: u64, limits: &Limits) -> Outcome {
    let flight = scenario.params().and_then(|params| Flight::unrecorded(scenario, params, seed));
    let mut flight = match flight {
        Ok(flight) => flight,
        Err(e) => {
            let summary = crate::metrics::Metrics::default().summary();
            return Outcome { seed, complete: false, pass: false, reason: e.0, summary };
        }
    };
    flight.fly(LONGEST);
    let summary = flight.metrics.summary();
    let under_way = *flight.mission.progress() == Progress::Flying;
    let unfinished = || under_way.then(|| "not finished".to_owned());
    let mut reason = flight.shortcoming().or_else(unfinished).unwrap_or_default();
    let complete = reason.is_empty();
    let bounds = [
        ("hold_horizontal_rms_m", summary.hold_horizontal_rms_m, limits.hold_horizontal_rms_m),
        ("hold_vertical_rms_m", summary.hold_vertical_rms_m, limits.hold_vertical_rms_m),
        ("touch_down_mps", summary.touch_down_mps, limits.touch_down_mps),
        ("touch_down_drift_mps", summary.touch_down_drift_mps, limits.touch_down_drift_mps),
        ("touch_down_from_pad_m", summary.touch_down_from_pad_m, limits.touch_down_from_pad_m),
        ("tilt_max_rad", Some(summary.tilt_max_rad), limits.tilt_max_rad),
        ("attitude_rms_rad", summary.attitude_rms_rad, limits.attitude_rms_rad),
    ];
    for (name, value, limit) in bounds {
        if let (true, Some(limit)) = (complete, limit)
            && !value.is_some_and(|value| value <= limit)
        {
            reason = format!("{name} over {limit}");
        }
    }
    Outcome { seed, complete, pass: reason.is_empty(), reason, summary }
}
