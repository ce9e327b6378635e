//! What each incoming message means.

// MAVLink deprecates messages that today's clients still send and ask for.
#![allow(deprecated)]

use super::admission::Admission;
use super::capture::is_measurement;
use super::frame::Frame;
use super::params::name_bytes;
use super::{COMPONENT_AUTOPILOT, Session, Sink, TOLD_AGAIN_US, global};
use crate::param::Params;
use crate::signal::{Action, Setpoint, Severity, Sticks};
use crate::time::{Micros, Sample};
use mavlink::dialects::common as mav;
use mavlink::{MavlinkVersion, MessageData};

/// `MAV_TYPE_GCS`.
const GCS: u8 = 6;
/// SET_POSITION_TARGET: bits of the type mask, and the frames understood, local and global.
const IGNORE_X: u16 = 1;
const IGNORE_VX: u16 = 1 << 3;
const IGNORE_YAW: u16 = 1 << 10;
const LOCAL_NED: u8 = 1;
const GLOBAL_RELATIVE: [u8; 2] = [3, 6];
const GLOBAL: [u8; 2] = [0, 5];
/// SET_ATTITUDE_TARGET.
const IGNORE_RATES: u8 = 0b111;
const IGNORE_THRUST: u8 = 1 << 6;
const IGNORE_ATTITUDE: u8 = 1 << 7;
/// RC_CHANNELS_OVERRIDE: middle and half range of a channel, and of the throttle its lowest, µs.
const RC_MIDDLE: f32 = 1500.0;
const RC_HALF: f32 = 500.0;
const RC_LOW: f32 = 1000.0;

impl Session {
    // Inlined it would be in an image twice, 9 KB.
    #[inline(never)]
    pub(super) fn handle(&mut self, now: Micros, frame: &Frame, params: &Params, sink: Sink) {
        let is_own = frame.system == self.system && frame.component == COMPONENT_AUTOPILOT;
        // Nobody is system 0.
        if is_own || frame.system == 0 {
            return;
        }
        let admission = self.admit(frame);
        if let Some((system, component)) = target(frame) {
            let for_us = (system == 0 || system == self.system)
                && (component == 0 || component == COMPONENT_AUTOPILOT);
            if !for_us {
                self.ignore();
                return;
            }
        }
        self.counters.received = self.counters.received.wrapping_add(1);
        if admission != Admission::Granted {
            return self.turn_away(now, frame, admission, sink);
        }
        match frame.id {
            mav::HEARTBEAT_DATA::ID => {
                if frame.byte(4) == GCS && self.has_command(frame) {
                    self.heartbeat_at = Some(now);
                }
            }
            mav::COMMAND_LONG_DATA::ID | mav::COMMAND_INT_DATA::ID => {
                self.command(frame, params, sink);
            }
            mav::SET_MODE_DATA::ID => self.set_mode(frame, sink),
            mav::PARAM_REQUEST_LIST_DATA::ID => self.list_parameters(),
            mav::PARAM_REQUEST_READ_DATA::ID => {
                self.decode(frame, |session, m: &mav::PARAM_REQUEST_READ_DATA| {
                    let asked = (m.param_index, name_bytes(&m.param_id));
                    session.read_parameter(frame, asked, params, sink);
                })
            }
            // By position: the crate refuses a type that it does not know, and then nobody would answer.
            mav::PARAM_SET_DATA::ID => {
                let mut id = [0_u8; 16];
                for (at, byte) in (6..).zip(&mut id) {
                    *byte = frame.byte(at);
                }
                let sent = (name_bytes(&id), frame.float(0), frame.byte(22));
                self.set_parameter(frame, sent, params, sink);
            }
            mav::MANUAL_CONTROL_DATA::ID if self.has_command(frame) => {
                self.decode(frame, |session, m: &mav::MANUAL_CONTROL_DATA| {
                    session.manual_control(now, m)
                });
            }
            mav::RC_CHANNELS_OVERRIDE_DATA::ID if self.has_command(frame) => {
                self.radio_override(now, frame);
            }
            mav::SET_POSITION_TARGET_LOCAL_NED_DATA::ID => self.position_target(now, frame, sink),
            mav::SET_POSITION_TARGET_GLOBAL_INT_DATA::ID => {
                self.global_target(now, frame, params, sink);
            }
            mav::SET_ATTITUDE_TARGET_DATA::ID => self.attitude_target(now, frame, sink),
            id if is_measurement(id) => self.measured(now, frame, params),
            mav::SETUP_SIGNING_DATA::ID => self.set_key(now, frame, sink),
            mav::PING_DATA::ID => self.decode(frame, |session, m: &mav::PING_DATA| {
                if m.target_system == 0 {
                    let pong = mav::PING_DATA {
                        target_system: frame.system,
                        target_component: frame.component,
                        ..m.clone()
                    };
                    session.send(&pong, sink);
                }
            }),
            mav::TIMESYNC_DATA::ID => self.decode(frame, |session, m: &mav::TIMESYNC_DATA| {
                if m.tc1 == 0 {
                    let answer =
                        mav::TIMESYNC_DATA { tc1: now.0.saturating_mul(1000) as i64, ts1: m.ts1 };
                    session.send(&answer, sink);
                }
            }),
            _ => self.serve(frame, sink),
        }
    }

