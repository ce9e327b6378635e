//! What a run of the flying inverted pendulum is made of; `--set` paths are these keys.

use super::plant::{PendulumPlant, PendulumTruth};
use super::riccati::{NORMAL, SOFT, linear_gains};
use super::run::{Flown, PendulumRun, PendulumTrace, Sensing};
use crate::plant::{Disturbance, GRAVITY};
use crate::scenario::DisturbanceKind;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use tautline_firmware::control::pendulum::{
    LinearPendulum, PendulumControl, PendulumGains, PendulumLimits,
};
use tautline_firmware::estimate::pendulum::{
    PendulumFilter, PendulumNoise, PendulumObserver, VerticalDisturbance,
};
use tautline_firmware::frames::V3;
use tautline_firmware::model::PendulumModel;
use tautline_firmware::scalar::Scalar;
use tautline_firmware::trajectory::load::TiltedCircle;

/// Gains of the backstepping law.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GainSet {
    /// The article's simulation.
    Printed,
    /// The article's experiment.
    PrintedExperiment,
    /// Ours.
    Robust,
}

/// Noise model of the filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FilterSet {
    /// The article's simulation.
    Printed,
    /// The article's experiment.
    PrintedExperiment,
    /// Ours.
    Recommended,
}

/// Which controller flies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LawKind {
    /// The article's.
    Backstepping,
    /// The baseline, with flat feed-forward.
    Linear,
    /// The baseline with softer weights.
    SoftLinear,
    /// The baseline without feed-forward.
    LinearWithoutFeedForward,
}

/// In what the core computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Precision {
    /// f64.
    Double,
    /// f32, as in flight.
    Single,
}

/// Everything.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PendulumScenario {
    /// kg.
    pub vehicle_mass: f64,
    /// kg.
    pub load_mass: f64,
    /// m.
    pub length: f64,
    /// True over nominal mass of vehicle and load, less one.
    pub mass_error: f64,
    /// True over nominal thrust, less one.
    pub thrust_error: f64,
    /// Linear drag of the vehicle, N s/m.
    pub drag: f64,
    /// Time constant of the body rates, s.
    pub lag: f64,
    /// Age of all measurements, s.
    pub delay: f64,
    /// Of the measured direction, each axis, rad.
    pub rod_noise: f64,
    /// m/s.
    pub velocity_noise: f64,
    /// m.
    pub position_noise: f64,
    /// What pushes.
    pub disturbance: DisturbanceKind,
    /// Which controller flies.
    pub law: LawKind,
    /// Its gains.
    pub gains: GainSet,
    /// Noise model of the filter.
    pub filter: FilterSet,
    /// In what the core computes.
    pub precision: Precision,
    /// Control and filter, Hz.
    pub rate: f64,
    /// Largest thrust over the nominal weight; zero: no limit.
    pub thrust_share: f64,
    /// Largest body rate, rad/s; zero: no limit.
    pub rate_max: f64,
    /// Bandwidth of the vertical disturbance observer (E1), rad/s; zero: none.
    pub vertical_bandwidth: f64,
    /// Soft start (E2), s; zero: none.
    pub soft_start: f64,
    /// Least downward pull as a share of gravity (E3); zero: none.
    pub pull_share: f64,
    /// The controller gets the true state and disturbance.
    pub knows_state: bool,
    /// The filter starts with the rod hanging down, as printed, instead of from the first measurement.
    pub starts_turned_over: bool,
    /// Along the reference, m/s; zero: hover where it starts.
    pub speed: f64,
    /// First position of the load, m; `[]`: on the reference.
    pub start: Vec<f64>,
    /// First tilt of the rod, deg.
    pub tilt: f64,
    /// Towards where it leans, deg from North.
    pub tilt_azimuth: f64,
    /// s.
    pub duration: f64,
    /// Figures count from here on, s.
    pub settled: f64,
}

