//! How well was a tether angle held? Against the truth, as `flight` section 7 counts.

use super::DT;
use super::Spread;
use crate::plant::Plant;
use serde::Serialize;
use tautline_firmware::estimate::tether_angle::plane_angles;
use tautline_firmware::frames::World;
use tautline_firmware::vehicle::StepOutput;

/// Time after entering the mode that is not scored, s.
const SETTLING: f64 = 4.0;
/// Lost: slack for so long, s.
const SLACK_TIME: f64 = 1.0;

/// Collects during a flight.
#[derive(Clone, Debug, Default)]
pub struct AngleMetrics {
    time: f64,
    slack: f64,
    /// Estimate and tracking, each in both planes.
    spreads: [[Spread; 2]; 2],
    tension: Spread,
    sums: [f64; 2],
    count: f64,
    /// Why the vehicle counts as lost.
    pub lost: Option<&'static str>,
}

/// The worse plane's figures.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct AngleFlightSummary {
    /// Estimated against true tether angle, RMS, rad.
    pub estimate_rms_rad: f64,
    /// True tether angle against its reference, RMS, rad.
    pub tracking_rms_rad: f64,
    /// Mean of the estimate's error in the plane of North, rad.
    pub bias_rad: f64,
    /// Estimated against true tension, N.
    pub tension_rms_n: f64,
}

impl AngleMetrics {
    /// One millisecond.
    pub fn step(&mut self, out: &StepOutput, plant: &Plant) {
        let (Some(angle), Some(reference)) = (&out.angle, &out.reference) else {
            self.time = 0.0;
            return;
        };
        self.time += DT;
        self.slack = if plant.tether.tension() < 0.05 { self.slack + DT } else { 0.0 };
        if self.slack > SLACK_TIME {
            self.lost.get_or_insert("slack for over a second");
        }
        if self.time < SETTLING {
            return;
        }
        let truth = plane_angles(&World(plant.end()));
        let estimate = angle.angles().map(f64::from);
        let setpoint = plane_angles(&World(reference.position.0.map(f64::from)));
        let [estimates, trackings] = &mut self.spreads;
        for (i, truth) in truth.into_iter().enumerate() {
            let pick = |x: [f64; 2]| x.get(i).copied().unwrap_or(0.0);
            let off = pick(estimate) - truth;
            if let (Some(e), Some(t), Some(sum)) =
                (estimates.get_mut(i), trackings.get_mut(i), self.sums.get_mut(i))
            {
                e.add(off);
                t.add(truth - pick(setpoint));
                *sum += off;
            }
        }
        self.count += 1.0;
        self.tension.add(f64::from(angle.tension) - plant.tether.tension());
    }

    /// The figures; `None` if the mode was not flown for long.
    #[must_use]
    pub fn summary(&self) -> Option<AngleFlightSummary> {
        let worse = |spreads: &[Spread; 2]| {
            spreads.iter().map(Spread::rms).try_fold(0.0, |worst: f64, x| Some(worst.max(x?)))
        };
        let [estimate, tracking] = &self.spreads;
        let [bias, _] = self.sums;
        Some(AngleFlightSummary {
            estimate_rms_rad: worse(estimate)?,
            tracking_rms_rad: worse(tracking)?,
            bias_rad: bias / self.count,
            tension_rms_n: self.tension.rms()?,
        })
    }
}
