//! What a planar or spatial run of the tether-angle estimator is made of; `--set` paths are these keys.

use serde::{Deserialize, Serialize};
use tautline_firmware::control::TetherAngleLoop;
use tautline_firmware::estimate::tether_angle::TetherAngleUkf;
use tautline_firmware::model::TetherAngleModel;

/// From what the controller takes the state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AngleFeedback {
    /// The filter.
    #[default]
    Estimate,
    /// The truth.
    State,
}

/// How the anchor moves: a sine from rest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AnchorMotion {
    /// m; zero stays.
    pub amplitude: f64,
    /// s.
    pub period: f64,
}

impl AnchorMotion {
    /// Acceleration of `amplitude (1 - cos wt)`, m/s².
    #[must_use]
    pub fn accel(&self, time: f64) -> f64 {
        if self.amplitude == 0.0 || self.period <= 0.0 {
            return 0.0;
        }
        let w = std::f64::consts::TAU / self.period;
        -self.amplitude * w * w * (w * time).sin()
    }
}

/// Thrust that fails for a while.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ThrustDrop {
    /// s.
    pub from: f64,
    /// s.
    pub to: f64,
    /// What is left.
    pub share: f64,
}

/// Everything.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct AngleScenario {
    /// Tether, m.
    pub length: f64,
    /// As the algorithms believe, m.
    pub length_believed: f64,
    /// Commanded thrust over mass, m/s².
    pub thrust: f64,
    /// What the rotors give, m/s².
    pub thrust_true: f64,
    /// Thrust that fails for a while.
    pub drop: ThrustDrop,
    /// Attachment below the centre of mass, m.
    pub attachment: f64,
    /// Mass over moment of inertia, 1/m².
    pub mass_over_inertia: f64,
    /// Whether the attachment's torque is compensated.
    pub compensates: bool,
    /// Tether-angle references, deg, one after the other; in space two: along x and along y.
    pub reference: Vec<f64>,
    /// Duration of each, s.
    pub step: f64,
    /// Whole duration in space, s.
    pub duration: f64,
    /// First tether angle, deg; in space one for each plane.
    pub start: Vec<f64>,
    /// Error of the prior that picks the filter's first side, deg.
    pub prior_error: f64,
    /// In space: how well the first angles are known, deg; zero: not, the filters start from a reading.
    pub start_known: f64,
    /// White noise on the specific force before its filter, m/s².
    pub accel_noise: f64,
    /// Of that filter, s.
    pub accel_tau: f64,
    /// White noise on the gyro, rad/s.
    pub gyro_noise: f64,
    /// rad/s.
    pub gyro_bias: f64,
    /// Process noise of the filter, rad/s².
    pub sigma: f64,
    /// Tether time constant, s.
    pub tether_time: f64,
    /// Tether damping ratio.
    pub tether_damping: f64,
    /// Tilt time constant, s.
    pub tilt_time: f64,
    /// Tension guard, m/s²; zero: none.
    pub tension_min: f64,
    /// Largest tilt rate, rad/s.
    pub rate_max: f64,
    /// From what the controller takes the state.
    pub feedback: AngleFeedback,
    /// In space: each plane gets only its part of thrust and length.
    pub projects: bool,
    /// Anchor along x.
    pub anchor: AnchorMotion,
    /// Anchor along y, in space.
    pub anchor_y: AnchorMotion,
}

impl Default for AngleScenario {
    /// `inertial` section 7.
    fn default() -> Self {
        Self {
            length: 3.0,
            length_believed: 3.0,
            thrust: 12.0,
            thrust_true: 12.0,
            drop: ThrustDrop { from: 0.0, to: 0.0, share: 1.0 },
            attachment: 0.0,
            mass_over_inertia: 217.0,
            compensates: false,
            reference: vec![30.0, 45.0, 30.0, 45.0, 60.0, 45.0],
            step: 5.0,
            duration: 20.0,
            start: vec![30.0],
            prior_error: 0.0,
            start_known: 0.0,
            accel_noise: 2.0,
            accel_tau: 0.06,
            gyro_noise: 0.02,
            gyro_bias: 0.0,
            sigma: 0.005,
            tether_time: 0.6,
            tether_damping: 0.6,
            tilt_time: 0.16,
            tension_min: 1.5,
            rate_max: 6.0,
            feedback: AngleFeedback::Estimate,
            projects: true,
            anchor: AnchorMotion::default(),
            anchor_y: AnchorMotion::default(),
        }
    }
}

