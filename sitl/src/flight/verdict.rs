//! One flight in a few lines: what a script wants to know of it, all from the truth but the vehicle's own words.

use super::{Flight, Progress};
use crate::metrics::Summary;
use serde::Serialize;
use std::io::Write;
use tautline_firmware::signal::Severity;

/// A flight's `--json`: one object, its keys end in their units.
#[derive(Clone, Debug, Serialize)]
pub struct FlightVerdict {
    /// Why the vehicle counts as lost.
    pub lost: Option<&'static str>,
    /// At the end.
    pub armed: bool,
    /// The last time; `None` while armed at the end, or if it never was.
    pub disarmed_at_s: Option<f64>,
    /// Sink rate at the last first contact after flight.
    pub touch_down_mps: Option<f64>,
    /// Level speed over the ground there.
    pub touch_down_sideways_mps: Option<f64>,
    /// Largest.
    pub max_tilt_rad: f64,
    /// Over the ground.
    pub max_height_m: f64,
    /// Level, from where it stood at the start to where it is at the end.
    pub distance_from_pad_m: f64,
    /// From the reference, while the mission holds.
    pub hold_horizontal_rms_m: Option<f64>,
    /// From the reference, while the mission holds.
    pub hold_vertical_rms_m: Option<f64>,
    /// Of the estimated position in the air, all three coordinates.
    pub estimate_error_rms_m: Option<f64>,
    /// Of the estimated tension in the air.
    pub tension_error_rms_n: Option<f64>,
    /// As ground stations show it.
    pub final_mode: &'static str,
    /// Rows of the failsafe table that were active while armed, each once, in the order they came.
    pub failures: Vec<&'static str>,
    /// What the operator was told.
    pub texts: Vec<String>,
}

impl<W: Write> Flight<W> {
    /// The flight so far.
    #[must_use]
    pub fn verdict(&self) -> FlightVerdict {
        let Summary { lost, hold_horizontal_rms_m, hold_vertical_rms_m, .. } =
            self.metrics.summary();
        let (out, touched) = (self.output(), &self.metrics.verdict);
        FlightVerdict {
            lost,
            armed: out.is_armed,
            disarmed_at_s: touched.disarmed_at.filter(|_| !out.is_armed),
            touch_down_mps: touched.touch_down,
            touch_down_sideways_mps: touched.touch_down_drift,
            max_tilt_rad: touched.tilt_max,
            max_height_m: touched.highest,
            distance_from_pad_m: touched.off_pad,
            hold_horizontal_rms_m,
            hold_vertical_rms_m,
            estimate_error_rms_m: self.metrics.estimate.rms(),
            tension_error_rms_n: self.metrics.tension.rms(),
            final_mode: out.mode.rule().name,
            failures: touched.failures.clone(),
            texts: self.events.iter().map(|(_, event)| event.to_string()).collect(),
        }
    }

    /// Why this was no whole flight: the vehicle was lost, or its mission was not flown. `None` while it is under way,
    /// unless arming was refused.
    #[must_use]
    pub fn shortcoming(&self) -> Option<String> {
        if let Some(why) = self.metrics.verdict.lost {
            return Some(format!("lost: {why}"));
        }
        let never = |why: &str| format!("never armed: {why}");
        match self.mission.progress() {
            Progress::Done => None,
            Progress::Flying => self.denial().map(never),
            // Parameters that do not go together refuse in words of their own.
            Progress::Failed(why) => {
                let refusal = self.denial().or_else(|| self.last_warning());
                let is_grounded = !self.metrics.verdict.has_armed;
                Some(refusal.filter(|_| is_grounded).map_or_else(|| why.clone(), never))
            }
        }
    }

    /// What kept the vehicle on the ground, if a check did and it never armed.
    fn denial(&self) -> Option<&'static str> {
        let is_grounded = !self.metrics.verdict.has_armed;
        let mut told = self.events.iter().rev().filter(|_| is_grounded);
        told.find_map(|(_, event)| event.text.strip_prefix(DENIED))
    }

    fn last_warning(&self) -> Option<&'static str> {
        let mut told = self.events.iter().rev().map(|(_, event)| event);
        told.find(|event| event.severity <= Severity::Warning).map(|event| event.text)
    }
}

/// Begins every check's refusal to arm.
const DENIED: &str = "Arming denied: ";
