//! Tether Hold: stays where it is, and moves in tether coordinates.

use super::{Context, Entry, Exit, FlightMode, Handover, Refusal, Setpoints, plan};
use crate::scalar::Scalar;
use crate::signal::Action;

/// The rest is in the handover.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Hold {
    /// There was no place to stay at yet.
    is_lost: bool,
}

impl<S: Scalar> FlightMode<S> for Hold {
    fn enter(
        _entry: &Entry,
        handover: &mut Handover<S>,
        cx: &Context<'_, S>,
    ) -> Result<Self, Refusal> {
        if cx.is_in_air() {
            plan::stay(handover, cx);
        }
        Ok(Self { is_lost: cx.is_in_air() && cx.situation.estimate.position.is_none() })
    }

    fn step(
        &mut self,
        handover: &mut Handover<S>,
        cx: &Context<'_, S>,
    ) -> Result<Setpoints<S>, Exit> {
        let tension = cx.tension_in_flight(handover);
        if self.is_lost && cx.situation.smoothed.is_some() {
            // Where it is now, not where it once was to be.
            plan::stay(handover, cx);
            self.is_lost = false;
        }
        Ok(plan::fly(handover, tension, cx))
    }

    fn command(
        &mut self,
        handover: &mut Handover<S>,
        action: &Action,
        cx: &Context<'_, S>,
    ) -> Result<(), Refusal> {
        if let Some(tension) = plan::command(handover, action, cx)? {
            handover.tension = tension;
        }
        Ok(())
    }
}
