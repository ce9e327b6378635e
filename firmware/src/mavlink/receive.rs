//! What each incoming message means.

// MAVLink deprecates messages that today's clients still send and ask for.
#![allow(deprecated)]

use super::frame::Frame;
use super::params::name_bytes;
use super::{COMPONENT_AUTOPILOT, Session, Sink};
use crate::param::Params;
use crate::signal::{Action, Request, Sticks, Ticket};
use crate::time::{Micros, Sample};
use mavlink::dialects::common as mav;
use mavlink::{MavlinkVersion, MessageData};

const GCS: u8 = 6;
/// SET_POSITION_TARGET: bits of the type mask, and the only frame understood (LOCAL_NED).
const IGNORE_X: u16 = 1;
const IGNORE_VX: u16 = 1 << 3;
const IGNORE_YAW: u16 = 1 << 10;
const LOCAL_NED: u8 = 1;
/// FTP: reply codes and the error that ends a client's wait at once.
const FTP_ACK: u8 = 128;
const FTP_NAK: u8 = 129;
const FTP_FILE_NOT_FOUND: u8 = 10;

impl Session {
    pub(super) fn handle(&mut self, now: Micros, frame: &Frame, params: &Params, sink: Sink) {
        if frame.system == self.system && frame.component == COMPONENT_AUTOPILOT {
            return;
        }
        if let Some((system, component)) = target(frame) {
            let for_us = (system == 0 || system == self.system)
                && (component == 0 || component == COMPONENT_AUTOPILOT);
            if !for_us {
                self.counters.ignored = self.counters.ignored.wrapping_add(1);
                return;
            }
        }
        self.counters.received = self.counters.received.wrapping_add(1);
        match frame.id {
            mav::HEARTBEAT_DATA::ID => {
                if frame.byte(4) == GCS {
                    self.heartbeat_at = Some(now);
                }
            }
            mav::COMMAND_LONG_DATA::ID => self.command_long(frame, params, sink),
            mav::COMMAND_INT_DATA::ID => self.command_int(frame, params, sink),
            mav::SET_MODE_DATA::ID => self.set_mode(frame.int(0) as u32),
            mav::PARAM_REQUEST_LIST_DATA::ID => self.list_parameters(),
            mav::PARAM_REQUEST_READ_DATA::ID => {
                self.decode(frame, |session, m: &mav::PARAM_REQUEST_READ_DATA| {
                    session.read_parameter(m.param_index, name_bytes(&m.param_id));
                })
            }
            mav::PARAM_SET_DATA::ID => self.decode(frame, |session, m: &mav::PARAM_SET_DATA| {
                session.set_parameter(name_bytes(&m.param_id), m.param_value, m.param_type, params);
            }),
            mav::MISSION_REQUEST_LIST_DATA::ID => {
                let empty = mav::MISSION_COUNT_DATA {
                    count: 0,
                    target_system: frame.system,
                    target_component: frame.component,
                };
                self.send(&empty, sink);
            }
            mav::MISSION_COUNT_DATA::ID => {
                self.mission_ack(frame, mav::MavMissionResult::MAV_MISSION_UNSUPPORTED, sink);
            }
            mav::MISSION_CLEAR_ALL_DATA::ID => {
                self.mission_ack(frame, mav::MavMissionResult::MAV_MISSION_ACCEPTED, sink);
            }
            mav::MANUAL_CONTROL_DATA::ID => {
                self.decode(frame, |session, m: &mav::MANUAL_CONTROL_DATA| {
                    session.manual_control(now, m)
                });
            }
            mav::SET_POSITION_TARGET_LOCAL_NED_DATA::ID => self.position_target(frame),
            mav::ODOMETRY_DATA::ID => self.odometry(now, frame),
            mav::VISION_POSITION_ESTIMATE_DATA::ID => self.vision_position(now, frame),
            mav::ATT_POS_MOCAP_DATA::ID => self.pose(now, frame),
            mav::DEBUG_VECT_DATA::ID => self.named_vector(now, frame),
            mav::WINCH_STATUS_DATA::ID => self.winch_status(now, frame),
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
            mav::FILE_TRANSFER_PROTOCOL_DATA::ID => self.file_transfer(frame, sink),
            _ => self.counters.ignored = self.counters.ignored.wrapping_add(1),
        }
    }

