//! Services that clients ask for and that are not here: each is told so at once, for silence costs them seconds.
//!
//! A host that has files, logs and a shell answers for those itself.

// MAVLink deprecates messages that today's clients still ask for.
#![allow(deprecated)]

use super::frame::Frame;
use super::{Session, Sink, Wanted};
use crate::signal::Severity;
use mavlink::MessageData;
use mavlink::dialects::common as mav;

/// `MAV_MISSION_RESULT`.
const MISSION_ACCEPTED: u8 = 0;
const MISSION_UNSUPPORTED: u8 = 3;
const MISSION_INVALID_SEQUENCE: u8 = 13;
/// `PARAM_ACK_FAILED`, and a kind of extended parameter for want of a better.
const PARAM_FAILED: u8 = 2;
const PARAM_KIND: u8 = 9;
/// FTP: reply codes and the error that ends a client's wait at once.
const FTP_ACK: u8 = 128;
const FTP_NAK: u8 = 129;
const FTP_FILE_NOT_FOUND: u8 = 10;
/// `SERIAL_CONTROL_FLAG_REPLY`, and its payload up to the data.
const SERIAL_REPLY: u8 = 1;
const SERIAL_HEAD: usize = 9;

impl Session {
    pub(super) fn serve(&mut self, frame: &Frame, sink: Sink) {
        let [system, component] = [frame.system, frame.component];
        match frame.id {
            // A mission has no items, of whatever type it is.
            mav::MISSION_REQUEST_LIST_DATA::ID => {
                let empty = [0, 0, system, component, frame.byte(2)];
                self.raw::<mav::MISSION_COUNT_DATA>(&empty, sink);
            }
            mav::MISSION_COUNT_DATA::ID if frame.word(0) == 0 => {
                self.mission(frame, MISSION_ACCEPTED, frame.byte(4), sink);
            }
            mav::MISSION_COUNT_DATA::ID => {
                self.mission(frame, MISSION_UNSUPPORTED, frame.byte(4), sink);
            }
            mav::MISSION_CLEAR_ALL_DATA::ID => {
                self.mission(frame, MISSION_ACCEPTED, frame.byte(2), sink);
            }
            mav::MISSION_REQUEST_DATA::ID | mav::MISSION_REQUEST_INT_DATA::ID => {
                self.mission(frame, MISSION_INVALID_SEQUENCE, frame.byte(4), sink);
            }
            mav::MISSION_SET_CURRENT_DATA::ID => {
                self.mission(frame, MISSION_INVALID_SEQUENCE, 0, sink);
            }
            mav::MISSION_ITEM_DATA::ID | mav::MISSION_ITEM_INT_DATA::ID => {
                self.mission(frame, MISSION_UNSUPPORTED, frame.byte(37), sink);
            }
            mav::MISSION_REQUEST_PARTIAL_LIST_DATA::ID
            | mav::MISSION_WRITE_PARTIAL_LIST_DATA::ID => {
                self.mission(frame, MISSION_UNSUPPORTED, frame.byte(6), sink);
            }
            // Value of 128 bytes, name, type; none of none.
            mav::PARAM_EXT_REQUEST_LIST_DATA::ID | mav::PARAM_EXT_REQUEST_READ_DATA::ID => {
                let mut none = [0_u8; 149];
                let [.., kind] = &mut none;
                *kind = PARAM_KIND;
                self.raw::<mav::PARAM_EXT_VALUE_DATA>(&none, sink);
            }
            mav::PARAM_EXT_SET_DATA::ID => {
                let mut ack = [0_u8; 146];
                let name = (2..18).map(|at| frame.byte(at));
                for (slot, byte) in ack.iter_mut().zip(name) {
                    *slot = byte;
                }
                let [.., kind, result] = &mut ack;
                (*kind, *result) = (PARAM_KIND, PARAM_FAILED);
                self.raw::<mav::PARAM_EXT_ACK_DATA>(&ack, sink);
            }
            mav::REQUEST_EVENT_DATA::ID => {
                // No sequence, of an unavailable event.
                let none = [0, 0, 0, 0, system, component, 0];
                self.raw::<mav::RESPONSE_EVENT_ERROR_DATA>(&none, sink);
            }
            mav::SET_HOME_POSITION_DATA::ID | mav::SET_GPS_GLOBAL_ORIGIN_DATA::ID => {
                let anchor = mav::GPS_GLOBAL_ORIGIN_DATA::ID;
                let _ = self.once.push_back(Wanted { id: anchor, argument: 0, ticket: None });
                self.say(Severity::Warning, "Home is the anchor: set HOME_LAT, _LON, _ALT", sink);
            }
            mav::PLAY_TUNE_DATA::ID | mav::PLAY_TUNE_V2_DATA::ID => {
                self.say(Severity::Warning, "Refused: nothing here plays a tune", sink);
            }
            mav::PARAM_MAP_RC_DATA::ID => {
                self.say(Severity::Warning, "Refused: no parameter follows a stick", sink);
            }
            mav::CHANGE_OPERATOR_CONTROL_DATA::ID => {
                // Asked by a pass key: there is none. REQUEST_OPERATOR_CONTROL does it.
                const UNSUPPORTED: u8 = 2;
                let refusal = [system, frame.byte(1), UNSUPPORTED];
                self.raw::<mav::CHANGE_OPERATOR_CONTROL_ACK_DATA>(&refusal, sink);
            }
            _ if self.is_served => self.ignore(),
            mav::FILE_TRANSFER_PROTOCOL_DATA::ID => self.file_transfer(frame, sink),
            mav::LOG_REQUEST_LIST_DATA::ID => {
                // Neither time nor size, of no log of none.
                self.raw::<mav::LOG_ENTRY_DATA>(&[0; 14], sink);
            }
            mav::LOG_REQUEST_DATA_DATA::ID => {
                // The offset that was asked for, its log, and no bytes.
                let mut nothing = [0_u8; 97];
                let head = (0..4).chain(8..10).map(|at| frame.byte(at));
                for (slot, byte) in nothing.iter_mut().zip(head) {
                    *slot = byte;
                }
                self.raw::<mav::LOG_DATA_DATA>(&nothing, sink);
            }
            mav::SERIAL_CONTROL_DATA::ID => self.shell(frame, sink),
            _ => self.ignore(),
        }
    }

