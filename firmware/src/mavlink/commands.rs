//! Commands: each one is acknowledged, unknown ones as unsupported.
//!
//! COMMAND_LONG and COMMAND_INT are read by position, not through the crate's enum of commands: that
//! one refuses a number it does not know, and then nobody would answer.

// MAVLink deprecates messages that today's clients still ask for.
#![allow(deprecated)]

use super::frame::Frame;
use super::{Session, Sink, global};
use crate::param::Params;
use crate::signal::{Action, Request, Ticket};
use crate::supervisor::Mode;
use mavlink::MessageData;
use mavlink::dialects::common as mav;

pub const ACCEPTED: u8 = 0;
pub const TEMPORARILY_REJECTED: u8 = 1;
pub const DENIED: u8 = 2;
const UNSUPPORTED: u8 = 3;

/// `p2` of a forced arming or disarming.
const FORCE: f32 = 21196.0;
/// `p1` of a reset to defaults in PREFLIGHT_STORAGE.
const STORAGE_RESET: f32 = 2.0;

/// Both forms in one.
struct Command {
    ticket: Ticket,
    /// Parameters 1 to 4 and 7.
    p: [f32; 4],
    altitude: f32,
    /// Degrees, as COMMAND_LONG's 5 and 6 and COMMAND_INT's x and y say.
    latitude: Option<f64>,
    longitude: Option<f64>,
    /// The altitude counts from the anchor, not from sea level.
    is_relative: bool,
}

/// What a command asks for.
enum Meaning {
    Do(Action),
    /// Send one message now.
    Message {
        id: u32,
        argument: u16,
    },
    Interval {
        id: u32,
        interval_us: f32,
    },
    Result(u8),
}

impl Command {
    fn from_long(frame: &Frame) -> Self {
        let degrees = |at| Some(f64::from(frame.float(at))).filter(|d| d.is_finite());
        Self::read(frame, degrees, false)
    }

    fn from_int(frame: &Frame) -> Self {
        let degrees =
            |at| Some(frame.int(at)).filter(|&d| d != i32::MAX).map(|d| f64::from(d) * 1e-7);
        // MAV_FRAME_GLOBAL_RELATIVE_ALT and ..._INT.
        Self::read(frame, degrees, matches!(frame.byte(32), 3 | 6))
    }

    /// Both messages have the same layout but for the type of parameters 5 and 6.
    fn read(frame: &Frame, degrees: impl Fn(usize) -> Option<f64>, is_relative: bool) -> Self {
        Self {
            ticket: Ticket {
                command: frame.word(28),
                system: frame.system,
                component: frame.component,
            },
            p: [frame.float(0), frame.float(4), frame.float(8), frame.float(12)],
            altitude: frame.float(24),
            latitude: degrees(16),
            longitude: degrees(20),
            is_relative,
        }
    }

    /// Height over the anchor. PX4's commands count from sea level, ArduPilot's and most scripts from
    /// home: a value that only makes sense over the anchor is taken so.
    fn height(&self, params: &Params) -> Option<f32> {
        if !self.altitude.is_finite() {
            return None;
        }
        let above_anchor = self.altitude - params.home_altitude;
        let reach = params.length_max;
        let is_amsl = !self.is_relative && above_anchor > -1.0 && above_anchor <= reach;
        Some(if is_amsl { above_anchor } else { self.altitude })
    }

