//! A planar experiment as TOML. `--set` paths are these keys.

use super::PlanarPlantModel;
use serde::{Deserialize, Serialize};

/// What is controlled.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum LawKind {
    /// Elevation and pitch, static (Γa). State feedback only.
    Static,
    /// Elevation and pitch (Γa').
    Attitude,
    /// Elevation and link force (Γb).
    #[default]
    Force,
}

/// What the controller reads.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Feedback {
    /// The observer's estimate.
    #[default]
    Observer,
    /// The true state.
    State,
}

/// Continuous derivatives of a step.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum SmoothKind {
    /// One.
    C1,
    /// Two.
    C2,
    /// Three.
    C3,
    /// Four.
    C4,
}

/// Form of the observer.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum UpdateKind {
    /// Predictor-corrector with the gyro's trapezium.
    #[default]
    PredictorCorrector,
    /// The same, gyro held.
    PredictorCorrectorHeld,
    /// Forward Euler.
    Euler,
    /// Runge-Kutta, measurement held.
    Rk4Held,
    /// Matrix exponential, measurement held.
    ExactHeld,
}

/// Branches of the observer.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum BranchChoice {
    /// Two; the first is selected at the start.
    #[default]
    BothFromFirst,
    /// Two; the second is selected at the start.
    BothFromSecond,
    /// One, which starts in tension.
    One,
}

/// Residual that discriminates the branches.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Residual {
    /// Of the accelerometer.
    #[default]
    Acceleration,
    /// Of the elevation's unit vector.
    UnitVector,
}

/// Inversion near the singularity.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum InversionKind {
    /// Undamped.
    Exact,
    /// Damped everywhere.
    Damped,
    /// Damped in a window.
    #[default]
    Window,
}

/// A closed loop in the plane. Defaults are the journal's Γb in 5 s.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct PlanarScenario {
    /// Controller.
    pub law: LawKind,
    /// What it reads.
    pub feedback: Feedback,
    /// Samples per second.
    pub rate_hz: f64,
    /// Plant steps per sample.
    pub substeps: u32,
    /// The real thing.
    pub plant: PlanarPlantModel,
    /// What the algorithms believe, relative to the real values.
    pub model_error: ModelErrorSection,
    /// Plan.
    pub reference: ReferenceSection,
    /// Controller.
    pub controller: ControllerSection,
    /// Observer.
    pub observer: ObserverSection,
    /// Start.
    pub start: StartSection,
    /// White noise, variances of one sample.
    pub noise: NoiseSection,
}

impl Default for PlanarScenario {
    fn default() -> Self {
        Self {
            law: LawKind::Force,
            feedback: Feedback::Observer,
            rate_hz: 1000.0,
            substeps: 2,
            plant: PlanarPlantModel::default(),
            model_error: ModelErrorSection::default(),
            reference: ReferenceSection::default(),
            controller: ControllerSection::default(),
            observer: ObserverSection::default(),
            start: StartSection::default(),
            noise: NoiseSection::default(),
        }
    }
}

/// `[model_error]`: nominal = (1 + error) · real.
#[derive(Clone, Debug, Default, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct ModelErrorSection {
    /// Mass.
    pub mass: f64,
    /// Inertia.
    pub inertia: f64,
    /// Length.
    pub length: f64,
}

/// `[reference]`: hold, step, hold.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct ReferenceSection {
    /// From, to, rad.
    pub elevation: [f64; 2],
    /// Pitch, rad, or link force, N: from, to.
    pub second: [f64; 2],
    /// Of the elevation.
    pub elevation_smoothness: SmoothKind,
    /// Of the other.
    pub second_smoothness: SmoothKind,
    /// Start of the step, s.
    pub start: f64,
    /// Its duration, s.
    pub duration: f64,
    /// Time after it, s.
    pub hold: f64,
}

impl Default for ReferenceSection {
    fn default() -> Self {
        Self {
            elevation: [std::f64::consts::FRAC_PI_4, 3.0 * std::f64::consts::FRAC_PI_4],
            second: [3.0, 5.0],
            elevation_smoothness: SmoothKind::C4,
            second_smoothness: SmoothKind::C2,
            start: 5.0,
            duration: 5.0,
            hold: 5.0,
        }
    }
}

/// `[controller]`.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct ControllerSection {
    /// 1/s: four for the force law, three for the attitude law, two for the static one.
    pub elevation_poles: Vec<f64>,
    /// 1/s: two.
    pub second_poles: [f64; 2],
    /// Near the singularity.
    pub inversion: InversionKind,
    /// Of [`InversionKind::Window`], N (force law) or 1/(kg m).
    pub threshold: f64,
    /// Damping, same unit.
    pub damping: f64,
    /// Largest torque, N m; 0: unlimited.
    pub torque_max: f64,
    /// Lowest and highest thrust, N; equal: unlimited.
    pub thrust: [f64; 2],
    /// Largest thrust rate, N/s; 0: unlimited.
    pub thrust_rate_max: f64,
    /// Largest thrust acceleration, N/s²; 0: unlimited.
    pub thrust_accel_max: f64,
}

