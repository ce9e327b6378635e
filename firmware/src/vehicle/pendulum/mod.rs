//! Pendulum: a load on a rod balanced on top, under motion capture. `pendulum` sections 4 to 6 and 11.
//!
//! The observer runs whenever directions arrive, whatever the mode, so that it has converged when the mode
//! is asked for. It lives as long ago as the samples are old (CAP_DELAY), with the thrust and attitude of
//! then; what it believes is carried to the present with the thrust since.

mod observe;
mod path;

pub(super) use observe::RodWatch;
pub(super) use path::LoadPath;

use super::Vehicle;
use super::requests::{Refusal, check_heading, denied, rejected};
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
use crate::math::wrap_pi;
use crate::model::{LinkKind, PendulumModel};
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::{Event, EventQueue, FlightReference, LoadReference};
use crate::supervisor::Mode;
use crate::time::{Micros, OUTER_DT};
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
pub(super) struct PendulumMode<S: Scalar> {
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
    yaw_gain: S,
    yaw_rate_max: S,
}

/// What moves in the mode.
#[derive(Clone, Copy, Debug)]
pub(super) struct PendulumFlight<S: Scalar> {
    pub path: LoadPath<S>,
    pub reference: LoadReference<S>,
    memory: PendulumMemory<S>,
    command: PendulumCommand<S>,
    /// Law refused this many times in a row.
    refused: u8,
    ticks: u8,
}

/// What log and telemetry see of the pendulum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PendulumReport<S: Scalar = f32> {
    /// Now.
    pub estimate: PendulumEstimate<S>,
    /// In the mode.
    pub reference: Option<LoadReference<S>>,
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
pub(super) fn gain_warning(p: &Params) -> Option<&'static str> {
    let conditions = gains::<f32>(p).conditions();
    if p.pendulum_beta >= conditions.coupling_limit {
        return Some("Pendulum off: PND_BETA too large for PND_KP, PND_KV");
    }
    let is_proven = conditions.proven_up_to > crate::math::GRAVITY as f32;
    (!is_proven).then_some("Pendulum: PND_KQ too small for a proof at hover")
}

impl<S: Scalar> PendulumMode<S> {
    /// From the parameters; `None` on a tether or with gains without any proof.
    pub fn new(p: &Params) -> Option<Self> {
        let is_free = LinkKind::from_parameter(p.tether_kind).is_free();
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
        let rotors = f(4.0 * p.rotor_thrust_max * p.taut_thrust_share);
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
            yaw_gain: f(p.yaw_p),
            yaw_rate_max: f(p.yaw_rate_max),
        })
    }
}

impl<S: Scalar> Vehicle<S> {
    pub(super) fn request_pendulum(&mut self, now: Micros) -> Result<(), Refusal> {
        let Some(mode) = &self.config.pendulum else {
            let text = gain_warning(&self.params).filter(|_| self.config.kind.is_free());
            return Err(denied(text.unwrap_or("Mode refused: needs TET_KIND 4, free flight")));
        };
        let Some(watch) = self.state.rod.filter(|rod| rod.is_fresh(mode.timeout_us, now)) else {
            return Err(rejected("Mode refused: no direction of the rod"));
        };
        if !self.state.estimator.is_airborne() {
            return Err(rejected("Mode refused: not in the air"));
        }
        let x = watch.estimate;
        if -x.rod.0.z < mode.cos_cone {
            return Err(rejected("Mode refused: rod not upright (PND_CONE)"));
        }
        let is_slow = crate::math::so3::norm(&x.rod_rate.0) < S::lit(SLOW);
        if watch.age < S::lit(CONVERGED) || !is_slow {
            return Err(rejected("Mode refused: rod not at rest yet"));
        }
        let dip = if mode.speed > S::zero() { mode.rise } else { S::zero() };
        if -x.position.0.z - dip < self.lowest_load() {
            return Err(rejected("Mode refused: too near the ground"));
        }
        let path = LoadPath::enter(&x, &mode.circle, mode.speed, mode.soft_start);
        let thrust = self.state.estimate.thrust;
        self.enter(Mode::Pendulum);
        self.state.pendulum_flight = Some(PendulumFlight {
            reference: path.now(),
            path,
            memory: PendulumMemory::default(),
            command: PendulumCommand {
                thrust,
                rate: Body(V3::zeros()),
                down: V3::new(S::zero(), S::zero(), S::one()),
                force: V3::zeros(),
            },
            refused: 0,
            ticks: 0,
        });
        Ok(())
    }