    pub(super) fn ignore(&mut self) {
        self.counters.ignored = self.counters.ignored.wrapping_add(1);
    }

    fn decode<D: MessageData>(&mut self, frame: &Frame, then: impl FnOnce(&mut Self, &D)) {
        match D::deser(MavlinkVersion::V2, frame.payload) {
            Ok(message) => then(self, &message),
            Err(_) => self.refuse(),
        }
    }

    fn manual_control(&mut self, now: Micros, m: &mav::MANUAL_CONTROL_DATA) {
        let in_range = |v: i16| (-1000..=1000).contains(&v);
        if ![m.x, m.y, m.z, m.r].into_iter().all(in_range) {
            return self.refuse();
        }
        let unit = |v: i16| f32::from(v) * 1e-3;
        let value = Sticks {
            pitch: unit(m.x),
            roll: unit(m.y),
            throttle: unit(m.z).max(0.0),
            yaw: unit(m.r),
        };
        self.sticks = Some(Sample { at: now, value });
    }

    /// Roll, pitch, throttle, yaw, as ArduPilot's clients send them; a channel that is not overridden gives the sticks
    /// back.
    fn radio_override(&mut self, now: Micros, frame: &Frame) {
        let channels = [0, 2, 4, 6].map(|at| frame.word(at));
        if channels.iter().any(|us| !(800..=2200).contains(us)) {
            return self.refuse();
        }
        let unit = |us: u16| ((f32::from(us) - RC_MIDDLE) / RC_HALF).clamp(-1.0, 1.0);
        let [roll, pitch, throttle, yaw] = channels;
        let value = Sticks {
            roll: unit(roll),
            // The stick forward is the lower value.
            pitch: -unit(pitch),
            throttle: ((f32::from(throttle) - RC_LOW) / (2.0 * RC_HALF)).clamp(0.0, 1.0),
            yaw: unit(yaw),
        };
        self.sticks = Some(Sample { at: now, value });
    }

    /// Read by position: the crate refuses a type mask with unknown bits, which clients do send.
    fn position_target(&mut self, now: Micros, frame: &Frame, sink: Sink) {
        if frame.byte(52) != LOCAL_NED {
            return self.refuse_aloud(now, "Set-point refused: frame is not LOCAL_NED", sink);
        }
        let mask = frame.word(48);
        let asked = |at: usize, bit: u16| (mask & bit == 0).then(|| frame.float(at));
        let ned = [asked(4, IGNORE_X), asked(8, IGNORE_X << 1), asked(12, IGNORE_X << 2)];
        self.place(now, frame, (ned, mask), sink);
    }

    fn global_target(&mut self, now: Micros, frame: &Frame, params: &Params, sink: Sink) {
        let mask = frame.word(48);
        let datum = match frame.byte(52) {
            kind if GLOBAL.contains(&kind) => params.home_altitude,
            kind if GLOBAL_RELATIVE.contains(&kind) => 0.0,
            _ => return self.refuse_aloud(now, "Set-point refused: unknown frame", sink),
        };
        let degrees = |at: usize| f64::from(frame.int(at)) * 1e-7;
        let asked = |bit: u16| mask & bit == 0;
        let ned = [
            asked(IGNORE_X).then(|| global::north_of(params, degrees(4))),
            asked(IGNORE_X << 1).then(|| global::east_of(params, degrees(8))),
            asked(IGNORE_X << 2).then(|| datum - frame.float(12)),
        ];
        self.place(now, frame, (ned, mask), sink);
    }

