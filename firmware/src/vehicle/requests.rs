//! What is asked from outside: checked, then done or refused with a reason.

use super::{Moment, Vehicle, context};
use crate::config::Stale;
use crate::mode::pendulum::gain_warning;
use crate::mode::{Entry, Refusal, denied, rejected};
use crate::param::{Group, META, Params};
use crate::scalar::Scalar;
use crate::signal::{Action, Event, EventQueue, Outcome, Reply, Request};
use crate::supervisor::Mode;

/// Accepted, or refused and told.
fn outcome_of(result: Result<(), Refusal>, events: &mut EventQueue) -> Outcome {
    match result {
        Ok(()) => Outcome::Accepted,
        Err((outcome, text)) => {
            events.push(Event::warning(text));
            outcome
        }
    }
}

impl<S: Scalar> Vehicle<S> {
    pub(super) fn handle(
        &mut self,
        request: &Request,
        at: Moment<'_, S>,
        events: &mut EventQueue,
    ) -> Option<Reply> {
        let mut parameter = None;
        let result = match request.action {
            Action::Arm { force } => self.arm(force, at, events),
            Action::Disarm { force } => self.disarm_on_request(force, at, events),
            Action::SetMode(mode) => self.request_mode(&Entry::of(mode), at),
            Action::Takeoff { altitude } => {
                self.request_mode(&Entry { mode: Mode::Takeoff, altitude }, at)
            }
            Action::Pause => self
                .request_mode(&Entry::of(Mode::default()), at)
                .and_then(|()| self.command(&request.action, at)),
            Action::MoveTo { .. } | Action::MoveTether { .. } | Action::MoveTaut { .. } => {
                self.command(&request.action, at)
            }
            Action::SetParam { index, value } => {
                parameter = Some(index);
                self.set_param(index, value, at, events)
            }
            Action::ResetParams => self.reset_params(at),
            Action::Level => self.level(),
        };
        if result.is_ok() && self.state.considered.is_none() && self.mode.is_considering() {
            self.state.considered = Some(request.ticket);
            return None;
        }
        Some(Reply { ticket: request.ticket, outcome: outcome_of(result, events), parameter })
    }

    /// The answer to a command that the mode takes several steps to consider.
    pub(super) fn consider(&mut self, at: Moment<'_, S>, events: &mut EventQueue) -> Option<Reply> {
        let ticket = self.state.considered?;
        let result = if self.mode.is_considering() {
            self.mode.consider(&context!(self, at))?
        } else {
            Err(rejected("Move refused: the mode has ended"))
        };
        self.state.considered = None;
        Some(Reply { ticket, outcome: outcome_of(result, events), parameter: None })
    }

    /// For the mode that flies.
    pub(super) fn command(&mut self, action: &Action, at: Moment<'_, S>) -> Result<(), Refusal> {
        self.mode.command(action, &context!(self, at))
    }

    fn set_param(
        &mut self,
        index: usize,
        value: f32,
        at: Moment<'_, S>,
        events: &mut EventQueue,
    ) -> Result<(), Refusal> {
        let group = META.get(index).map(|meta| meta.group);
        let is_guarded =
            matches!(group, Some(Group::Vehicle | Group::Motors | Group::Sensors | Group::Tether));
        if is_guarded && self.context(at).is_in_air() {
            return Err(rejected("Parameter refused: not in the air"));
        }
        self.params.set(index, value).map_err(|_| denied("Parameter refused: out of range"))?;
        self.reconfigure(group.map_or(Stale::ALL, Stale::after), at);
        if group == Some(Group::Pendulum)
            && let Some(text) = gain_warning(&self.params)
        {
            events.push(Event::warning(text));
        }
        Ok(())
    }

    fn reset_params(&mut self, at: Moment<'_, S>) -> Result<(), Refusal> {
        if self.situation.armed_at.is_some() {
            return Err(rejected("Reset refused: armed"));
        }
        self.params = Params::default();
        self.reconfigure(Stale::ALL, at);
        Ok(())
    }

    /// In the air the blocks follow one by one, in [`Self::maintain`]. On the ground there is time, and whatever is asked
    /// next finds all of them.
    fn reconfigure(&mut self, stale: Stale, at: Moment<'_, S>) {
        self.stale.add(stale);
        if self.situation.armed_at.is_none() {
            let handover = self.mode.handover_mut();
            handover.heading = S::from_f32(self.params.start_heading);
            handover.tension = S::from_f32(self.params.tension);
        }
        if !self.context(at).is_in_air() {
            while self.renew() {}
        }
    }

    fn level(&mut self) -> Result<(), Refusal> {
        if self.situation.armed_at.is_some() {
            return Err(rejected("Levelling refused: armed"));
        }
        self.situation.navigation.relevel();
        self.situation.estimate = self.config.navigation.estimate(&self.situation.navigation);
        Ok(())
    }
}
