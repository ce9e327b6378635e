//! Pendulum: a load on a rod balanced on top, under motion capture. `pendulum` sections 4 to 6 and 11.
//!
//! The observer runs whenever directions arrive, whatever the mode, so that it has converged when the mode
//! is asked for. It lives as long ago as the samples are old (CAP_DELAY), with the thrust and attitude of
//! then; what it believes is carried to the present with the thrust since.

mod observe;
mod path;

pub(crate) use observe::RodWatch;
use path::LoadPath;

use super::refusal::{self, check_heading};
use super::{
    Context, Entry, Exit, FlightMode, Handover, ModeReport, Refusal, Setpoints, denied, rejected,
};
use crate::control::AttitudeCommand;
use crate::control::pendulum::{
    PendulumCommand, PendulumControl, PendulumGains, PendulumLimits, PendulumMemory,
};
use crate::estimate::pendulum::{
    PendulumEstimate, PendulumFilter, PendulumNoise, PendulumObserver, VerticalDisturbance,
};
use crate::fault::Invalid;
use crate::frames::{Body, V3, World};
use crate::math::trig::sin_cos;
use crate::model::{PendulumModel, TetherKind, thrust_max};
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::{Action, FlightReference, LoadReference};
use crate::time::OUTER_DT;
use crate::trajectory::load::TiltedCircle;

/// The observer must have run this long, s, and the rod be this slow, rad/s, at entry.
const CONVERGED: f64 = 1.0;
const SLOW: f64 = 1.0;
/// Room between the vehicle and the ground, m.
const CLEARANCE: f32 = 0.3;
/// Outer steps per control step: 125 Hz.
const CONTROL_EVERY: u8 = 2;

/// Configuration.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PendulumConfig<S: Scalar> {
    pub observer: PendulumObserver<S>,
    control: PendulumControl<S>,
    circle: TiltedCircle<S>,
    speed: S,
    rise: S,
    soft_start: S,
    cos_cone: S,
    cos_tilt_max: S,
    error_max: S,
    pub timeout_us: u64,
    /// Age of the samples, outer steps.
    pub delay: usize,
}

/// What moves in the mode.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pendulum<S: Scalar> {
    path: LoadPath<S>,
    reference: LoadReference<S>,
    memory: PendulumMemory<S>,
    command: PendulumCommand<S>,
    /// Law refused this many times in a row.
    refused: u8,
    ticks: u8,
}

/// What log and telemetry see of the pendulum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PendulumReport {
    /// Now.
    pub estimate: PendulumEstimate<f32>,
    /// In the mode.
    pub reference: Option<LoadReference>,
}

/// From the parameters; what is wrong with them otherwise.
fn gains<S: Scalar>(p: &Params) -> PendulumGains<S> {
    let f = S::from_f32;
    PendulumGains {
        position: V3::repeat(f(p.pendulum_kp)),
        velocity: V3::repeat(f(p.pendulum_kv)),
        coupling: f(p.pendulum_beta),
        rod: f(p.pendulum_kq),
        rate: f(p.pendulum_kw),
        attitude: f(p.pendulum_kr),
        rod_weight: f(p.pendulum_hq),
        rate_weight: f(p.pendulum_hw),
        attitude_weight: f(p.pendulum_hr),
    }
}

/// Whether the gains are those of a proof at hover, for the operator: `None` if so.
pub(crate) fn gain_warning(p: &Params) -> Option<&'static str> {
    let conditions = gains::<f32>(p).conditions();
    if p.pendulum_beta >= conditions.coupling_limit {
        return Some("Pendulum off: PND_BETA too large for PND_KP and KV");
    }
    let is_proven = conditions.proven_up_to > crate::math::GRAVITY as f32;
    (!is_proven).then_some("Pendulum: PND_KQ too small for a proof at hover")
}

impl<S: Scalar> PendulumConfig<S> {
    /// From the parameters; `None` on a tether or with gains without any proof.
    pub fn new(p: &Params) -> Option<Self> {
        let is_free = TetherKind::from_parameter(p.tether_kind).is_free();
        if is_free { Self::try_new(p).ok() } else { None }
    }

    fn try_new(p: &Params) -> Result<Self, Invalid> {
        let f = S::from_f32;
        let model = PendulumModel::try_new(f(p.mass), f(p.pendulum_load), f(p.pendulum_length))?;
        let reading = f(p.pendulum_noise);
        let noise = PendulumNoise {
            rod: V3::repeat(reading),
            spin: reading,
            ..PendulumNoise::recommended()
        };
        let standard = PendulumLimits::standard(&model);
        let rotors = f(thrust_max(p) * p.taut_thrust_share);
        let limits = PendulumLimits {
            thrust_max: (f(p.pendulum_thrust_max) * model.weight()).min(rotors),
            rate_max: f(p.pendulum_rate_max),
            ..standard
        };
        let centre = World(V3::zeros());
        let (radius, rise) = (f(p.pendulum_radius), f(p.pendulum_rise));
        Ok(Self {
            observer: PendulumObserver {
                filter: PendulumFilter { model, noise: noise.validate()? },
                vertical: Some(VerticalDisturbance { bandwidth: f(p.pendulum_vertical) }),
            },
            control: PendulumControl::try_new(gains(p), model, limits)?,
            circle: TiltedCircle::try_new(centre, radius, rise, f(p.pendulum_speed))?,
            speed: f(p.pendulum_speed),
            rise,
            soft_start: f(p.pendulum_soft_start),
            cos_cone: f(sin_cos(p.pendulum_cone).1),
            cos_tilt_max: f(sin_cos(p.pendulum_tilt_max).1),
            error_max: f(p.pendulum_error_max),
            timeout_us: (p.pendulum_timeout * 1e6) as u64,
            delay: crate::estimate::capture::delay_steps(p.capture_delay),
        })
    }
}