impl Default for PendulumScenario {
    /// The article's simulation (70), without disturbance, at 400 Hz, ideal.
    fn default() -> Self {
        Self {
            vehicle_mass: 0.26,
            load_mass: 0.03,
            length: 0.7,
            mass_error: 0.0,
            thrust_error: 0.0,
            drag: 0.0,
            lag: 0.0,
            delay: 0.0,
            rod_noise: 0.0,
            velocity_noise: 0.0,
            position_noise: 0.0,
            disturbance: DisturbanceKind::None,
            law: LawKind::Backstepping,
            gains: GainSet::Printed,
            filter: FilterSet::Printed,
            precision: Precision::Double,
            rate: 400.0,
            thrust_share: 0.0,
            rate_max: 0.0,
            vertical_bandwidth: 0.0,
            soft_start: 0.0,
            pull_share: 0.0,
            knows_state: false,
            starts_turned_over: false,
            speed: 0.5,
            start: vec![0.0, 0.2, -0.3],
            tilt: 5.0,
            tilt_azimuth: 45.0,
            duration: 60.0,
            settled: 20.0,
        }
    }
}

impl PendulumScenario {
    /// Noise, delay, lag and limits of a real vehicle, with E1 and E2, at 200 Hz.
    #[must_use]
    pub fn realistic() -> Self {
        Self {
            rod_noise: 2e-3,
            velocity_noise: 0.02,
            position_noise: 1e-3,
            delay: 0.02,
            lag: 0.03,
            thrust_share: 2.0,
            rate_max: 10.0,
            vertical_bandwidth: 3.0,
            soft_start: 4.0,
            rate: 200.0,
            gains: GainSet::Robust,
            filter: FilterSet::Recommended,
            ..Self::default()
        }
    }

    /// The article's experiment at 45 Hz.
    #[must_use]
    pub fn experiment() -> Self {
        Self {
            vehicle_mass: 0.253,
            load_mass: 0.032,
            length: 1.0,
            gains: GainSet::PrintedExperiment,
            filter: FilterSet::PrintedExperiment,
            rate: 45.0,
            ..Self::default()
        }
    }

    /// Flies it.
    ///
    /// # Errors
    /// One line naming the setting.
    pub fn fly(&self, seed: u64) -> Result<PendulumTrace, String> {
        match self.precision {
            Precision::Double => Ok(self.build::<f64>(seed)?.fly()),
            Precision::Single => Ok(self.build::<f32>(seed)?.fly()),
        }
    }

    fn check(&self) -> Result<(), String> {
        let positive = |name: &str, x: f64| {
            if x.is_finite() && x > 0.0 {
                Ok(())
            } else {
                Err(format!("{name} = {x}: must be finite and greater than zero"))
            }
        };
        let not_negative = |name: &str, x: f64| {
            if x.is_finite() && x >= 0.0 {
                Ok(())
            } else {
                Err(format!("{name} = {x}: must be finite and not negative"))
            }
        };
        positive("vehicle_mass", self.vehicle_mass)?;
        positive("load_mass", self.load_mass)?;
        positive("length", self.length)?;
        positive("duration", self.duration)?;
        positive("mass_error", 1.0 + self.mass_error).map_err(|_| "mass_error: must exceed -1")?;
        positive("thrust_error", 1.0 + self.thrust_error)
            .map_err(|_| "thrust_error: must exceed -1")?;
        if !(10.0..=10_000.0).contains(&self.rate) {
            return Err(format!("rate = {}: must be from 10 to 10000", self.rate));
        }
        if self.duration > 3600.0 {
            return Err(format!("duration = {}: must be at most 3600", self.duration));
        }
        if self.delay > 1.0 {
            return Err(format!("delay = {}: must be at most 1", self.delay));
        }
        if !self.start.is_empty() && self.start.len() != 3 {
            return Err("start: needs three numbers or none".into());
        }
        if self.start.iter().chain([&self.tilt, &self.tilt_azimuth]).any(|x| !x.is_finite()) {
            return Err("start, tilt, tilt_azimuth: must be finite".into());
        }
        for (name, x) in [
            ("drag", self.drag),
            ("lag", self.lag),
            ("delay", self.delay),
            ("rod_noise", self.rod_noise),
            ("velocity_noise", self.velocity_noise),
            ("position_noise", self.position_noise),
            ("thrust_share", self.thrust_share),
            ("rate_max", self.rate_max),
            ("vertical_bandwidth", self.vertical_bandwidth),
            ("soft_start", self.soft_start),
            ("pull_share", self.pull_share),
            ("speed", self.speed),
            ("settled", self.settled),
        ] {
            not_negative(name, x)?;
        }
        Ok(())
    }

