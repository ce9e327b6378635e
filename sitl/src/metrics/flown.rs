//! How well was it flown? Against the truth, not the estimate.

use super::angle::{AngleFlightSummary, AngleMetrics};
use super::pendulum::{PendulumFlightSummary, PendulumMetrics};
use super::place::{PlaceMetrics, PlaceSummary};
use super::taut::{TautMetrics, TautSummary};
use super::verdict::Verdict;
use super::{PERIOD, Spread};
use crate::plant::{Plant, V3};
use nalgebra::Rotation3;
use serde::Serialize;
use tautline_firmware::supervisor::{GroundState, Mode};
use tautline_firmware::vehicle::StepOutput;

/// Farther from the reference the vehicle counts as lost.
const LOST_DISTANCE: f64 = 8.0;
/// On a line so long that the same angle is more than that.
const LOST_SHARE: f64 = 0.25;

/// Collects during a flight.
#[derive(Clone, Debug, Default)]
pub struct Metrics {
    /// Horizontal distance from the reference while holding, m.
    pub hold_horizontal: Spread,
    /// Height error while holding, m.
    pub hold_vertical: Spread,
    /// Error of the position estimate in the air, m.
    pub estimate: Spread,
    /// Its horizontal part, m.
    pub estimate_horizontal: Spread,
    /// Angle between estimated and true attitude in the air, rad.
    pub attitude: Spread,
    /// The part of it that is roll and pitch, rad.
    pub tilt: Spread,
    /// Error of the tension estimate in the air, N.
    pub tension: Spread,
    /// How it came down, and why the vehicle counts as lost.
    pub verdict: Verdict,
    /// In Tether Hold.
    pub place: PlaceMetrics,
    /// In the taut-link modes.
    pub taut: TautMetrics,
    /// In Tether Angle.
    pub angle: AngleMetrics,
    /// In Pendulum.
    pub pendulum: PendulumMetrics,
    /// Largest squared-innovation ratios in the air: accelerometer, altitude, length.
    pub health_max: [f64; 3],
    steps: u32,
}

/// What goes into tables and JSON.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Horizontal, while holding.
    pub hold_horizontal_rms_m: Option<f64>,
    /// Largest.
    pub hold_horizontal_max_m: f64,
    /// Height, while holding.
    pub hold_vertical_rms_m: Option<f64>,
    /// Of the position estimate.
    pub estimate_horizontal_rms_m: Option<f64>,
    /// Of the whole attitude, yaw included.
    pub attitude_rms_rad: Option<f64>,
    /// Of roll and pitch.
    pub tilt_rms_rad: Option<f64>,
    /// Of the tension estimate.
    pub tension_rms_n: Option<f64>,
    /// Sink rate.
    pub touch_down_mps: Option<f64>,
    /// Horizontal speed.
    pub touch_down_drift_mps: Option<f64>,
    /// From where it stood to where it came down.
    pub touch_down_from_pad_m: Option<f64>,
    /// From the anchor, level.
    pub farthest_m: f64,
    /// Over the ground.
    pub highest_m: f64,
    /// Largest.
    pub tilt_max_rad: f64,
    /// Motors were allowed to turn at some time.
    pub has_armed: bool,
    /// In Tether Hold.
    pub place: Option<PlaceSummary>,
    /// In the taut-link modes.
    pub taut: Option<TautSummary>,
    /// In Tether Angle.
    pub angle: Option<AngleFlightSummary>,
    /// In Pendulum.
    pub pendulum: Option<PendulumFlightSummary>,
    /// Why lost.
    pub lost: Option<&'static str>,
}

impl Summary {
    /// With every figure that a flight can have: for who lists them.
    #[must_use]
    pub fn with_every_figure() -> Self {
        Self {
            hold_horizontal_rms_m: Some(0.0),
            hold_horizontal_max_m: 0.0,
            hold_vertical_rms_m: Some(0.0),
            estimate_horizontal_rms_m: Some(0.0),
            attitude_rms_rad: Some(0.0),
            tilt_rms_rad: Some(0.0),
            tension_rms_n: Some(0.0),
            touch_down_mps: Some(0.0),
            touch_down_drift_mps: Some(0.0),
            touch_down_from_pad_m: Some(0.0),
            farthest_m: 0.0,
            highest_m: 0.0,
            tilt_max_rad: 0.0,
            has_armed: false,
            place: Some(PlaceSummary::default()),
            taut: Some(TautSummary::default()),
            angle: Some(AngleFlightSummary::default()),
            pendulum: Some(PendulumFlightSummary::default()),
            lost: Some(""),
        }
    }
}