impl AngleScenario {
    /// `inertial` section 8: two planes at once.
    #[must_use]
    pub fn spatial(angle_x: f64, angle_y: f64) -> Self {
        Self {
            reference: vec![angle_x, angle_y],
            start: vec![angle_x.max(3.0), angle_y.max(3.0)],
            tether_time: 1.2,
            tether_damping: 0.8,
            rate_max: 4.0,
            ..Self::default()
        }
    }

    /// Thrust over mass at a time, m/s².
    #[must_use]
    pub fn thrust_at(&self, time: f64) -> f64 {
        let fails = time >= self.drop.from && time < self.drop.to;
        self.thrust_true * if fails { self.drop.share } else { 1.0 }
    }

    /// What the algorithms believe.
    pub(super) fn nominal_model(&self) -> Result<TetherAngleModel<f64>, String> {
        TetherAngleModel::try_new(self.thrust, self.length_believed).map_err(|e| e.to_string())
    }

    /// The filter.
    pub(super) fn ukf(&self, dt: f64) -> Result<TetherAngleUkf<f64>, String> {
        let ukf = TetherAngleUkf::try_new(dt).map_err(|e| e.to_string())?;
        Ok(TetherAngleUkf { sigma: self.sigma, ..ukf })
    }

    /// The controller.
    pub(super) fn control(&self) -> Result<TetherAngleLoop<f64>, String> {
        TetherAngleLoop {
            tether_time: self.tether_time,
            tether_damping: self.tether_damping,
            tilt_time: self.tilt_time,
            tension_min: (self.tension_min > 0.0).then_some(self.tension_min),
            rate_max: self.rate_max,
        }
        .validate()
        .map_err(|e| e.to_string())
    }

    /// What the core's own checks leave open.
    pub(super) fn check(&self, planes: usize) -> Result<(), String> {
        let ranges = [
            ("length", self.length, 0.1, 1e3),
            ("thrust_true", self.thrust_true, 0.1, 1e3),
            ("step", self.step, 0.1, 1e3),
            ("duration", self.duration, 1.0, 1e3),
            ("accel_noise", self.accel_noise, 0.0, 100.0),
            ("accel_tau", self.accel_tau, 1e-4, 10.0),
            ("gyro_noise", self.gyro_noise, 0.0, 10.0),
            ("gyro_bias", self.gyro_bias, -1.0, 1.0),
            ("sigma", self.sigma, 0.0, 10.0),
            ("attachment", self.attachment, -1.0, 1.0),
            ("mass_over_inertia", self.mass_over_inertia, 0.0, 1e6),
            ("prior_error", self.prior_error, -180.0, 180.0),
            ("start_known", self.start_known, 0.0, 90.0),
            ("tension_min", self.tension_min, 0.0, 100.0),
            ("tether_damping", self.tether_damping, 0.0, 100.0),
            ("drop.share", self.drop.share, 0.0, 10.0),
            ("anchor.amplitude", self.anchor.amplitude, -100.0, 100.0),
            ("anchor.period", self.anchor.period, 0.0, 1e4),
            ("anchor_y.amplitude", self.anchor_y.amplitude, -100.0, 100.0),
            ("anchor_y.period", self.anchor_y.period, 0.0, 1e4),
        ];
        for (key, value, min, max) in ranges {
            crate::scenario::within(key, value, min, max)?;
        }
        for (key, list) in [("reference", &self.reference), ("start", &self.start)] {
            if list.len() < planes || !list.iter().all(|x| x.is_finite() && x.abs() <= 90.0) {
                return Err(format!("{key} = {list:?}: at least {planes} angles within 90 deg"));
            }
        }
        Ok(())
    }
}
