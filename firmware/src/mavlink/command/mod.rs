//! Commands: each one is acknowledged, and ACCEPTED is said only of what is then done. Unknown ones are unsupported.
//!
//! COMMAND_LONG and COMMAND_INT are read by position, not through the crate's enum of commands: that
//! one refuses a number it does not know, and then nobody would answer.

mod calibration;
mod meaning;
mod place;

pub(super) use calibration::Calibration;
pub(super) use meaning::REBOOT;

use super::frame::Frame;
use super::telemetry::Outgoing;
use super::{Session, Sink, Wanted};
use crate::param::Params;
use crate::signal::{Action, Outcome, Reply, Request, Severity, Ticket};
use crate::supervisor::Mode;
use crate::vehicle::StepOutput;
use mavlink::MessageData;
use mavlink::dialects::common as mav;
use meaning::{Command, Meaning};

/// `MAV_RESULT`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum Answer {
    Accepted = 0,
    TemporarilyRejected = 1,
    Denied = 2,
    Unsupported = 3,
    UnsupportedFrame = 9,
}

impl Answer {
    fn of(outcome: Outcome) -> Self {
        match outcome {
            Outcome::Accepted => Self::Accepted,
            Outcome::Rejected => Self::TemporarilyRejected,
            Outcome::Denied => Self::Denied,
        }
    }
}

impl Session {
    pub(super) fn command(&mut self, frame: &Frame, params: &Params, sink: Sink) {
        let command = if frame.id == mav::COMMAND_INT_DATA::ID {
            Command::from_int(frame)
        } else {
            Command::from_long(frame)
        };
        if self.is_served && command.ticket.command == meaning::INJECT_FAILURE {
            return;
        }
        let ticket = Ticket { link: self.link, ..command.ticket };
        let meaning = command.meaning(params);
        if matches!(meaning, Meaning::Do(Action::Level)) {
            self.calibration = Calibration::Asked { is_level: command.latitude > 0.0 };
        }
        let answer = match meaning {
            // The vehicle's answer becomes the acknowledgement.
            Meaning::Do(action) => match self.requests.push_back(Request { ticket, action }) {
                Ok(()) => return,
                Err(_) => {
                    self.overflow();
                    Answer::TemporarilyRejected
                }
            },
            Meaning::Message { id, .. } if !super::telemetry::is_known(id) => Answer::Unsupported,
            // Acknowledged when it is seen whether there is anything to say.
            Meaning::Message { id, argument } => {
                let wanted = Wanted { id, argument, ticket: Some(ticket) };
                match self.once.push_back(wanted) {
                    Ok(()) => return,
                    Err(_) => Answer::TemporarilyRejected,
                }
            }
            Meaning::Interval { id, interval_us } => {
                let answer = self.streams.set_interval(id, interval_us);
                if answer == Answer::Accepted {
                    self.budget.lift();
                }
                answer
            }
            Meaning::CancelCalibration => {
                self.calibration.cancel();
                self.say(Severity::Info, "[cal] calibration cancelled", sink);
                Answer::Accepted
            }
            Meaning::Nothing(answer, text) => {
                if !text.is_empty() {
                    self.say(Severity::Warning, text, sink);
                }
                answer
            }
        };
        self.acknowledge(&ticket, answer, sink);
    }

    /// A message that was asked for, behind its acknowledgement: accepted only if there is anything to say.
    pub(in crate::mavlink) fn send_wanted(
        &mut self,
        wanted: &Wanted,
        out: &StepOutput,
        params: &Params,
        sink: Sink,
    ) {
        let at = Outgoing { out, params, argument: wanted.argument };
        if let Some(ticket) = &wanted.ticket {
            let before = (self.sequence, self.counters, self.budget);
            self.send_message(wanted.id, &at, &mut |_| {});
            let says_something = self.counters.sent != before.1.sent;
            (self.sequence, self.counters, self.budget) = before;
            let answer =
                if says_something { Answer::Accepted } else { Answer::TemporarilyRejected };
            self.acknowledge(ticket, answer, sink);
        }
        self.send_message(wanted.id, &at, sink);
    }

    /// A command that is not read: by nobody who holds the key, or too early.
    pub(super) fn reject(&mut self, frame: &Frame, for_good: bool, sink: Sink) {
        let answer = if for_good { Answer::Denied } else { Answer::TemporarilyRejected };
        self.acknowledge(&frame.ticket(frame.word(28)), answer, sink);
    }

    /// The old SET_MODE message; it has no acknowledgement of its own.
    pub(super) fn set_mode(&mut self, frame: &Frame, sink: Sink) {
        match Mode::from_custom_mode(frame.int(0) as u32) {
            Some(mode) => self.queue(frame, Action::SetMode(mode)),
            None => {
                self.refuse();
                self.say(Severity::Warning, "Mode refused: unknown", sink);
            }
        }
    }

    /// What the vehicle says to a request of this connection.
    pub(super) fn answer(&mut self, reply: &Reply, sink: Sink) {
        if let Some(index) = reply.parameter {
            self.echo(index);
        }
        if reply.ticket.command != 0 && reply.ticket.link == self.link {
            self.acknowledge(&reply.ticket, Answer::of(reply.outcome), sink);
            if reply.ticket.command == meaning::CALIBRATE && reply.outcome == Outcome::Accepted {
                self.begin_calibration(sink);
            }
        }
    }

    fn acknowledge(&mut self, ticket: &Ticket, answer: Answer, sink: Sink) {
        let [low, high] = ticket.command.to_le_bytes();
        let payload = [low, high, answer as u8, 0, 0, 0, 0, 0, ticket.system, ticket.component];
        self.send_raw(mav::COMMAND_ACK_DATA::ID, mav::COMMAND_ACK_DATA::EXTRA_CRC, &payload, sink);
    }
}