    fn meaning(&self, params: &Params) -> Meaning {
        let [p1, p2, p3, p4] = self.p;
        let given = |x: f32| Some(x).filter(|x| x.is_finite());
        let truth = |x: f32| x.is_finite().then_some(x > 0.5);
        match self.ticket.command {
            // COMPONENT_ARM_DISARM
            400 => match truth(p1) {
                Some(true) => Meaning::Do(Action::Arm { force: p2 == FORCE }),
                Some(false) => Meaning::Do(Action::Disarm { force: p2 == FORCE }),
                None => Meaning::Result(DENIED),
            },
            // NAV_TAKEOFF
            22 => Meaning::Do(Action::Takeoff { altitude: self.height(params) }),
            // NAV_RETURN_TO_LAUNCH, NAV_LAND
            20 | 21 => Meaning::Do(Action::SetMode(Mode::Land)),
            // DO_SET_MODE: PX4's main and sub mode, or the whole custom mode in p2.
            176 => {
                let whole = p2 as u32;
                let custom = if p2 > 255.0 { whole } else { (whole << 16) | ((p3 as u32) << 24) };
                mode_request(custom)
            }
            // DO_REPOSITION
            192 => self.reposition(params),
            // Ours, MAV_CMD_USER_1: elevation, azimuth (degrees), length (m), tension (N); NaN keeps.
            31010 => Meaning::Do(Action::MoveTether {
                elevation: given(p1).map(f32::to_radians),
                azimuth: given(p2).map(f32::to_radians),
                length: given(p3),
                tension: given(p4),
            }),
            // Ours, MAV_CMD_USER_2 and _3: a smooth step on a taut link. Elevation from and to (degrees),
            // then link force (N), or pitch (degrees), from and to; 7 is the duration (s). NaN keeps.
            31011 | 31012 => {
                let (elevation, second) = ([given(p1), given(p2)], [given(p3), given(p4)]);
                let radians = |pair: [Option<f32>; 2]| pair.map(|x| x.map(f32::to_radians));
                let is_force = self.ticket.command == 31011;
                Meaning::Do(Action::MoveTaut {
                    elevation: radians(elevation),
                    force: if is_force { second } else { [None; 2] },
                    pitch: if is_force { [None; 2] } else { radians(second) },
                    duration: given(self.altitude),
                })
            }
            // PREFLIGHT_CALIBRATION: gyro or level
            241 => Meaning::Do(Action::Level),
            // FIXED_MAG_CAL_YAW: where the nose points, degrees
            42006 if p1.abs() <= 360.0 => {
                let heading = crate::math::wrap_pi(p1.to_radians());
                Meaning::Do(Action::Face { heading })
            }
            42006 => Meaning::Result(DENIED),
            // PREFLIGHT_STORAGE
            245 if p1 == STORAGE_RESET => Meaning::Do(Action::ResetParams),
            // RUN_PREARM_CHECKS: SYS_STATUS carries the result.
            401 => Meaning::Message { id: mav::SYS_STATUS_DATA::ID, argument: 0 },
            // GET_HOME_POSITION
            410 => Meaning::Message { id: mav::HOME_POSITION_DATA::ID, argument: 0 },
            // GET_MESSAGE_INTERVAL
            510 => Meaning::Message { id: mav::MESSAGE_INTERVAL_DATA::ID, argument: p1 as u16 },
            // SET_MESSAGE_INTERVAL
            511 => Meaning::Interval { id: p1 as u32, interval_us: p2 },
            // REQUEST_MESSAGE
            512 => Meaning::Message { id: p1 as u32, argument: p2 as u16 },
            // REQUEST_PROTOCOL_VERSION, REQUEST_AUTOPILOT_CAPABILITIES
            519 => Meaning::Message { id: mav::PROTOCOL_VERSION_DATA::ID, argument: 0 },
            520 => Meaning::Message { id: mav::AUTOPILOT_VERSION_DATA::ID, argument: 0 },
            _ => Meaning::Result(UNSUPPORTED),
        }
    }

    fn reposition(&self, params: &Params) -> Meaning {
        let [_, _, _, yaw] = self.p;
        let ned = [
            self.latitude.map(|lat| global::north_of(params, lat)),
            self.longitude.map(|lon| global::east_of(params, lon)),
            self.height(params).map(|height| -height),
        ];
        let yaw = Some(yaw).filter(|yaw| yaw.is_finite());
        if ned.iter().all(Option::is_none) && yaw.is_none() {
            return Meaning::Do(Action::Pause);
        }
        Meaning::Do(Action::MoveTo { ned, yaw })
    }
}

fn mode_request(custom_mode: u32) -> Meaning {
    match Mode::from_custom_mode(custom_mode) {
        Some(mode) => Meaning::Do(Action::SetMode(mode)),
        None => Meaning::Result(DENIED),
    }
}

impl Session {
    pub(super) fn command_long(&mut self, frame: &Frame, params: &Params, sink: Sink) {
        self.command(&Command::from_long(frame), params, sink);
    }

    pub(super) fn command_int(&mut self, frame: &Frame, params: &Params, sink: Sink) {
        self.command(&Command::from_int(frame), params, sink);
    }

    /// The old SET_MODE message; it has no acknowledgement of its own.
    pub(super) fn set_mode(&mut self, custom_mode: u32) {
        match mode_request(custom_mode) {
            Meaning::Do(action) => self.queue(Request { ticket: Ticket::default(), action }),
            _ => self.refuse(),
        }
    }

    fn command(&mut self, command: &Command, params: &Params, sink: Sink) {
        let result =
            match command.meaning(params) {
                Meaning::Do(action) => {
                    // The vehicle's answer becomes the acknowledgement.
                    if self.requests.is_full() {
                        TEMPORARILY_REJECTED
                    } else {
                        return self.queue(Request { ticket: command.ticket, action });
                    }
                }
                Meaning::Message { id, argument } => {
                    if super::telemetry::is_known(id) && self.once.push_back((id, argument)).is_ok()
                    {
                        ACCEPTED
                    } else {
                        UNSUPPORTED
                    }
                }
                Meaning::Interval { id, interval_us } => {
                    if self.streams.set_interval(id, interval_us) { ACCEPTED } else { DENIED }
                }
                Meaning::Result(result) => result,
            };
        self.acknowledge(&command.ticket, result, sink);
    }

    pub(super) fn acknowledge(&mut self, ticket: &Ticket, result: u8, sink: Sink) {
        let [low, high] = ticket.command.to_le_bytes();
        let payload = [low, high, result, 0, 0, 0, 0, 0, ticket.system, ticket.component];
        self.send_raw(mav::COMMAND_ACK_DATA::ID, mav::COMMAND_ACK_DATA::EXTRA_CRC, &payload, sink);
    }
}