    /// Moves the place where the load stays.
    pub(super) fn move_load(
        &mut self,
        ned: [Option<f32>; 3],
        yaw: Option<f32>,
    ) -> Result<(), Refusal> {
        check_heading(yaw)?;
        let lowest = self.lowest_load().to_f32();
        let Some(flight) = &mut self.state.pendulum_flight else {
            return Err(rejected("Move refused: not in Pendulum"));
        };
        if ned.iter().flatten().any(|x| x.is_nan() || x.abs() > self.params.length_max) {
            return Err(denied("Move refused: out of range"));
        }
        let [.., down] = ned;
        if down.is_some_and(|down| -down < lowest) {
            return Err(denied("Move refused: vehicle too near the ground"));
        }
        flight.path.go(ned.map(|x| x.map(S::from_f32)))?;
        if let Some(yaw) = yaw {
            self.state.yaw = S::from_f32(yaw);
        }
        Ok(())
    }

    /// Least height of the load that keeps the vehicle below it off the ground, m.
    fn lowest_load(&self) -> S {
        let p = &self.params;
        S::from_f32(p.pendulum_length + p.ground_height + CLEARANCE)
    }

    fn leave_pendulum(&mut self, text: &'static str, events: &mut EventQueue) {
        events.push(Event::critical(text));
        self.enter(Mode::TetherHold);
        self.stay();
        self.fly_position(events);
    }

    pub(super) fn fly_pendulum(&mut self, now: Micros, events: &mut EventQueue) {
        let (Some(mode), Some(mut flight)) = (&self.config.pendulum, self.state.pendulum_flight)
        else {
            return self.leave_pendulum("Pendulum ended: hovering", events);
        };
        let dt = S::lit(OUTER_DT);
        let fresh = self.state.rod.filter(|rod| rod.is_fresh(mode.timeout_us, now));
        let Some(watch) = fresh.filter(|_| self.state.estimate.position.is_some()) else {
            return self.leave_pendulum("Motion capture stale: hovering", events);
        };
        let x = watch.estimate;
        if -x.rod.0.z < mode.cos_tilt_max {
            return self.leave_pendulum("Pendulum fell: hovering", events);
        }
        flight.reference = flight.path.step(dt);
        let off = x.position.0 - flight.reference.position().0;
        if flight.path.has_settled() && crate::math::so3::norm(&off) > mode.error_max {
            return self.leave_pendulum("Pendulum too far off: hovering", events);
        }
        let attitude = self.state.estimate.attitude;
        if flight.ticks == 0 {
            match mode.control.step(&mut flight.memory, &x, &attitude, &flight.reference) {
                Ok(command) => {
                    flight.command = command;
                    flight.refused = 0;
                }
                // One step on the last command, then out.
                Err(_) if flight.refused == 0 => flight.refused = 1,
                Err(_) => return self.leave_pendulum("Pendulum law refused: hovering", events),
            }
        }
        flight.ticks = (flight.ticks + 1) % CONTROL_EVERY;
        let (.., yaw) = attitude.euler();
        let turn = (wrap_pi(self.state.yaw - yaw) * mode.yaw_gain).limit_abs(mode.yaw_rate_max);
        let mut rate = flight.command.rate;
        rate.0.z = turn;
        let state = &mut self.state;
        let length = mode.observer.filter.model.length;
        let below = |load: World<V3<S>>| World(load.0 + V3::new(S::zero(), S::zero(), length));
        state.reference = Some(FlightReference {
            position: below(flight.reference.position()),
            velocity: flight.reference.velocity(),
            yaw: state.yaw,
            tension: S::zero(),
        });
        let thrust = flight.command.thrust;
        state.attitude = AttitudeCommand { rate, accel: Body(V3::zeros()), thrust };
        state.pendulum_flight = Some(flight);
    }
}
