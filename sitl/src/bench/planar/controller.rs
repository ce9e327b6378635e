//! The core's blocks, set up for a planar scenario.

use super::scenario::{
    BranchChoice, Feedback, InversionKind, LawKind, PlanarScenario, Residual, SmoothKind,
    UpdateKind,
};
use tautline_firmware::control::taut::{
    ElevationAttitude, ElevationAttitudeStatic, ElevationForce, Inversion, Law, PlanarLoop,
    PlanarLoopSettings, ThrustLimits,
};
use tautline_firmware::estimate::high_gain::{
    BranchIndex, Branches, Discrimination, HighGain, HighGainSettings, SwitchOff, Update,
};
use tautline_firmware::fault::Invalid;
use tautline_firmware::model::PlanarModel;
use tautline_firmware::signal::PlanarReference;
use tautline_firmware::trajectory::{FlatPoint, SmoothMove, Smoothness, ThrustBranch};

/// What flies.
pub(super) enum Controller {
    /// Γa' or Γb with the observer.
    Loop(Box<PlanarLoop<f64>>),
    /// Γa on the true state.
    Static(Box<ElevationAttitudeStatic<f64>>),
}

/// Elevation and second output over time.
pub(super) struct Plan {
    elevation: SmoothMove<f64>,
    second: SmoothMove<f64>,
    start: f64,
}

impl Plan {
    pub fn new(s: &PlanarScenario) -> Result<Self, Invalid> {
        let r = &s.reference;
        let [from, to] = r.elevation;
        let [second_from, second_to] = r.second;
        let order = |kind| match kind {
            SmoothKind::C1 => Smoothness::C1,
            SmoothKind::C2 => Smoothness::C2,
            SmoothKind::C3 => Smoothness::C3,
            SmoothKind::C4 => Smoothness::C4,
        };
        Ok(Self {
            elevation: SmoothMove::try_new(from, to, r.duration, order(r.elevation_smoothness))?,
            second: SmoothMove::try_new(
                second_from,
                second_to,
                r.duration,
                order(r.second_smoothness),
            )?,
            start: r.start,
        })
    }

    pub fn at(&self, time: f64) -> PlanarReference<f64> {
        let time = time - self.start;
        PlanarReference { elevation: self.elevation.at(time), second: self.second.at(time) }
    }
}

/// Real and nominal model.
pub(super) fn models(s: &PlanarScenario) -> Result<[PlanarModel<f64>; 2], Invalid> {
    let (p, e) = (&s.plant, &s.model_error);
    let real = PlanarModel::try_new(p.mass, p.inertia, p.length, p.gravity)?;
    let nominal = PlanarModel::try_new(
        p.mass * (1.0 + e.mass),
        p.inertia * (1.0 + e.inertia),
        p.length * (1.0 + e.length),
        p.gravity,
    )?;
    Ok([real, nominal])
}

/// State and inputs that the start of the plan requires.
pub(super) fn flat_start(
    s: &PlanarScenario,
    model: &PlanarModel<f64>,
    start: &PlanarReference<f64>,
) -> Result<FlatPoint<f64>, String> {
    let [phi, phi1, phi2, phi3, _] = start.elevation;
    let point = match s.law {
        LawKind::Force => {
            let branch = if s.start.is_upside_down {
                ThrustBranch::Negative
            } else {
                ThrustBranch::Positive
            };
            model.flat_force(&start.elevation, &start.second, branch).map(|(point, _)| point)
        }
        LawKind::Static | LawKind::Attitude => {
            model.flat_attitude(&[phi, phi1, phi2, phi3], &start.second)
        }
    };
    point.map_err(|_| "reference: its start needs no or an unbounded thrust".into())
}