    fn decode<D: MessageData>(&mut self, frame: &Frame, then: impl FnOnce(&mut Self, &D)) {
        match D::deser(MavlinkVersion::V2, frame.payload) {
            Ok(message) => then(self, &message),
            Err(_) => self.refuse(),
        }
    }

    fn mission_ack(&mut self, frame: &Frame, result: mav::MavMissionResult, sink: Sink) {
        let ack = mav::MISSION_ACK_DATA {
            target_system: frame.system,
            target_component: frame.component,
            mavtype: result,
        };
        self.send(&ack, sink);
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

    /// Read by position: the crate refuses a type mask with unknown bits, which clients do send.
    fn position_target(&mut self, frame: &Frame) {
        let mask = frame.word(48);
        let asked = |at: usize, bit: u16| (mask & bit == 0).then(|| frame.float(at));
        let ned = [asked(4, IGNORE_X), asked(8, IGNORE_X << 1), asked(12, IGNORE_X << 2)];
        let yaw = asked(40, IGNORE_YAW);
        let velocity = [asked(16, IGNORE_VX), asked(20, IGNORE_VX << 1), asked(24, IGNORE_VX << 2)];
        let moves = velocity.iter().flatten().any(|v| *v != 0.0);
        let says_nothing = ned.iter().chain(&velocity).all(Option::is_none) && yaw.is_none();
        let is_finite = ned.iter().chain(&velocity).flatten().chain(&yaw).all(|v| v.is_finite());
        if !is_finite || says_nothing || frame.byte(52) != LOCAL_NED {
            return self.refuse();
        }
        let velocity = velocity.map(Option::unwrap_or_default);
        let action =
            if moves { Action::Stream { ned, velocity, yaw } } else { Action::MoveTo { ned, yaw } };
        self.queue(Request { ticket: Ticket::default(), action });
    }

    /// There are no files, but silence costs clients seconds: say so at once.
    fn file_transfer(&mut self, frame: &Frame, sink: Sink) {
        const HEAD: usize = 3;
        let sequence = frame.word(HEAD).wrapping_add(1).to_le_bytes();
        let opcode = frame.byte(HEAD + 3);
        // Terminating or resetting sessions always works: there are none.
        let is_end = matches!(opcode, 1 | 2);
        let [low, high] = sequence;
        let mut payload = [0_u8; 251];
        let head = [
            low,
            high,
            frame.byte(HEAD + 2),
            if is_end { FTP_ACK } else { FTP_NAK },
            u8::from(!is_end),
            opcode,
            0,
            0,
            0,
            0,
            0,
            0,
            if is_end { 0 } else { FTP_FILE_NOT_FOUND },
        ];
        for (to, from) in payload.iter_mut().zip(head) {
            *to = from;
        }
        let reply = mav::FILE_TRANSFER_PROTOCOL_DATA {
            target_network: 0,
            target_system: frame.system,
            target_component: frame.component,
            payload,
        };
        self.send(&reply, sink);
    }
}

/// Target system and component, for the messages that have them, by position.
fn target(frame: &Frame) -> Option<(u8, u8)> {
    let at = match frame.id {
        mav::COMMAND_LONG_DATA::ID | mav::COMMAND_INT_DATA::ID => 30,
        mav::PARAM_REQUEST_LIST_DATA::ID
        | mav::MISSION_REQUEST_LIST_DATA::ID
        | mav::MISSION_CLEAR_ALL_DATA::ID => 0,
        mav::PARAM_REQUEST_READ_DATA::ID | mav::MISSION_COUNT_DATA::ID => 2,
        mav::PARAM_SET_DATA::ID => 4,
        mav::SET_POSITION_TARGET_LOCAL_NED_DATA::ID => 50,
        mav::FILE_TRANSFER_PROTOCOL_DATA::ID => 1,
        mav::SET_MODE_DATA::ID => return Some((frame.byte(4), 0)),
        mav::MANUAL_CONTROL_DATA::ID => return Some((frame.byte(10), 0)),
        _ => return None,
    };
    Some((frame.byte(at), frame.byte(at + 1)))
}
