//! Land: returns and comes down along a plan.

use super::context::FixedPull;
use super::{Context, Entry, Exit, FlightMode, Handover, Refusal, Setpoints, plan};
use crate::scalar::Scalar;
use crate::supervisor::{Failure, GroundState};
use crate::time::OUTER_DT;

/// A winch pulls gently from this length on, m.
const NEAR: f64 = 4.0;

/// So long it waits for the ground where its plan ends, or for a position, s.
const PATIENCE: f64 = 25.0;

/// The plan is in the handover.
#[derive(Clone, Copy, Debug)]
pub(super) struct Land<S> {
    /// s.
    waited: S,
}

impl<S: Scalar> FlightMode<S> for Land<S> {
    fn enter(
        _entry: &Entry,
        handover: &mut Handover<S>,
        cx: &Context<'_, S>,
    ) -> Result<Self, Refusal> {
        let situation = cx.situation;
        if let Some(position) = situation.estimate.position.filter(|_| cx.is_in_air()) {
            let reference = situation.setpoints.reference;
            let from = reference.map_or(position, |reference| reference.position);
            handover.plan = cx.config.planner.land(from);
        }
        Ok(Self { waited: S::zero() })
    }

    fn step(
        &mut self,
        handover: &mut Handover<S>,
        cx: &Context<'_, S>,
    ) -> Result<Setpoints<S>, Exit> {
        let is_far_out = cx.situation.estimate.tether.is_some_and(|t| t.length > S::lit(NEAR));
        let is_last = handover.plan.is_last_leg();
        let flies = cx.ground() != GroundState::OnGround;
        if flies && (handover.plan.is_done() || cx.situation.estimate.position.is_none()) {
            self.waited += S::lit(OUTER_DT);
            if self.waited > S::lit(PATIENCE) {
                let text = "Landing finds no ground: descending";
                return Err(Exit { failure: Failure::LandingOverdue, text });
            }
        }
        let fixed = if is_last { FixedPull::Floor } else { FixedPull::Full };
        let tension = cx.tension(handover, is_far_out, fixed);
        let asked = plan::fly(handover, tension, cx);
        // A vehicle that flies lower than it is asked may stand before the reference does.
        Ok(Setpoints { wants_down: is_last, ..asked })
    }
}