fn limits(s: &PlanarScenario) -> Option<ThrustLimits<f64>> {
    let c = &s.controller;
    let [min, max] = c.thrust;
    let or_none = |x: f64| if x > 0.0 { x } else { 1e12 };
    let is_limited =
        max > min || c.torque_max > 0.0 || c.thrust_rate_max > 0.0 || c.thrust_accel_max > 0.0;
    is_limited.then(|| ThrustLimits {
        min: if max > min { min } else { -1e12 },
        max: if max > min { max } else { 1e12 },
        rate: or_none(c.thrust_rate_max),
        accel: or_none(c.thrust_accel_max),
        torque: or_none(c.torque_max),
    })
}

fn observer(s: &PlanarScenario, model: PlanarModel<f64>) -> Result<HighGain<f64>, Invalid> {
    let o = &s.observer;
    HighGain::try_new(HighGainSettings {
        roots: o.roots,
        epsilon: o.epsilon,
        fast_start: (o.fast_time > 0.0).then_some((o.fast_epsilon, o.fast_time)),
        update: match o.update {
            UpdateKind::PredictorCorrector => Update::PredictorCorrector,
            UpdateKind::PredictorCorrectorHeld => Update::PredictorCorrectorHeld,
            UpdateKind::Euler => Update::Euler,
            UpdateKind::Rk4Held => Update::Rk4Held,
            UpdateKind::ExactHeld => Update::ExactHeld,
        },
        branches: match o.branches {
            BranchChoice::BothFromFirst => Branches::Both(BranchIndex::A),
            BranchChoice::BothFromSecond => Branches::Both(BranchIndex::B),
            BranchChoice::One => Branches::One,
        },
        sign_is_continuous: o.sign_is_continuous,
        discrimination: match o.residual {
            Residual::Acceleration => Discrimination::Acceleration,
            Residual::UnitVector => Discrimination::UnitVector,
        },
        hysteresis: o.hysteresis,
        is_above_ground: o.is_above_ground,
        forgetting: o.forgetting,
        switch_off: (o.confident > 0.0)
            .then_some(SwitchOff { confident: o.confident, time: o.confident_time }),
        force_min: o.force_min,
        rate_max: o.rate_max,
        accel_max: o.accel_max,
        // The articles have no restart, and the tables of the specification none either.
        restart: None,
        ..HighGainSettings::new(model, 1.0 / s.rate_hz)
    })
}

fn exactly<const N: usize>(poles: &[f64]) -> Result<[f64; N], String> {
    poles.try_into().map_err(|_| {
        format!("controller.elevation_poles has {} values, this law wants {N}", poles.len())
    })
}

impl Controller {
    pub fn new(s: &PlanarScenario, model: PlanarModel<f64>) -> Result<Self, String> {
        let c = &s.controller;
        let inversion = match c.inversion {
            InversionKind::Exact => Inversion::Exact,
            InversionKind::Damped => Inversion::Damped { damping: c.damping },
            InversionKind::Window => {
                Inversion::Window { threshold: c.threshold, damping: c.damping }
            }
        };
        let poles = &c.elevation_poles;
        let named = |e: Invalid| e.to_string();
        let law = match s.law {
            LawKind::Static => {
                if s.feedback == Feedback::Observer {
                    return Err("law = \"static\" wants feedback = \"state\": \
                                it knows no thrust rate for the observer"
                        .into());
                }
                let law = ElevationAttitudeStatic::try_new(
                    model,
                    &exactly(poles)?,
                    &c.second_poles,
                    inversion,
                );
                return Ok(Self::Static(Box::new(law.map_err(named)?)));
            }
            LawKind::Attitude => Law::Attitude(
                ElevationAttitude::try_new(model, &exactly(poles)?, &c.second_poles, inversion)
                    .map_err(named)?,
            ),
            LawKind::Force => Law::Force(
                ElevationForce::try_new(model, &exactly(poles)?, &c.second_poles, inversion)
                    .map_err(named)?,
            ),
        };
        let settings = PlanarLoopSettings {
            motor_lag: s.observer.motor_lag,
            hold_off: s.start.hold_off,
            limits: limits(s),
        };
        let planar = observer(s, model).and_then(|o| PlanarLoop::try_new(o, law, settings));
        Ok(Self::Loop(Box::new(planar.map_err(named)?)))
    }
}
