//! How well was a load balanced? Against the truth.

use super::DT;
use crate::plant::{Plant, RodPhase, V3};
use serde::Serialize;
use tautline_firmware::supervisor::Mode;
use tautline_firmware::vehicle::StepOutput;

/// After this time in the mode the load counts as settled, s.
const SETTLING: f64 = 10.0;
/// Collects during a flight.
#[derive(Clone, Debug, Default)]
pub struct PendulumMetrics {
    time: f64,
    sums: [f64; 4],
    count: f64,
    error_max: f64,
    tilt_max: f64,
    /// Why the load counts as lost.
    pub lost: Option<&'static str>,
}

/// Figures from the settling on; the tilt of all the time in the mode.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct PendulumFlightSummary {
    /// s in the mode.
    pub time_s: f64,
    /// Load from its reference, mean.
    pub load_error_mean_m: f64,
    /// Largest.
    pub load_error_max_m: f64,
    /// Rod's tilt from upright, largest.
    pub rod_tilt_max_rad: f64,
    /// Estimated against true rate of the rod, RMS.
    pub rod_rate_rms_rad_s: f64,
    /// Estimated against true disturbance, horizontal, RMS.
    pub disturbance_across_rms_n: f64,
    /// Vertical, RMS.
    pub disturbance_down_rms_n: f64,
}

impl PendulumMetrics {
    /// One look.
    pub fn step(&mut self, out: &StepOutput, plant: &Plant) {
        let Some(rod) = &plant.rod else { return };
        if rod.phase == RodPhase::Fallen {
            self.lost.get_or_insert("the rod fell");
        }
        let (Some(report), Mode::Pendulum) = (&out.pendulum, out.mode) else { return };
        let Some(reference) = &report.reference else { return };
        self.time += DT;
        self.tilt_max = self.tilt_max.max(rod.tilt());
        if self.time < SETTLING {
            return;
        }
        let setpoint = reference.position().0.map(f64::from);
        let error = (rod.load(&plant.body.position) - setpoint).norm();
        let push = plant.push.as_ref().map_or(V3::zeros(), |push| push.force());
        let off = report.estimate.disturbance.0.map(f64::from) - push;
        let rate = report.estimate.rod_rate.0.map(f64::from) - rod.rate;
        self.count += 1.0;
        self.error_max = self.error_max.max(error);
        let now = [error, rate.norm_squared(), off.xy().norm_squared(), off.z * off.z];
        self.sums.iter_mut().zip(now).for_each(|(sum, x)| *sum += x);
    }

    /// The figures; `None` if the mode was not flown for long.
    #[must_use]
    pub fn summary(&self) -> Option<PendulumFlightSummary> {
        if self.count < 1.0 {
            return None;
        }
        let [error, rate, across, down] = self.sums.map(|sum| sum / self.count);
        Some(PendulumFlightSummary {
            time_s: self.time,
            load_error_mean_m: error,
            load_error_max_m: self.error_max,
            rod_tilt_max_rad: self.tilt_max,
            rod_rate_rms_rad_s: rate.sqrt(),
            disturbance_across_rms_n: across.sqrt(),
            disturbance_down_rms_n: down.sqrt(),
        })
    }
}
