//! A pilot's radio. Its sticks enter where a joystick's do; its switches ask for what a ground station asks, by the same
//! way, and act when they change. Frames without a pilot behind them change nothing.
//!
//! While a pilot is heard the sticks are the radio's, where `COM_RC_IN_MODE` allows it; of two who ask for a mode the
//! last one has it; the kill switch always stops.

use super::{Moment, Vehicle};
use crate::scalar::Scalar;
use crate::sense::{Pilot, Switches};
use crate::signal::{Action, Event, EventQueue, Outcome, RawRadio, Request, Ticket};
use crate::supervisor::Mode;
use crate::time::{Micros, Sample};

/// `COM_RC_IN_MODE`.
const RADIO_ONLY: i32 = 0;
const JOYSTICK_ONLY: i32 = 1;
/// A slot of the mode switch that nothing is assigned to.
const UNASSIGNED: i32 = -1;

/// What moves.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RadioState {
    /// When a pilot was heard last.
    heard_at: Option<Micros>,
    /// Of the last frame: a position counts when two frames agree on it.
    seen: Option<Switches>,
    /// What counts.
    switches: Option<Switches>,
    /// The operator was told so.
    is_told_lost: bool,
}

/// Each switch where two frames in a row have it, else where it was: one that trembles holds up no other.
fn settled(before: &Switches, seen: &Switches, now: &Switches) -> Switches {
    Switches {
        mode: if seen.mode == now.mode { now.mode } else { before.mode },
        arm: if seen.arm == now.arm { now.arm } else { before.arm },
        kill: if seen.kill == now.kill { now.kill } else { before.kill },
    }
}

impl RadioState {
    /// There was a pilot once, who has been silent for so long, µs.
    pub fn silence_us(&self, now: Micros) -> Option<u64> {
        self.heard_at.map(|at| now.since(at))
    }
}

impl<S: Scalar> Vehicle<S> {
    /// A pilot is there.
    pub(super) fn radio_is_up(&self, now: Micros) -> bool {
        let silence = self.state.radio.silence_us(now);
        silence.is_some_and(|us| us <= self.params.stick_timeout_us())
    }

    /// There was one, and is no more.
    pub(super) fn radio_is_lost(&self, now: Micros) -> bool {
        let silence = self.state.radio.silence_us(now);
        silence.is_some_and(|us| us > self.params.stick_timeout_us())
    }

    /// Whether a joystick's word counts.
    pub(super) fn admits_joystick(&self, now: Micros) -> bool {
        match self.params.rc_mode as i32 {
            RADIO_ONLY => false,
            JOYSTICK_ONLY => true,
            _ => !self.radio_is_up(now),
        }
    }

    /// A flight that begins without a radio does not miss it.
    pub(super) fn forget_lost_radio(&mut self, now: Micros) {
        if self.radio_is_lost(now) {
            let radio = &mut self.state.radio;
            (radio.heard_at, radio.is_told_lost) = (None, false);
        }
    }

    /// A frame of the receiver; whether its switches asked for something.
    #[inline(never)]
    pub(super) fn hear(
        &mut self,
        frame: &Sample<RawRadio>,
        at: Moment<'_, S>,
        events: &mut EventQueue,
    ) -> bool {
        self.output.radio = Some(*frame);
        if !frame.value.is_heard() {
            return false;
        }
        self.state.radio.heard_at = Some(frame.at);
        let pilot = Pilot::new(&self.params, &frame.value);
        let is_pilot = self.obeys_radio();
        if let Some(value) = pilot.sticks.filter(|_| is_pilot) {
            self.situation.sticks = Some(Sample { at: frame.at, value });
        }
        let Some(seen) = self.state.radio.seen.replace(pilot.switches) else {
            return false;
        };
        // What is first seen is where the switches are, and asks for nothing.
        let before = self.state.radio.switches.unwrap_or(seen);
        let now = settled(&before, &seen, &pilot.switches);
        self.state.radio.switches = Some(now);
        let is_killed = now.kill && self.situation.armed_at.is_some();
        if is_killed {
            self.ask(Action::Terminate, at, events);
        }
        let is_switched = is_pilot && now != before;
        if is_switched {
            self.switch(&before, &now, at, events);
        }
        is_killed || is_switched
    }

    fn switch(
        &mut self,
        before: &Switches,
        now: &Switches,
        at: Moment<'_, S>,
        events: &mut EventQueue,
    ) {
        let mode = now.mode.filter(|_| before.mode.is_some() && now.mode != before.mode);
        if let Some(slot) = mode {
            self.ask_mode(slot, at, events);
        }
        match (before.arm, now.arm) {
            (Some(false), Some(true)) => {
                // What the switch shows is what flies.
                let is_there = match now.mode.filter(|_| mode.is_none()) {
                    Some(slot) => self.ask_mode(slot, at, events),
                    None => true,
                };
                if is_there {
                    self.ask(Action::Arm { force: false }, at, events);
                }
            }
            (Some(true), Some(false)) => {
                self.ask(Action::Disarm { force: false }, at, events);
            }
            _ => {}
        }
    }

    /// By a slot of the mode switch; whether it was not refused.
    fn ask_mode(&mut self, slot: u8, at: Moment<'_, S>, events: &mut EventQueue) -> bool {
        match (self.params.flight_mode(slot), Mode::from_switch(self.params.flight_mode(slot))) {
            (UNASSIGNED, _) => true,
            (_, Some(mode)) => self.ask(Action::SetMode(mode), at, events),
            (_, None) => {
                events.push(Event::warning("Mode switch: COM_FLTMODE names no mode of ours"));
                false
            }
        }
    }

    /// As a ground station asks, and with nobody to acknowledge it to; whether it was not refused.
    fn ask(&mut self, action: Action, at: Moment<'_, S>, events: &mut EventQueue) -> bool {
        let request = Request { ticket: Ticket::default(), action };
        let reply = self.take_up(Some(&request), at, events);
        reply.is_none_or(|reply| reply.outcome == Outcome::Accepted)
    }

    /// Told once each way.
    pub(super) fn tell_radio(&mut self, now: Micros, events: &mut EventQueue) {
        let is_lost = self.radio_is_lost(now);
        let told = &mut self.state.radio.is_told_lost;
        if core::mem::replace(told, is_lost) == is_lost {
            return;
        }
        events.push(if is_lost {
            Event::warning("Radio lost")
        } else {
            Event::info("Radio is back")
        });
    }

    /// A pilot's switch wants the motors to run: whoever has the sticks keeps the throttle down till then.
    pub(super) fn arms_by_radio(&self) -> bool {
        let switches = self.state.radio.switches;
        switches.is_some_and(|switches| switches.arm == Some(true)) && self.obeys_radio()
    }

    /// A pilot has stopped the motors for good. It stays so when the radio falls silent.
    pub(super) fn is_killed(&self) -> bool {
        self.state.radio.switches.is_some_and(|switches| switches.kill)
    }

    /// More than the kill switch.
    pub(super) fn obeys_radio(&self) -> bool {
        self.params.rc_mode as i32 != JOYSTICK_ONLY
    }

    /// A pilot who flies by sticks needs no ground station.
    pub(super) fn link_silence_us(&self, now: Micros) -> Option<u64> {
        let is_flown = self.mode.mode().rule().by_sticks && self.radio_is_up(now);
        self.state.link_at.filter(|_| !is_flown).map(|at| now.since(at))
    }
}
