//! Who is believed: whoever holds the key or the cable. The others may look, and are told why they may no more.

// MAVLink deprecates messages that today's clients still send.
#![allow(deprecated)]

use super::capture::is_measurement;
use super::frame::Frame;
use super::receive::target;
use super::signing::{KEY, NewKey, Verdict};
use super::{Session, Sink, TOLD_AGAIN_US};
use crate::signal::Severity;
use crate::time::Micros;
use heapless::Deque;
use mavlink::MessageData;
use mavlink::dialects::common as mav;

/// Whether a frame is heard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Admission {
    /// Yes.
    Granted,
    /// Only when its time is kept: in some milliseconds.
    NotYet,
    /// No.
    Refused,
}

/// Senders that were told.
#[derive(Debug, Default)]
pub(super) struct Told {
    /// System and component; with so many the first is told again.
    senders: Deque<[u8; 2], 8>,
    at: Option<Micros>,
}

impl Told {
    /// Once each, and whoever changes their names hears no more of it.
    fn is_due(&mut self, sender: [u8; 2], now: Micros) -> bool {
        let was_told = self.senders.iter().any(|known| *known == sender);
        if was_told || self.at.is_some_and(|at| now.since(at) < TOLD_AGAIN_US) {
            return false;
        }
        if self.senders.is_full() {
            self.senders.pop_front();
        }
        let _ = self.senders.push_back(sender);
        self.at = Some(now);
        true
    }
}

impl Session {
    /// What the key says to a frame. Who holds the cable may have lost the key.
    pub(super) fn admit(&mut self, frame: &Frame) -> Admission {
        let Some(signing) = &mut self.signing else { return Admission::Granted };
        let verdict = signing.judge(frame, self.is_armed);
        if verdict == Verdict::Good || self.is_local || only_reads(frame) {
            return Admission::Granted;
        }
        if verdict == Verdict::Early {
            return Admission::NotYet;
        }
        // Everybody beats; who does not hold the key is not heard.
        if frame.id != mav::HEARTBEAT_DATA::ID {
            self.counters.unsigned = self.counters.unsigned.wrapping_add(1);
        }
        Admission::Refused
    }

    /// Answers who was not admitted.
    pub(super) fn turn_away(
        &mut self,
        now: Micros,
        frame: &Frame,
        admission: Admission,
        sink: Sink,
    ) {
        if matches!(frame.id, mav::COMMAND_LONG_DATA::ID | mav::COMMAND_INT_DATA::ID) {
            self.reject(frame, admission == Admission::Refused, sink);
        }
        // What is for everybody is no command.
        let is_for_us = target(frame).is_some() || is_measurement(frame.id);
        let sender = [frame.system, frame.component];
        if admission == Admission::Refused && is_for_us && self.told.is_due(sender, now) {
            self.say(Severity::Warning, "Refused: not signed with this vehicle's key", sink);
        }
    }

    /// SETUP_SIGNING, by position. Whether it is done is told when the key is kept.
    pub(super) fn set_key(&mut self, now: Micros, frame: &Frame, sink: Sink) {
        const SECRET: usize = 10;
        if !self.is_local {
            return self.refuse_aloud(now, "Signing key refused: by the USB cable only", sink);
        }
        if self.is_armed {
            return self.refuse_aloud(now, "Signing key refused: armed", sink);
        }
        let mut key = [0; KEY];
        for (at, byte) in (SECRET..).zip(&mut key) {
            *byte = frame.byte(at);
        }
        let start = (4..8)
            .rev()
            .chain((0..4).rev())
            .fold(0, |sum, at| sum << 8 | u64::from(frame.byte(at)));
        match NewKey::try_new(key, start) {
            Some(new) => self.new_key = Some(new),
            None => self.refuse_aloud(now, "Signing key refused: no such time", sink),
        }
    }
}

/// What anybody may ask: it tells, and changes nothing.
fn only_reads(frame: &Frame) -> bool {
    const GET_HOME: u16 = 410;
    const ABOUT_MESSAGES: core::ops::RangeInclusive<u16> = 510..=512;
    const VERSIONS: core::ops::RangeInclusive<u16> = 519..=520;
    match frame.id {
        mav::COMMAND_LONG_DATA::ID | mav::COMMAND_INT_DATA::ID => {
            let command = frame.word(28);
            command == GET_HOME || ABOUT_MESSAGES.contains(&command) || VERSIONS.contains(&command)
        }
        mav::PARAM_REQUEST_LIST_DATA::ID
        | mav::PARAM_REQUEST_READ_DATA::ID
        | mav::MISSION_REQUEST_LIST_DATA::ID
        | mav::LOG_REQUEST_LIST_DATA::ID
        | mav::LOG_REQUEST_DATA_DATA::ID
        | mav::FILE_TRANSFER_PROTOCOL_DATA::ID
        | mav::PING_DATA::ID
        | mav::TIMESYNC_DATA::ID => true,
        _ => false,
    }
}