impl<S: Scalar> FlightMode<S> for Pendulum<S> {
    fn enter(
        _entry: &Entry,
        _handover: &mut Handover<S>,
        cx: &Context<'_, S>,
    ) -> Result<Self, Refusal> {
        let Some(config) = &cx.config.modes.pendulum else {
            let text = gain_warning(cx.params).filter(|_| cx.config.constants.kind.is_free());
            return Err(denied(text.unwrap_or(refusal::NEEDS_FREE_FLIGHT)));
        };
        let situation = cx.situation;
        let Some(watch) =
            situation.rod.as_ref().filter(|rod| rod.is_fresh(config.timeout_us, cx.now))
        else {
            return Err(rejected("Mode refused: no direction of the rod"));
        };
        if !situation.navigation.is_airborne() {
            return Err(rejected("Mode refused: not in the air"));
        }
        let x = watch.estimate;
        if -x.rod.0.z < config.cos_cone {
            return Err(rejected("Mode refused: rod not upright (PND_CONE)"));
        }
        let is_slow = crate::math::so3::norm(&x.rod_rate.0) < S::lit(SLOW);
        if watch.age < S::lit(CONVERGED) || !is_slow {
            return Err(rejected("Mode refused: rod not at rest yet"));
        }
        let dip = if config.speed > S::zero() { config.rise } else { S::zero() };
        if -x.position.0.z - dip < lowest_load(cx.params) {
            return Err(rejected("Mode refused: too near the ground"));
        }
        let path = LoadPath::enter(&x, &config.circle, config.speed, config.soft_start);
        Ok(Self {
            reference: path.now(),
            path,
            memory: PendulumMemory::default(),
            command: PendulumCommand {
                thrust: situation.estimate.thrust,
                rate: Body(V3::zeros()),
                down: V3::new(S::zero(), S::zero(), S::one()),
                force: V3::zeros(),
            },
            refused: 0,
            ticks: 0,
        })
    }

    fn step(
        &mut self,
        handover: &mut Handover<S>,
        cx: &Context<'_, S>,
    ) -> Result<Setpoints<S>, Exit> {
        let tension = cx.tension_in_flight(handover);
        let Some(config) = &cx.config.modes.pendulum else {
            return Err(Exit::failed("Pendulum ended: hovering"));
        };
        let situation = cx.situation;
        let fresh = situation.rod.as_ref().filter(|rod| rod.is_fresh(config.timeout_us, cx.now));
        let Some(watch) = fresh.filter(|_| situation.estimate.position.is_some()) else {
            return Err(Exit::failed("Motion capture stale: hovering"));
        };
        let x = &watch.estimate;
        if -x.rod.0.z < config.cos_tilt_max {
            return Err(Exit::failed("Pendulum fell: hovering"));
        }
        self.reference = self.path.step(S::lit(OUTER_DT));
        let off = x.position.0 - self.reference.position().0;
        if self.path.has_settled() && crate::math::so3::norm(&off) > config.error_max {
            return Err(Exit::failed("Pendulum too far off: hovering"));
        }
        let attitude = &situation.estimate.attitude;
        if self.ticks == 0 {
            match config.control.step(&mut self.memory, x, attitude, &self.reference) {
                Ok(command) => {
                    self.command = command;
                    self.refused = 0;
                }
                // One step on the last command, then out.
                Err(_) if self.refused == 0 => self.refused = 1,
                Err(_) => return Err(Exit::failed("Pendulum law refused: hovering")),
            }
        }
        self.ticks = (self.ticks + 1) % CONTROL_EVERY;
        let heading = handover.heading;
        let mut rate = self.command.rate;
        rate.0.z = cx.turn(heading);
        let length = config.observer.filter.model.length;
        let below = |load: World<V3<S>>| World(load.0 + V3::new(S::zero(), S::zero(), length));
        let reference = FlightReference {
            position: below(self.reference.position()),
            velocity: self.reference.velocity(),
            yaw: heading,
            tension: S::zero(),
        };
        let thrust = self.command.thrust;
        Ok(Setpoints {
            attitude: AttitudeCommand { rate, accel: Body(V3::zeros()), thrust },
            reference: Some(reference),
            ..cx.unchanged(tension)
        })
    }

    /// Moves the place where the load stays.
    fn command(
        &mut self,
        handover: &mut Handover<S>,
        action: &Action,
        cx: &Context<'_, S>,
    ) -> Result<(), Refusal> {
        // Of a stream the places: the load's own plan makes the velocity.
        let Action::MoveTo { ned, yaw } = *action else {
            return Err(refusal::not_here(action));
        };
        if ned.iter().all(Option::is_none) && yaw.is_none() {
            return Err(refusal::not_here(action));
        }
        check_heading(yaw)?;
        if ned.iter().flatten().any(|x| x.is_nan() || x.abs() > cx.params.length_max) {
            return Err(denied("Move refused: out of range"));
        }
        let [.., down] = ned;
        if down.is_some_and(|down| -down < lowest_load::<S>(cx.params).to_f32()) {
            return Err(denied("Move refused: vehicle too near the ground"));
        }
        self.path.go(ned.map(|x| x.map(S::from_f32)))?;
        if let Some(yaw) = yaw {
            handover.heading = S::from_f32(yaw);
        }
        Ok(())
    }

    fn report(&self) -> ModeReport<S> {
        ModeReport { load: Some(self.reference), ..ModeReport::default() }
    }
}

/// Least height of the load that keeps the vehicle below it off the ground, m.
fn lowest_load<S: Scalar>(p: &Params) -> S {
    S::from_f32(p.pendulum_length + p.ground_height + CLEARANCE)
}
