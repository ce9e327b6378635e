//! What is asked from outside: checked, then done or refused with a reason.

use super::authority::NOT_YOURS;
use super::{Moment, Vehicle, context};
use crate::config::Stale;
use crate::mode::pendulum::gain_warning;
use crate::mode::{Entry, Refusal, denied, rejected};
use crate::param::{Group, Lock, META, Params, broken};
use crate::scalar::Scalar;
use crate::signal::{Action, Event, EventQueue, Outcome, Reply, Request, Setpoint};
use crate::supervisor::Mode;
use crate::time::{Micros, Sample};

/// Accepted, or refused and told.
fn outcome_of(result: Result<(), Refusal>, events: &mut EventQueue) -> Outcome {
    match result {
        Ok(()) => Outcome::Accepted,
        Err(refusal) => {
            events.push(refusal.reason);
            refusal.outcome
        }
    }
}

/// What is refused many times a second is told again after this time, µs.
const REFUSED_AGAIN_US: u64 = 5_000_000;

/// In flight a gain or a limit changes by a half at most, or a little where it is near zero.
fn is_small_step(before: f32, after: f32) -> bool {
    let (low, high) = (before.min(after), before.max(after));
    high <= 1.5 * low || high - low <= 0.1
}

impl<S: Scalar> Vehicle<S> {
    /// The request of this step, or one that waited, or what the mode still considers.
    pub(super) fn take_up(
        &mut self,
        request: Option<&Request>,
        at: Moment<'_, S>,
        events: &mut EventQueue,
    ) -> Option<Reply> {
        match request {
            Some(request) if self.must_wait(request, at) => {
                let ticket = request.ticket;
                let refusal = Err(rejected("Busy: parameters are taken in"));
                let is_full = self.state.waiting.push_back(*request).is_err();
                is_full.then(|| Reply {
                    ticket,
                    outcome: outcome_of(refusal, events),
                    parameter: None,
                })
            }
            Some(request) => self.handle(request, at, events),
            None if self.stale.is_empty() && !self.state.waiting.is_empty() && !at.is_full => {
                let request = self.state.waiting.pop_front()?;
                self.handle(&request, at, events)
            }
            None => self.consider(at, events),
        }
    }

    /// On the ground whatever is asked after a change of parameters finds all of them: it waits for the blocks, a
    /// millisecond each. More parameters, and a stop, do not. In the air it waits for a millisecond that has room.
    fn must_wait(&self, request: &Request, at: Moment<'_, S>) -> bool {
        let is_busy = !self.stale.is_empty() || !self.state.waiting.is_empty();
        let is_prompt = matches!(
            request.action,
            Action::SetParam { .. }
                | Action::ResetParams
                | Action::Disarm { .. }
                | Action::Terminate
        );
        !is_prompt && (at.is_full || (is_busy && !self.context(at).is_in_air()))
    }