/// The estimate's rotation.
fn estimated(out: &StepOutput) -> Rotation3<f64> {
    let m = out.estimate.attitude.0.map(f64::from);
    Rotation3::from_matrix_unchecked(m)
}

impl Metrics {
    /// One millisecond; `is_holding` while a hold of the mission lasts. Contact is looked for in each, errors now
    /// and then.
    pub fn step(&mut self, out: &StepOutput, plant: &Plant, is_holding: bool) {
        let body = &plant.body;
        self.verdict.step(out, plant);
        let touches = plant.ground.is_touching();
        let in_air = matches!(out.ground, GroundState::InAir | GroundState::Landing) && !touches;
        self.steps = self.steps.wrapping_add(1);
        if !self.steps.is_multiple_of(PERIOD) {
            return;
        }
        self.place.step(out, plant);
        self.taut.step(out, plant);
        self.angle.step(out, plant);
        self.pendulum.step(out, plant);
        if let Some(why) = self.taut.lost.or(self.angle.lost).or(self.pendulum.lost) {
            self.verdict.lost.get_or_insert(why);
        }
        if !in_air {
            return;
        }
        let truth = body.attitude.to_rotation_matrix();
        let estimate = estimated(out);
        // By the chord: an arc cosine turns rounding into NaN where the two agree.
        let chord = (truth.matrix() - estimate.matrix()).norm() / 8.0_f64.sqrt();
        self.attitude.add(2.0 * chord.min(1.0).asin());
        let down = |r: &Rotation3<f64>| r.inverse() * V3::z();
        self.tilt.add(down(&truth).angle(&down(&estimate)));
        let health = &out.estimate.health;
        for (max, now) in
            self.health_max.iter_mut().zip([health.accel, health.altitude, health.length])
        {
            *max = max.max(f64::from(now));
        }
        if let Some(position) = out.estimate.position {
            let error = position.0.map(f64::from) - plant.from_anchor();
            self.estimate.add(error.norm());
            self.estimate_horizontal.add(error.x.hypot(error.y));
        }
        if let Some(tether) = out.estimate.tether {
            self.tension.add(f64::from(tether.tension) - plant.tether.tension());
        }
        if let Some(reference) = out.reference {
            let error = plant.from_anchor() - reference.position.0.map(f64::from);
            if is_holding {
                self.hold_horizontal.add(error.x.hypot(error.y));
                self.hold_vertical.add(error.z);
            }
            if error.norm() > LOST_DISTANCE.max(LOST_SHARE * plant.tether.length())
                && out.mode != Mode::Land
            {
                self.verdict.lost.get_or_insert("far from the reference");
            }
        }
    }

    /// The figures.
    #[must_use]
    pub fn summary(&self) -> Summary {
        Summary {
            hold_horizontal_rms_m: self.hold_horizontal.rms(),
            hold_horizontal_max_m: self.hold_horizontal.max,
            hold_vertical_rms_m: self.hold_vertical.rms(),
            estimate_horizontal_rms_m: self.estimate_horizontal.rms(),
            attitude_rms_rad: self.attitude.rms(),
            tilt_rms_rad: self.tilt.rms(),
            tension_rms_n: self.tension.rms(),
            touch_down_mps: self.verdict.touch_down,
            touch_down_drift_mps: self.verdict.touch_down_drift,
            touch_down_from_pad_m: self.verdict.from_pad,
            farthest_m: self.verdict.farthest,
            highest_m: self.verdict.highest,
            tilt_max_rad: self.verdict.tilt_max,
            has_armed: self.verdict.has_armed,
            place: self.place.summary(),
            taut: self.taut.summary(),
            angle: self.angle.summary(),
            pendulum: self.pendulum.summary(),
            lost: self.verdict.lost,
        }
    }
}
