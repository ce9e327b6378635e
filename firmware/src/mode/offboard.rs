//! Offboard: a program streams set-points, and the vehicle follows them as they come.
//!
//! A place, a velocity, an attitude or body rates, each with its limits; what it cannot fly it refuses. A stream that
//! ends leaves the vehicle where it is, in Tether Hold.

use super::{
    Context, Entry, Exit, FlightMode, Handover, Notice, Refusal, Setpoints, denied, plan, rejected,
};
use crate::control::AttitudeCommand;
use crate::frames::{Body, V3};
use crate::scalar::Scalar;
use crate::signal::{Action, Setpoint};
use crate::supervisor::GroundState;

/// Silence that ends the mode, µs, and that keeps it from beginning.
const STREAM_TIMEOUT_US: u64 = 500_000;

/// What is followed now.
#[derive(Clone, Copy, Debug)]
pub(super) enum Offboard<S: Scalar> {
    /// The plan in the handover.
    Place,
    /// Thrust, N, world axes, and a heading, rad.
    Attitude {
        force: V3<S>,
        yaw: S,
    },
    Rates(AttitudeCommand<S>),
}

/// What a set-point asks for.
fn follow<S: Scalar>(
    setpoint: &Setpoint,
    handover: &mut Handover<S>,
    cx: &Context<'_, S>,
) -> Result<Offboard<S>, Refusal> {
    let p = cx.params;
    let thrust = |share: f32| {
        let fits = (0.0..=1.0).contains(&share);
        let thrust = S::from_f32(share * p.thrust_max);
        if fits { Ok(thrust) } else { Err(denied("Set-point refused: thrust beyond 0..1")) }
    };
    match *setpoint {
        Setpoint::Place { ned, velocity, yaw } => {
            plan::follow(handover, ned, velocity, yaw, cx)?;
            Ok(Offboard::Place)
        }
        Setpoint::Attitude { quaternion, thrust: share } => {
            let norm = quaternion.iter().map(|x| x * x).sum::<f32>();
            if !(0.5..2.0).contains(&norm) {
                return Err(denied("Set-point refused: no attitude"));
            }
            let size = libm::sqrtf(norm);
            let [w, x, y, z] = quaternion.map(|part| S::from_f32(part / size));
            let (one, two) = (S::one(), S::lit(2.0));
            let down =
                V3::new(two * (x * z + w * y), two * (y * z - w * x), one - two * (x * x + y * y));
            if down.z.to_f32() < crate::math::trig::sin_cos(p.stick_tilt_max).1 {
                return Err(denied("Set-point refused: tilt above MAN_TILT_MAX"));
            }
            let yaw = (two * (w * z + x * y)).atan2(one - two * (y * y + z * z));
            Ok(Offboard::Attitude { force: down * -thrust(share)?, yaw })
        }
        Setpoint::Rates { rate, thrust: share } => {
            let [roll, pitch, yaw] = rate;
            let fits = |rate: f32, most: f32| rate.abs() <= most;
            let fit = [roll, pitch].iter().all(|rate| fits(*rate, p.tilt_rate_max));
            if !fit || !fits(yaw, p.yaw_rate_max) {
                return Err(denied("Set-point refused: rate out of range"));
            }
            let rate = Body(V3::from(rate.map(S::from_f32)));
            Ok(Offboard::Rates(AttitudeCommand {
                rate,
                thrust: thrust(share)?.max(S::from_f32(p.thrust_min)),
                ..AttitudeCommand::idle()
            }))
        }
    }
}

/// The last set-point, if it is new enough.
fn live<'a, S: Scalar>(cx: &Context<'a, S>) -> Option<&'a Setpoint> {
    let last = cx.situation.setpoint.as_ref()?;
    (cx.now.since(last.at) < STREAM_TIMEOUT_US).then_some(&last.value)
}

impl<S: Scalar> Offboard<S> {
    /// From here on by itself.
    fn end(handover: &mut Handover<S>, cx: &Context<'_, S>, notice: Notice<S>) -> Setpoints<S> {
        plan::stay(handover, cx);
        let (.., yaw) = cx.situation.estimate.attitude.euler();
        handover.heading = yaw;
        let tension = cx.tension_in_flight(handover);
        Setpoints { notice: Some(notice), ..plan::fly(handover, tension, cx) }
    }
}

impl<S: Scalar> FlightMode<S> for Offboard<S> {
    fn enter(
        _entry: &Entry,
        handover: &mut Handover<S>,
        cx: &Context<'_, S>,
    ) -> Result<Self, Refusal> {
        if !cx.is_in_air() {
            return Err(rejected("Offboard refused: not in the air"));
        }
        let Some(setpoint) = live(cx) else {
            return Err(rejected("Offboard refused: no set-points come"));
        };
        plan::stay(handover, cx);
        follow(setpoint, handover, cx)
    }

    fn step(
        &mut self,
        handover: &mut Handover<S>,
        cx: &Context<'_, S>,
    ) -> Result<Setpoints<S>, Exit> {
        if live(cx).is_none() {
            return Ok(Self::end(handover, cx, Notice::Complete));
        }
        let tension = cx.tension_in_flight(handover);
        let attitude = match *self {
            Self::Place => return Ok(plan::fly(handover, tension, cx)),
            Self::Attitude { force, yaw } => cx.thrust(force, yaw),
            Self::Rates(command) => {
                // Nobody else looks where rates lead; the loop of a set-point of attitude is the nearest that is safe.
                let limit = crate::math::trig::sin_cos(cx.params.stick_tilt_max).1;
                let attitude = &cx.situation.estimate.attitude;
                if attitude.cos_tilt().to_f32() < limit {
                    let (.., yaw) = attitude.euler();
                    cx.thrust(V3::new(S::zero(), S::zero(), -command.thrust), yaw)
                } else {
                    command
                }
            }
        };
        Ok(Setpoints { ground: GroundState::InAir, ..cx.placeless(attitude, tension) })
    }

    fn command(
        &mut self,
        handover: &mut Handover<S>,
        action: &Action,
        cx: &Context<'_, S>,
    ) -> Result<(), Refusal> {
        let Action::Setpoint(setpoint) = action else {
            return Err(rejected("Move refused: Offboard flies"));
        };
        let was_elsewhere = !matches!(self, Self::Place);
        if was_elsewhere && matches!(setpoint, Setpoint::Place { .. }) {
            plan::stay(handover, cx);
        }
        *self = follow(setpoint, handover, cx)?;
        Ok(())
    }

    fn heading(&self, handover: &Handover<S>, cx: &Context<'_, S>) -> S {
        match self {
            Self::Place => handover.heading,
            Self::Attitude { .. } | Self::Rates(_) => cx.situation.estimate.attitude.euler().2,
        }
    }
}
