//! Tether Hold: stays where it is, and moves in tether coordinates.

use super::{Context, Entry, Exit, FlightMode, Handover, Refusal, Setpoints, plan};
use crate::scalar::Scalar;
use crate::signal::Action;

/// All of it is in the handover.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hold;

impl<S: Scalar> FlightMode<S> for Hold {
    fn enter(
        _entry: &Entry,
        handover: &mut Handover<S>,
        cx: &Context<'_, S>,
    ) -> Result<Self, Refusal> {
        if cx.is_in_air() {
            plan::stay(handover, cx);
        }
        Ok(Self)
    }

    fn step(
        &mut self,
        handover: &mut Handover<S>,
        cx: &Context<'_, S>,
    ) -> Result<Setpoints<S>, Exit> {
        let tension = cx.tension_in_flight(handover);
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
