//! How well is the place known and kept in Tether Hold, and does the estimate know how well? As `fullstate` sections 13
//! and 26 count: the error of all three coordinates, moves included.

use super::{DT, Spread};
use crate::plant::Plant;
use serde::Serialize;
use tautline_firmware::supervisor::{GroundState, Mode};
use tautline_firmware::vehicle::StepOutput;

/// An error within so many of its standard deviations is what was promised.
const PROMISE: f64 = 2.0;
/// Of the azimuth's low-pass, s.
const MEAN_TIME: f64 = 60.0;
/// Nearly overhead there is no azimuth: level share of the distance.
const OVERHEAD: f64 = 0.2;
/// The heading's standard deviation from which the operator is told, rad.
const UNSURE: f32 = 0.087;

/// Collects during a flight.
#[derive(Clone, Debug, Default)]
pub struct PlaceMetrics {
    estimate: Spread,
    tracking: Spread,
    tension: Spread,
    yaw: Spread,
    azimuth: Spread,
    /// Low-passed azimuth error, rad.
    mean_azimuth: Option<f64>,
    /// While nobody said that the heading is unsure.
    unnoticed: Spread,
    /// Level error over its standard deviation.
    ratio: Spread,
    kept: [u64; 2],
    count: u64,
    restarts: u16,
}

/// Over all of Tether Hold in the air.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct PlaceSummary {
    /// Estimate against truth, three coordinates, RMS, m.
    pub estimate_rms_m: f64,
    /// Truth against reference, RMS, m.
    pub tracking_rms_m: f64,
    /// Estimated against true tension, RMS, N.
    pub tension_rms_n: f64,
    /// Estimated against true heading, RMS, rad.
    pub yaw_rms_rad: f64,
    /// Largest error of the azimuth from the anchor, low-passed over a minute, rad; and, not low-passed, while the estimate took its heading for better than 5 degrees.
    pub azimuth_max_rad: f64,
    /// See above.
    pub azimuth_unnoticed_max_rad: f64,
    /// Mean square of a level coordinate's error over its variance.
    pub error_over_variance: f64,
    /// Share of the time in which the level and the vertical error lie within two of their standard deviations.
    pub kept: [f64; 2],
    /// Times the filter began anew.
    pub restarts: u16,
}

impl PlaceMetrics {
    /// Once in a while.
    pub fn step(&mut self, out: &StepOutput, plant: &Plant) {
        self.restarts = self.restarts.max(out.estimate.restarts);
        let (Some(position), Some(tether)) = (&out.estimate.position, &out.estimate.tether) else {
            return;
        };
        let (Some(reference), GroundState::InAir, Mode::TetherHold) =
            (&out.reference, out.ground, out.mode)
        else {
            return;
        };
        let truth = plant.from_anchor();
        let error = position.0.map(f64::from) - truth;
        let deviation = out.estimate.position_sd.map(f64::from);
        self.estimate.add(error.norm());
        self.tracking.add((truth - reference.position.0.map(f64::from)).norm());
        self.tension.add(f64::from(tether.tension) - plant.tether.tension());
        let yaw = f64::from(out.estimate.attitude.euler().2) - plant.body.attitude.euler_angles().2;
        self.yaw.add(turned(yaw));
        let place = truth + error;
        let azimuth = turned(place.y.atan2(place.x) - truth.y.atan2(truth.x));
        if truth.x.hypot(truth.y) > OVERHEAD * truth.norm() {
            let mean = self.mean_azimuth.get_or_insert(azimuth);
            *mean += turned(azimuth - *mean) * DT / MEAN_TIME;
            self.azimuth.add(turned(*mean));
            if out.estimate.heading_sd < UNSURE {
                self.unnoticed.add(azimuth);
            }
        }
        self.ratio.add(error.x / deviation.x);
        self.ratio.add(error.y / deviation.y);
        let [level, vertical] = &mut self.kept;
        *level += u64::from(error.x.hypot(error.y) <= PROMISE * deviation.x.hypot(deviation.y));
        *vertical += u64::from(error.z.abs() <= PROMISE * deviation.z);
        self.count += 1;
    }

    /// The figures; `None` if the mode was not flown.
    #[must_use]
    pub fn summary(&self) -> Option<PlaceSummary> {
        Some(PlaceSummary {
            estimate_rms_m: self.estimate.rms()?,
            tracking_rms_m: self.tracking.rms()?,
            tension_rms_n: self.tension.rms()?,
            yaw_rms_rad: self.yaw.rms()?,
            azimuth_max_rad: self.azimuth.max,
            azimuth_unnoticed_max_rad: self.unnoticed.max,
            error_over_variance: self.ratio.rms()?.powi(2),
            kept: self.kept.map(|kept| kept as f64 / self.count as f64),
            restarts: self.restarts,
        })
    }
}

/// Into ±π.
fn turned(angle: f64) -> f64 {
    angle.sin().atan2(angle.cos())
}
