//! Who may ask: in flight one ground station has the command, and nobody else moves the vehicle.
//!
//! Whoever arms it has the command until the motors stop, gives it back, or falls silent. The vehicle's own machinery
//! and its companions, which share its system id, may always ask.

use super::{Moment, Vehicle};
use crate::mode::{Refusal, rejected};
use crate::scalar::Scalar;
use crate::signal::{Action, Ticket};
use crate::time::Micros;

/// A ground station that was silent this long is not there.
const LINK_TIMEOUT_US: u64 = 3_000_000;

pub(super) const NOT_YOURS: Refusal = rejected("Refused: another ground station has command");

impl<S: Scalar> Vehicle<S> {
    pub(super) fn link_is_up(&self, now: Micros) -> bool {
        // No shorter than the silence that counts as loss: a simulator in a hurry stretches that one.
        let lost = (self.params.link_loss_time * 1e6) as u64;
        self.state.link_at.is_some_and(|at| now.since(at) < LINK_TIMEOUT_US.max(lost))
    }

    fn is_own(&self, ticket: Ticket) -> bool {
        ticket.system == 0 || ticket.system == self.params.system_id as u8
    }

    /// Whether this one may ask for that now. A set-point is the mode's own question: outside Offboard it is nothing.
    pub(super) fn authorise(
        &mut self,
        ticket: Ticket,
        action: &Action,
        at: Moment<'_, S>,
    ) -> Result<(), Refusal> {
        if self.situation.armed_at.is_none() || self.is_own(ticket) {
            return Ok(());
        }
        let stops = matches!(action, Action::Terminate | Action::Disarm { force: true });
        match self.state.commander {
            Some(system) if system == ticket.system => Ok(()),
            Some(_) if self.link_is_up(at.now) => Err(NOT_YOURS),
            // To stop the motors in the air takes the command first.
            _ if stops && self.context(at).is_in_air() => Err(NOT_YOURS),
            _ => {
                self.state.commander = Some(ticket.system);
                Ok(())
            }
        }
    }

    /// Taking it needs no more than being authorised.
    pub(super) fn hand_over(&mut self, ticket: Ticket, take: bool) {
        let holder = take.then_some(ticket.system).filter(|_| !self.is_own(ticket));
        self.state.commander = holder;
    }
}