    fn handle(
        &mut self,
        request: &Request,
        at: Moment<'_, S>,
        events: &mut EventQueue,
    ) -> Option<Reply> {
        let mut parameter = None;
        let result = self.authorise(request.ticket, &request.action, at).and_then(|()| {
            match request.action {
                Action::Arm { force } => {
                    self.arm(force, at, events).map(|()| self.hand_over(request.ticket, true))
                }
                Action::Disarm { force } => self.disarm_on_request(force, at, events),
                Action::Terminate => {
                    self.terminate(at, events);
                    Ok(())
                }
                Action::TestMotor { rotor, throttle, seconds } => {
                    self.test_motor((rotor, throttle, seconds), at.now, events)
                }
                Action::Reboot if self.situation.armed_at.is_some() => {
                    Err(rejected("Reboot refused: armed"))
                }
                Action::Reboot => Ok(()),
                Action::Command { take } => {
                    self.hand_over(request.ticket, take);
                    Ok(())
                }
                // To hold is to stop, also a move under way.
                Action::SetMode(mode) if mode != Mode::default() => {
                    self.request_mode(&Entry::of(mode), at)
                }
                Action::Takeoff { altitude } => {
                    self.request_mode(&Entry { mode: Mode::Takeoff, altitude }, at)
                }
                Action::Pause | Action::SetMode(_) => self
                    .request_mode(&Entry::of(Mode::default()), at)
                    .and_then(|()| self.command(&Action::Pause, at)),
                Action::MoveTo { .. } | Action::MoveTether { .. } | Action::MoveTaut { .. } => {
                    self.command(&request.action, at)
                }
                Action::Setpoint(setpoint) => self.take_setpoint(setpoint, at),
                Action::SetParam { index, value } => {
                    parameter = Some(index);
                    self.set_param(index, value, at, events)
                }
                Action::ResetParams => self.reset_params(),
                Action::Level => self.level(),
                Action::Face { heading } => self.face(heading),
            }
        });
        if result.is_ok() && self.state.considered.is_none() && self.mode.is_considering() {
            self.state.considered = Some(request.ticket);
            return None;
        }
        let outcome = if self.is_old_news(&request.action, result, at.now) {
            outcome_of(result, &mut EventQueue::default())
        } else {
            outcome_of(result, events)
        };
        Some(Reply { ticket: request.ticket, outcome, parameter })
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

    /// Kept for the mode that follows it, which may refuse it.
    fn take_setpoint(&mut self, setpoint: Setpoint, at: Moment<'_, S>) -> Result<(), Refusal> {
        self.situation.setpoint = Some(Sample { at: at.now, value: setpoint });
        if self.mode.mode() == Mode::Offboard {
            self.command(&Action::Setpoint(setpoint), at)
        } else {
            Ok(())
        }
    }

    /// A stream, and a stranger, are refused many times a second, and that is told once.
    fn is_old_news(&mut self, action: &Action, result: Result<(), Refusal>, now: Micros) -> bool {
        let repeats = matches!(action, Action::Setpoint(_)) || result == Err(NOT_YOURS);
        let last = &mut self.state.refusal_told;
        let is_new = last.is_none_or(|at| now.since(at) > REFUSED_AGAIN_US);
        if repeats && result.is_err() && is_new {
            *last = Some(now);
        }
        repeats && !is_new
    }

    fn set_param(
        &mut self,
        index: usize,
        value: f32,
        at: Moment<'_, S>,
        events: &mut EventQueue,
    ) -> Result<(), Refusal> {
        let group = META.get(index).map(|meta| meta.group);
        let is_in_air = self.context(at).is_in_air();
        let is_armed = self.situation.armed_at.is_some();
        match group.map_or(Lock::Never, Group::lock) {
            Lock::Armed if is_armed => return Err(rejected("Parameter refused: armed")),
            Lock::InAir if is_in_air => return Err(rejected("Parameter refused: not in the air")),
            _ => {}
        }
        let mut changed = self.params;
        changed.set(index, value).map_err(|_| denied("Parameter refused: out of range"))?;
        if is_in_air {
            let is_gain = group == Some(Group::PositionControl);
            let before = self.params.get(index).unwrap_or(value);
            if is_gain && !is_small_step(before, value) {
                return Err(denied("Parameter refused: too large a step in the air"));
            }
        }
        // Armed on the ground too: nothing looks again before the take-off.
        if let Some(rule) = broken(&changed).filter(|_| is_armed) {
            return Err(denied(rule.text));
        }
        self.params = changed;
        self.reconfigure(group.map_or(Stale::ALL, Stale::after));
        if group == Some(Group::Pendulum)
            && let Some(text) = gain_warning(&self.params)
        {
            events.push(Event::warning(text));
        }
        Ok(())
    }

    fn reset_params(&mut self) -> Result<(), Refusal> {
        if self.situation.armed_at.is_some() {
            return Err(rejected("Reset refused: armed"));
        }
        self.params = Params::default();
        self.reconfigure(Stale::ALL);
        Ok(())
    }

    /// The blocks follow one by one, in [`Self::maintain`].
    fn reconfigure(&mut self, stale: Stale) {
        self.stale.add(stale);
        if self.situation.armed_at.is_none() {
            let handover = self.mode.handover_mut();
            handover.heading = S::from_f32(self.params.start_heading);
            handover.tension = S::from_f32(self.params.tension);
        }
    }

    /// What was asked of the heading stays asked: the vehicle turns back to it.
    fn face(&mut self, heading: f32) -> Result<(), Refusal> {
        if !self.situation.estimate.is_levelled {
            return Err(rejected("Heading refused: not levelled yet"));
        }
        self.situation.navigation.face(S::from_f32(heading));
        if self.situation.armed_at.is_none() {
            self.mode.handover_mut().heading = S::from_f32(heading);
        }
        Ok(())
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sense::ImuScale;
    use crate::signal::Ticket;
    use crate::vehicle::StepInput;

    fn ask(vehicle: &mut Vehicle<f32>, action: Action) -> Option<Outcome> {
        let request = Some(Request { ticket: Ticket::default(), action });
        let out = *vehicle.step(&StepInput { request, ..StepInput::default() });
        vehicle.maintain();
        out.reply.map(|reply| reply.outcome)
    }

    fn wait(vehicle: &mut Vehicle<f32>) -> Option<Outcome> {
        (0..20).find_map(|_| {
            let reply = vehicle.step(&StepInput::default()).reply;
            vehicle.maintain();
            reply.map(|reply| reply.outcome)
        })
    }

    #[test]
    fn what_is_asked_on_the_ground_waits_for_the_parameters_and_a_stop_does_not() {
        let scale = ImuScale { gyro: 1e-3, accel: 5e-3, rate_hz: 1000.0 };
        let mut vehicle = Vehicle::<f32>::new(Params::default(), scale);
        let index = Params::index_of(b"VEH_MASS").unwrap();
        let set = Action::SetParam { index, value: 1.6 };
        assert_eq!(ask(&mut vehicle, set), Some(Outcome::Accepted));
        assert_eq!(ask(&mut vehicle, Action::Level), None, "not before its time");
        assert_eq!(ask(&mut vehicle, set), Some(Outcome::Accepted), "more parameters do not wait");
        assert!(ask(&mut vehicle, Action::Disarm { force: true }).is_some(), "nor does a stop");
        assert_eq!(wait(&mut vehicle), Some(Outcome::Accepted), "answered in the end");
        // More than there is room for are refused, not lost.
        assert_eq!(ask(&mut vehicle, set), Some(Outcome::Accepted));
        let answers: [_; 6] = core::array::from_fn(|_| ask(&mut vehicle, Action::Level));
        assert_eq!(
            answers,
            [None, None, None, None, Some(Outcome::Rejected), Some(Outcome::Rejected)]
        );
        assert!((0..4).all(|_| wait(&mut vehicle) == Some(Outcome::Accepted)));
    }
}