    /// Plant steps per control period: at most 0.625 ms each.
    fn substeps(&self) -> u32 {
        (1.0 / (self.rate * 6.25e-4)).round().max(1.0) as u32
    }

    fn build<S: Scalar + Into<f64>>(&self, seed: u64) -> Result<PendulumRun<S>, String> {
        self.check()?;
        let text = |e: tautline_firmware::fault::Invalid| e.to_string();
        let lit = S::lit;
        let model =
            PendulumModel::try_new(lit(self.vehicle_mass), lit(self.load_mass), lit(self.length))
                .map_err(text)?;
        let dt = 1.0 / self.rate;
        let substeps = self.substeps();
        let wide = PendulumLimits::<S>::wide();
        let or = |x: S, wide: S| if x > S::zero() { x } else { wide };
        let limits = PendulumLimits {
            thrust_max: or(lit(self.thrust_share) * model.weight(), wide.thrust_max),
            rate_max: or(lit(self.rate_max), wide.rate_max),
            pull_share: (self.pull_share > 0.0).then(|| lit(self.pull_share)),
            ..wide
        };
        let gains = match self.gains {
            GainSet::Printed => PendulumGains::printed(),
            GainSet::PrintedExperiment => PendulumGains::printed_experiment(),
            GainSet::Robust => PendulumGains::robust(),
        };
        let linear = |weights, feeds_forward| {
            let stiffness = model.weight() / model.lever();
            let gains = linear_gains(GRAVITY, stiffness.into(), weights, feeds_forward);
            Flown::Linear(LinearPendulum { gains, model, limits })
        };
        let law = match self.law {
            LawKind::Backstepping => {
                Flown::Backstepping(PendulumControl::try_new(gains, model, limits).map_err(text)?)
            }
            LawKind::Linear => linear(NORMAL, true),
            LawKind::SoftLinear => linear(SOFT, true),
            LawKind::LinearWithoutFeedForward => linear(NORMAL, false),
        };
        let noise = match self.filter {
            FilterSet::Printed => PendulumNoise::printed(),
            FilterSet::PrintedExperiment => PendulumNoise::printed_experiment(),
            FilterSet::Recommended => PendulumNoise::recommended(),
        };
        let bandwidth = self.vertical_bandwidth;
        let circle = TiltedCircle::article(lit(self.speed));
        let first = circle.at(S::zero()).position().0.map(Into::into);
        let position = match self.start.as_slice() {
            [x, y, z] => Vector3::new(*x, *y, *z),
            _ => first,
        };
        let (sin, cos) = self.tilt.to_radians().sin_cos();
        let (east, north) = self.tilt_azimuth.to_radians().sin_cos();
        let rod = Vector3::new(sin * north, sin * east, -cos);
        let filter = PendulumFilter { model, noise };
        Ok(PendulumRun {
            plant: PendulumPlant {
                vehicle_mass: self.vehicle_mass * (1.0 + self.mass_error),
                load_mass: self.load_mass * (1.0 + self.mass_error),
                length: self.length,
                gravity: GRAVITY,
                lag: self.lag,
                drag: self.drag,
            },
            thrust_factor: 1.0 + self.thrust_error,
            start: PendulumTruth::at_rest(position, rod),
            disturbance: Disturbance::new(self.disturbance, seed),
            observer: PendulumObserver {
                filter,
                vertical: (bandwidth > 0.0)
                    .then(|| VerticalDisturbance { bandwidth: lit(bandwidth) }),
            },
            initial: self.starts_turned_over.then(|| filter.start(&V3::z())),
            law,
            circle,
            is_hovering: self.speed <= 0.0,
            soft_start: self.soft_start,
            sensing: Sensing {
                rod: self.rod_noise,
                velocity: self.velocity_noise,
                position: self.position_noise,
                period: dt,
                delay: (self.delay / dt * f64::from(substeps)).round() as usize,
                seed,
            },
            knows_state: self.knows_state,
            uses_filtered_rod: false,
            ignores_disturbance: false,
            dt,
            substeps,
            duration: self.duration,
            settled: self.settled,
        })
    }
}
