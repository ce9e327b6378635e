//! How well was it flown in a taut-link mode? Against the truth, as `flight` section 7 counts.

use super::DT;
use super::Spread;
use crate::plant::{Plant, V3};
use serde::Serialize;
use tautline_firmware::supervisor::Mode;
use tautline_firmware::vehicle::StepOutput;

/// Time after entering the mode that is not scored, s, unless a flight says otherwise.
const SETTLING: f64 = 1.0;
/// The link force is scored as a mean over this time, s.
const FORCE_MEAN: f64 = 0.1;
/// Lost: so long without force, s; this far off in elevation or beside the heading, rad.
const SLACK_TIME: f64 = 1.0;
const ELEVATION_LOST: f64 = 34.0 * std::f64::consts::PI / 180.0;
const AZIMUTH_LOST: f64 = 57.0 * std::f64::consts::PI / 180.0;

/// Collects during a flight.
#[derive(Clone, Debug)]
pub struct TautMetrics {
    /// Time after entering the mode that is not scored, s.
    pub settling: f64,
    time: f64,
    elevation: Spread,
    second: Spread,
    estimate: Spread,
    azimuth: Spread,
    force: f64,
    slack: f64,
    /// Why the vehicle counts as lost.
    pub lost: Option<&'static str>,
}

/// What goes into tables and JSON.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct TautSummary {
    /// Elevation against its reference, rad.
    pub elevation_rms_rad: f64,
    /// rad.
    pub elevation_max_rad: f64,
    /// Link force, N, or pitch, rad, against its reference.
    pub second_rms: f64,
    /// N or rad.
    pub second_max: f64,
    /// Estimated against true elevation, rad.
    pub estimate_rms_rad: f64,
    /// Vehicle beside its heading, rad.
    pub azimuth_max_rad: f64,
}

impl Default for TautMetrics {
    fn default() -> Self {
        Self {
            settling: SETTLING,
            time: 0.0,
            elevation: Spread::default(),
            second: Spread::default(),
            estimate: Spread::default(),
            azimuth: Spread::default(),
            force: 0.0,
            slack: 0.0,
            lost: None,
        }
    }
}

impl TautMetrics {
    /// One look.
    pub fn step(&mut self, out: &StepOutput, plant: &Plant) {
        let tension = plant.tether.tension();
        self.force += (tension - self.force) * (DT / FORCE_MEAN);
        let (Some(reference), Some(taut)) = (out.taut_reference, out.taut) else {
            self.time = 0.0;
            return;
        };
        self.time += DT;
        let body = &plant.body;
        let end = plant.end();
        let elevation = (-end.z).atan2(end.x.hypot(end.y));
        let nose = body.attitude * V3::x();
        let heading = nose.y.atan2(nose.x);
        let beside = wrap(end.y.atan2(end.x) - heading);
        let [setpoint, ..] = reference.elevation.map(f64::from);
        let [second, ..] = reference.second.map(f64::from);
        let off = setpoint - elevation;

        self.slack = if tension.abs() < 0.05 { self.slack + DT } else { 0.0 };
        if self.slack > SLACK_TIME {
            self.lost.get_or_insert("slack for over a second");
        }
        if off.abs() > ELEVATION_LOST {
            self.lost.get_or_insert("elevation off by over 34 deg");
        }
        if beside.abs() > AZIMUTH_LOST {
            self.lost.get_or_insert("over 57 deg beside the heading");
        }
        if self.time < self.settling {
            return;
        }
        self.elevation.add(off);
        self.azimuth.add(beside);
        self.estimate.add(wrap(f64::from(taut.planar.elevation) - elevation));
        if out.mode == Mode::TautForce {
            self.second.add(second - self.force);
        } else {
            let (_, pitch, _) = body.attitude.euler_angles();
            self.second.add(second + pitch);
        }
    }

    /// The figures; `None` if no taut-link mode was flown.
    #[must_use]
    pub fn summary(&self) -> Option<TautSummary> {
        Some(TautSummary {
            elevation_rms_rad: self.elevation.rms()?,
            elevation_max_rad: self.elevation.max,
            second_rms: self.second.rms()?,
            second_max: self.second.max,
            estimate_rms_rad: self.estimate.rms()?,
            azimuth_max_rad: self.azimuth.max,
        })
    }
}

fn wrap(angle: f64) -> f64 {
    angle.sin().atan2(angle.cos())
}