    fn raw<D: MessageData>(&mut self, payload: &[u8], sink: Sink) {
        self.send_raw(D::ID, D::EXTRA_CRC, payload, sink);
    }

    fn mission(&mut self, frame: &Frame, result: u8, kind: u8, sink: Sink) {
        self.raw::<mav::MISSION_ACK_DATA>(&[frame.system, frame.component, result, kind], sink);
    }

    /// Terminating or resetting sessions always works: there are none.
    fn file_transfer(&mut self, frame: &Frame, sink: Sink) {
        const HEAD: usize = 3;
        let [low, high] = frame.word(HEAD).wrapping_add(1).to_le_bytes();
        let opcode = frame.byte(HEAD + 3);
        let is_end = matches!(opcode, 1 | 2);
        let code = if is_end { FTP_ACK } else { FTP_NAK };
        let mut payload = [0_u8; 254];
        let to = [0, frame.system, frame.component];
        let head = [low, high, frame.byte(HEAD + 2), code, u8::from(!is_end), opcode];
        let error = if is_end { 0 } else { FTP_FILE_NOT_FOUND };
        let bytes = to.into_iter().chain(head).chain([0; 6]).chain([error]);
        for (slot, byte) in payload.iter_mut().zip(bytes) {
            *slot = byte;
        }
        self.raw::<mav::FILE_TRANSFER_PROTOCOL_DATA>(&payload, sink);
    }

    fn shell(&mut self, frame: &Frame, sink: Sink) {
        const NONE: &[u8] = b"no shell on this board\n";
        let mut payload = [0_u8; SERIAL_HEAD + 70];
        let head = [0, 0, 0, 0, 0, 0, frame.byte(6), SERIAL_REPLY, NONE.len() as u8];
        for (slot, byte) in payload.iter_mut().zip(head.iter().chain(NONE)) {
            *slot = *byte;
        }
        self.raw::<mav::SERIAL_CONTROL_DATA>(&payload, sink);
    }
}