impl Default for ControllerSection {
    fn default() -> Self {
        Self {
            elevation_poles: vec![-1.0, -1.5, -2.0, -2.5],
            second_poles: [-1.0, -1.5],
            inversion: InversionKind::Window,
            threshold: 0.5,
            damping: 0.2,
            torque_max: 0.0,
            thrust: [0.0, 0.0],
            thrust_rate_max: 0.0,
            thrust_accel_max: 0.0,
        }
    }
}

/// `[observer]`.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct ObserverSection {
    /// Roots of the error dynamics times ε.
    pub roots: [f64; 3],
    /// ε.
    pub epsilon: f64,
    /// Another ε at the start …
    pub fast_epsilon: f64,
    /// … for so long, s; 0: never.
    pub fast_time: f64,
    /// Discrete form.
    pub update: UpdateKind,
    /// Branches.
    pub branches: BranchChoice,
    /// Sign by continuity.
    pub sign_is_continuous: bool,
    /// Residual.
    pub residual: Residual,
    /// m/s².
    pub hysteresis: f64,
    /// Prior: the vehicle is above the anchor.
    pub is_above_ground: bool,
    /// 1/s.
    pub forgetting: f64,
    /// m/s².
    pub force_min: f64,
    /// rad/s.
    pub rate_max: f64,
    /// rad/s².
    pub accel_max: f64,
    /// Confidence that stops the other branch, m/s²; 0: never.
    pub confident: f64,
    /// For so long, s.
    pub confident_time: f64,
    /// Motor lag that the assumed thrust follows, s.
    pub motor_lag: f64,
}

impl Default for ObserverSection {
    fn default() -> Self {
        Self {
            roots: [-6.0, -4.5, -3.0],
            epsilon: 0.1,
            fast_epsilon: 0.1,
            fast_time: 0.0,
            update: UpdateKind::PredictorCorrector,
            branches: BranchChoice::BothFromFirst,
            sign_is_continuous: true,
            residual: Residual::Acceleration,
            hysteresis: 0.05,
            is_above_ground: true,
            forgetting: 20.0,
            force_min: 0.05,
            rate_max: 10.0,
            accel_max: 100.0,
            confident: 0.0,
            confident_time: 0.2,
            motor_lag: 0.0,
        }
    }
}

/// `[start]`.
#[derive(Clone, Debug, Default, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct StartSection {
    /// Added to the true `[φ, φ', θ, θ']`.
    pub state_offset: [f64; 4],
    /// Added to the observer's `[φ+θ, φ', φ'']`.
    pub observer_offset: [f64; 3],
    /// Controller waits, s.
    pub hold_off: f64,
    /// Sign of the thrust: negative starts upside down.
    pub is_upside_down: bool,
}

/// `[noise]`.
#[derive(Clone, Debug, Default, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct NoiseSection {
    /// Of each accelerometer axis, (m/s²)².
    pub accel_variance: f64,
    /// Of the gyro, (rad/s)².
    pub gyro_variance: f64,
}

impl PlanarScenario {
    /// The journal's Γa': elevation 10 to 50°, pitch 30 to 5°.
    #[must_use]
    pub fn journal_attitude() -> Self {
        let rad = f64::to_radians;
        Self {
            law: LawKind::Attitude,
            reference: ReferenceSection {
                elevation: [rad(10.0), rad(50.0)],
                second: [rad(30.0), rad(5.0)],
                elevation_smoothness: SmoothKind::C3,
                ..ReferenceSection::default()
            },
            controller: ControllerSection {
                elevation_poles: vec![-0.5, -1.0, -1.5],
                second_poles: [-0.5, -1.0],
                threshold: 0.05,
                damping: 0.05,
                ..ControllerSection::default()
            },
            ..Self::default()
        }
    }

    /// The conference's Fig. 4: 45 to 135°, 20 N of tension to 20 N of compression in 2.5 s.
    #[must_use]
    pub fn conference() -> Self {
        Self {
            plant: PlanarPlantModel { inertia: 0.15, ..PlanarPlantModel::default() },
            reference: ReferenceSection {
                second: [20.0, -20.0],
                elevation_smoothness: SmoothKind::C3,
                second_smoothness: SmoothKind::C1,
                start: 2.0,
                duration: 2.5,
                hold: 2.5,
                ..ReferenceSection::default()
            },
            controller: ControllerSection {
                elevation_poles: vec![-3.0, -6.0, -12.0, -24.0],
                second_poles: [-6.0, -12.0],
                ..ControllerSection::default()
            },
            ..Self::default()
        }
    }

    /// s.
    #[must_use]
    pub fn end(&self) -> f64 {
        self.reference.start + self.reference.duration + self.reference.hold
    }
}