    /// The rest of a position target, which both have at the same place.
    fn place(
        &mut self,
        now: Micros,
        frame: &Frame,
        (ned, mask): ([Option<f32>; 3], u16),
        sink: Sink,
    ) {
        let asked = |at: usize, bit: u16| (mask & bit == 0).then(|| frame.float(at));
        let yaw = asked(40, IGNORE_YAW);
        let axes = [asked(16, IGNORE_VX), asked(20, IGNORE_VX << 1), asked(24, IGNORE_VX << 2)];
        let says_nothing = ned.iter().chain(&axes).all(Option::is_none) && yaw.is_none();
        let is_finite = ned.iter().chain(&axes).flatten().chain(&yaw).all(|v| v.is_finite());
        if says_nothing || !is_finite {
            return self.refuse_aloud(now, "Set-point refused: not a number", sink);
        }
        let has_velocity = axes.iter().any(Option::is_some);
        let velocity = has_velocity.then(|| axes.map(Option::unwrap_or_default));
        self.queue(frame, Action::Setpoint(Setpoint::Place { ned, velocity, yaw }));
    }

    fn attitude_target(&mut self, now: Micros, frame: &Frame, sink: Sink) {
        let mask = frame.byte(38);
        let thrust = frame.float(32);
        let quaternion = [frame.float(4), frame.float(8), frame.float(12), frame.float(16)];
        let rate = [frame.float(20), frame.float(24), frame.float(28)];
        let is_finite = |values: &[f32]| values.iter().all(|x| x.is_finite());
        if mask & IGNORE_THRUST != 0 || !thrust.is_finite() {
            return self.refuse_aloud(now, "Set-point refused: no thrust", sink);
        }
        let setpoint = if mask & IGNORE_ATTITUDE == 0 && is_finite(&quaternion) {
            Setpoint::Attitude { quaternion, thrust }
        } else if mask & IGNORE_RATES == 0 && is_finite(&rate) {
            Setpoint::Rates { rate, thrust }
        } else {
            return self.refuse_aloud(now, "Set-point refused: neither attitude nor rates", sink);
        };
        self.queue(frame, Action::Setpoint(setpoint));
    }

    /// A stream is wrong many times a second, and told once.
    pub(super) fn refuse_aloud(&mut self, now: Micros, text: &'static str, sink: Sink) {
        self.refuse();
        if self.told_at.is_none_or(|at| now.since(at) > TOLD_AGAIN_US) {
            self.told_at = Some(now);
            self.say(Severity::Warning, text, sink);
        }
    }
}

/// Target system and component, for the messages that have them, by position.
pub(super) fn target(frame: &Frame) -> Option<(u8, u8)> {
    let at = match frame.id {
        mav::COMMAND_LONG_DATA::ID | mav::COMMAND_INT_DATA::ID => 30,
        mav::PARAM_REQUEST_LIST_DATA::ID
        | mav::MISSION_REQUEST_LIST_DATA::ID
        | mav::MISSION_CLEAR_ALL_DATA::ID
        | mav::PARAM_EXT_REQUEST_LIST_DATA::ID
        | mav::LOG_ERASE_DATA::ID
        | mav::LOG_REQUEST_END_DATA::ID
        | mav::PARAM_EXT_SET_DATA::ID => 0,
        mav::PARAM_REQUEST_READ_DATA::ID
        | mav::PARAM_EXT_REQUEST_READ_DATA::ID
        | mav::MISSION_COUNT_DATA::ID
        | mav::MISSION_REQUEST_DATA::ID
        | mav::MISSION_REQUEST_INT_DATA::ID
        | mav::MISSION_SET_CURRENT_DATA::ID => 2,
        mav::PARAM_SET_DATA::ID
        | mav::MISSION_REQUEST_PARTIAL_LIST_DATA::ID
        | mav::MISSION_WRITE_PARTIAL_LIST_DATA::ID
        | mav::REQUEST_EVENT_DATA::ID
        | mav::LOG_REQUEST_LIST_DATA::ID => 4,
        mav::SETUP_SIGNING_DATA::ID => 8,
        mav::LOG_REQUEST_DATA_DATA::ID => 10,
        mav::MISSION_ITEM_DATA::ID | mav::MISSION_ITEM_INT_DATA::ID => 32,
        mav::SET_POSITION_TARGET_LOCAL_NED_DATA::ID
        | mav::SET_POSITION_TARGET_GLOBAL_INT_DATA::ID => 50,
        mav::SET_ATTITUDE_TARGET_DATA::ID => 36,
        mav::RC_CHANNELS_OVERRIDE_DATA::ID => 16,
        mav::FILE_TRANSFER_PROTOCOL_DATA::ID => 1,
        mav::SET_MODE_DATA::ID => return Some((frame.byte(4), 0)),
        mav::MANUAL_CONTROL_DATA::ID => return Some((frame.byte(10), 0)),
        mav::SET_GPS_GLOBAL_ORIGIN_DATA::ID => return Some((frame.byte(12), 0)),
        mav::SET_HOME_POSITION_DATA::ID => return Some((frame.byte(52), 0)),
        _ => return None,
    };
    Some((frame.byte(at), frame.byte(at + 1)))
}
