//! Stabilize and Altitude: somebody flies by sticks.

use super::descent::COS_TILT_MIN;
use super::{Context, Entry, Exit, FlightMode, Handover, Refusal, Setpoints};
use crate::frames::Attitude;
use crate::math::so3;
use crate::scalar::Scalar;
use crate::signal::{CLOSED_THROTTLE, Sticks as Position};
use crate::supervisor::GroundState;
use crate::time::OUTER_DT;

/// Throttle that leaves the ground: with climb control above the middle, else off the bottom.
const CLIMB_THROTTLE: f32 = 0.6;
const OPEN_THROTTLE: f32 = 0.1;

/// What the throttle stick means.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sticks {
    /// A climb rate; else a thrust.
    holds_climb: bool,
}

impl<S: Scalar> FlightMode<S> for Sticks {
    fn enter(
        entry: &Entry,
        _handover: &mut Handover<S>,
        _cx: &Context<'_, S>,
    ) -> Result<Self, Refusal> {
        Ok(Self { holds_climb: entry.mode.rule().needs.altitude })
    }

    fn step(
        &mut self,
        handover: &mut Handover<S>,
        cx: &Context<'_, S>,
    ) -> Result<Setpoints<S>, Exit> {
        let tension = cx.tension_in_flight(handover);
        let last = cx.situation.sticks.map_or(0.5, |s| s.value.throttle);
        let sticks = cx.fresh_sticks().unwrap_or(Position { throttle: 0.5, ..Position::default() });
        let p = cx.params;
        let asked = Setpoints {
            reference: None,
            wants_down: last < CLOSED_THROTTLE,
            ..cx.unchanged(tension)
        };
        let threshold = if self.holds_climb { CLIMB_THROTTLE } else { OPEN_THROTTLE };
        if cx.ground() == GroundState::OnGround && sticks.throttle <= threshold {
            return Ok(asked);
        }
        let ground = match cx.ground() {
            GroundState::OnGround => GroundState::InAir,
            other => other,
        };
        let estimate = &cx.situation.estimate;
        let thrust = if self.holds_climb {
            let wanted = S::from_f32((sticks.throttle - 0.5) * 2.0 * p.stick_climb_rate);
            cx.config.climb.step(&mut handover.climb, wanted, estimate.climb, S::lit(OUTER_DT))
        } else {
            S::from_f32(sticks.throttle.clamp(0.0, 1.0) * p.thrust_max)
        };
        let (_, _, yaw) = estimate.attitude.euler();
        let tilt = p.stick_tilt_max;
        let wanted = Attitude::from_euler(
            S::from_f32(sticks.roll * tilt),
            S::from_f32(-sticks.pitch * tilt),
            yaw,
        );
        let mut attitude = cx.thrust(-so3::col_z(&wanted.0) * thrust, yaw);
        // With climb control the vertical share counts, within the tilt that divides well.
        if self.holds_climb {
            attitude.thrust = thrust / estimate.attitude.cos_tilt().max(S::lit(COS_TILT_MIN));
        }
        attitude.rate.0.z = S::from_f32(sticks.yaw * p.stick_yaw_rate);
        handover.heading = yaw;
        Ok(Setpoints { attitude, ground, ..asked })
    }
}
