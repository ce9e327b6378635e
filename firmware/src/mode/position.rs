//! Position: sticks give velocities; hands off, it stays where it is.

use super::{
    Context, Entry, Exit, FlightMode, Handover, Notice, Refusal, Setpoints, plan, rejected,
};
use crate::frames::V3;
use crate::scalar::Scalar;
use crate::supervisor::GroundState;
use crate::time::OUTER_DT;

/// A stick this near its middle is there.
const CENTRE: f32 = 0.1;
/// Outer steps from one set-point of the sticks to the next: 25 Hz, and a set-point carries on for half a second.
const EVERY: u8 = 10;

/// What moves.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Position {
    ticks: u8,
}

/// Beyond the centre, -1..1.
fn beyond(stick: f32) -> f32 {
    let size = ((stick.abs() - CENTRE) / (1.0 - CENTRE)).clamp(0.0, 1.0);
    if stick < 0.0 { -size } else { size }
}

impl<S: Scalar> FlightMode<S> for Position {
    fn enter(
        _entry: &Entry,
        handover: &mut Handover<S>,
        cx: &Context<'_, S>,
    ) -> Result<Self, Refusal> {
        if cx.fresh_sticks().is_none() {
            return Err(rejected("Mode refused: no sticks"));
        }
        if cx.is_in_air() {
            plan::stay(handover, cx);
        }
        Ok(Self::default())
    }

    fn step(
        &mut self,
        handover: &mut Handover<S>,
        cx: &Context<'_, S>,
    ) -> Result<Setpoints<S>, Exit> {
        let tension = cx.tension_in_flight(handover);
        let Some(sticks) = cx.fresh_sticks() else {
            plan::stay(handover, cx);
            return Ok(Setpoints {
                notice: Some(Notice::Complete),
                ..plan::fly(handover, tension, cx)
            });
        };
        if cx.ground() == GroundState::OnGround {
            return Ok(cx.unchanged(tension));
        }
        let p = cx.params;
        let turn = S::from_f32(beyond(sticks.yaw) * p.stick_yaw_rate);
        handover.heading = crate::math::wrap_pi(handover.heading + turn * S::lit(OUTER_DT));
        self.ticks = (self.ticks + 1) % EVERY;
        if self.ticks == 0 {
            let (sin, cos) = handover.heading.sin_cos();
            let level = |stick: f32| S::from_f32(beyond(stick) * p.cruise_speed);
            let (ahead, right) = (level(sticks.pitch), level(sticks.roll));
            let climb = S::from_f32(beyond((sticks.throttle - 0.5) * 2.0) * p.stick_climb_rate);
            let velocity = V3::new(ahead * cos - right * sin, ahead * sin + right * cos, -climb);
            // At the edge of what it may fly the last set-point runs out, and the vehicle stands.
            let velocity = velocity.map(Scalar::to_f32).into();
            let _ = plan::follow(handover, [None; 3], Some(velocity), None, cx);
        }
        Ok(plan::fly(handover, tension, cx))
    }
}
