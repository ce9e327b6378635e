//! Land: returns and comes down along a plan.

use super::context::FixedPull;
use super::{Context, Entry, Exit, FlightMode, Handover, Refusal, Setpoints, plan};
use crate::scalar::Scalar;

/// A winch pulls gently from this length on, m.
const NEAR: f64 = 4.0;

/// All of it is in the handover.
#[derive(Clone, Copy, Debug)]
pub(super) struct Land;

impl<S: Scalar> FlightMode<S> for Land {
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
        Ok(Self)
    }

    fn step(
        &mut self,
        handover: &mut Handover<S>,
        cx: &Context<'_, S>,
    ) -> Result<Setpoints<S>, Exit> {
        let is_far_out = cx.situation.estimate.tether.is_some_and(|t| t.length > S::lit(NEAR));
        let is_last = handover.plan.is_last_leg();
        let fixed = if is_last { FixedPull::Floor } else { FixedPull::Full };
        let tension = cx.tension(handover, is_far_out, fixed);
        let asked = plan::fly(handover, tension, cx);
        // A vehicle that flies lower than it is asked may stand before the reference does.
        Ok(Setpoints { wants_down: is_last, ..asked })
    }
}
