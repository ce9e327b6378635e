//! What a command asks for.

// MAVLink deprecates messages that today's clients still ask for.
#![allow(deprecated)]

use super::Answer;
use super::place::Datum;
use crate::mavlink::frame::Frame;
use crate::param::Params;
use crate::signal::{Action, Ticket};
use crate::supervisor::Mode;
use mavlink::MessageData;
use mavlink::dialects::common as mav;

/// `p2` of a forced arming or disarming.
const FORCE: f32 = 21196.0;
/// `p1` of PREFLIGHT_STORAGE.
const STORAGE_SAVE: f32 = 1.0;
const STORAGE_RESET: f32 = 2.0;
/// `p1` of PREFLIGHT_REBOOT_SHUTDOWN.
const RESTART: f32 = 1.0;
/// PREFLIGHT_REBOOT_SHUTDOWN.
pub(in crate::mavlink) const REBOOT: u16 = 246;
/// Of a simulator.
pub(super) const INJECT_FAILURE: u16 = 420;
/// PREFLIGHT_CALIBRATION.
pub(super) const CALIBRATE: u16 = 241;
/// `MAV_MODE_FLAG_CUSTOM_MODE_ENABLED`, in p1 of DO_SET_MODE.
const CUSTOM: u16 = 1;
/// Bits of a MAVLink base mode.
const BASE_MODE_MAX: f32 = 255.0;
/// `ACTUATOR_OUTPUT_FUNCTION_MOTOR1`.
const FIRST_MOTOR: f32 = 101.0;
/// DO_MOTOR_TEST: its throttle is in percent, one motor at a time, in the board's order.
const PERCENT: f32 = 0.0;

/// Both forms in one.
pub(super) struct Command {
    pub ticket: Ticket,
    /// Parameters 1 to 4.
    pub p: [f32; 4],
    /// Parameter 7.
    pub altitude: f32,
    /// Degrees, as COMMAND_LONG's 5 and 6 and COMMAND_INT's x and y say; NaN where none is given.
    pub latitude: f64,
    pub longitude: f64,
    pub datum: Datum,
}

/// What is to be done about it.
pub(super) enum Meaning {
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
    CancelCalibration,
    /// Nothing but this answer, and a text unless it is empty.
    Nothing(Answer, &'static str),
}

impl Meaning {
    pub fn denied(text: &'static str) -> Self {
        Self::Nothing(Answer::Denied, text)
    }

    const UNSUPPORTED: Self = Self::Nothing(Answer::Unsupported, "");
}

/// A whole number from 0 to `most`.
fn whole(x: f32, most: f32) -> Option<f32> {
    ((0.0..=most).contains(&x) && libm::truncf(x).total_cmp(&x).is_eq()).then_some(x)
}

/// 0 or 1, and nothing between.
fn switch(x: f32) -> Option<bool> {
    whole(x, 1.0).map(|x| x > 0.5)
}

impl Command {
    pub fn from_long(frame: &Frame) -> Self {
        let degrees = |at| f64::from(frame.float(at));
        Self::read(frame, degrees, Datum::Untold)
    }

    pub fn from_int(frame: &Frame) -> Self {
        let degrees = |at| match frame.int(at) {
            i32::MAX => f64::NAN,
            scaled => f64::from(scaled) * 1e-7,
        };
        Self::read(frame, degrees, Datum::of_frame(frame.byte(32)))
    }

    /// Both messages have the same layout but for the type of parameters 5 and 6.
    fn read(frame: &Frame, degrees: impl Fn(usize) -> f64, datum: Datum) -> Self {
        Self {
            ticket: frame.ticket(frame.word(28)),
            p: [frame.float(0), frame.float(4), frame.float(8), frame.float(12)],
            altitude: frame.float(24),
            latitude: degrees(16),
            longitude: degrees(20),
            datum,
        }
    }

    pub fn meaning(&self, params: &Params) -> Meaning {
        let [p1, p2, p3, p4] = self.p;
        let given = |x: f32| Some(x).filter(|x| x.is_finite());
        match self.ticket.command {
            // COMPONENT_ARM_DISARM
            400 => match switch(p1) {
                Some(true) => Meaning::Do(Action::Arm { force: p2 == FORCE }),
                Some(false) => Meaning::Do(Action::Disarm { force: p2 == FORCE }),
                None => Meaning::denied("Arming refused: parameter 1 is 0 or 1"),
            },
            // NAV_TAKEOFF
            22 => self.take_off(params),
            // NAV_RETURN_TO_LAUNCH
            20 => Meaning::Do(Action::SetMode(Mode::Return)),
            // NAV_LAND
            21 if self.lands_here(params) => Meaning::Do(Action::SetMode(Mode::Land)),
            21 => Meaning::denied("Landing refused: it lands where it stood"),
            // DO_SET_MODE
            176 => self.set_mode(),
            // DO_SET_STANDARD_MODE
            262 => match whole(p1, BASE_MODE_MAX).and_then(|p1| Mode::from_standard(p1 as u8)) {
                Some(mode) => Meaning::Do(Action::SetMode(mode)),
                None => Meaning::denied("Mode refused: unknown"),
            },
            // DO_FLIGHTTERMINATION
            185 => match switch(p1) {
                Some(true) => Meaning::Do(Action::Terminate),
                _ => Meaning::denied("Termination refused: parameter 1 is 1"),
            },
            // DO_REPOSITION
            192 => self.reposition(params),
            // DO_MOTOR_TEST, and ACTUATOR_TEST as set-up pages send it
            209 if p2 == PERCENT => self.motor_test(p1 - 1.0, p3 * 0.01, p4),
            310 => {
                let rotor = self.latitude as f32 - FIRST_MOTOR;
                // No value stops it.
                self.motor_test(rotor, if p1.is_nan() { 0.0 } else { p1 }, p2)
            }
            // REQUEST_OPERATOR_CONTROL
            32100 => match switch(p1) {
                Some(take) => Meaning::Do(Action::Command { take }),
                None => Meaning::denied("Command refused: parameter 1 is 0 or 1"),
            },
            // Ours, MAV_CMD_USER_1: elevation, azimuth (degrees), length (m), tension (N); NaN keeps.
            31010..=31012 if self.p.iter().any(|x| x.is_infinite()) => {
                Meaning::denied("Move refused: not a number")
            }
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
            CALIBRATE => self.calibrate(),
            // FIXED_MAG_CAL_YAW: where the nose points, degrees
            42006 if p1.abs() <= 360.0 => {
                let heading = crate::math::wrap_pi(p1.to_radians());
                Meaning::Do(Action::Face { heading })
            }
            42006 => Meaning::denied("Heading refused: beyond a turn"),
            // PREFLIGHT_STORAGE: whatever is set is kept at once.
            245 if p1 == STORAGE_SAVE => Meaning::Nothing(Answer::Accepted, ""),
            245 if p1 == STORAGE_RESET => Meaning::Do(Action::ResetParams),
            // PREFLIGHT_REBOOT_SHUTDOWN
            REBOOT if p1 == RESTART => Meaning::Do(Action::Reboot),
            // RUN_PREARM_CHECKS: SYS_STATUS carries the result.
            401 => Meaning::Message { id: mav::SYS_STATUS_DATA::ID, argument: 0 },
            // GET_HOME_POSITION
            410 => Meaning::Message { id: mav::HOME_POSITION_DATA::ID, argument: 0 },
            // GET_MESSAGE_INTERVAL, SET_MESSAGE_INTERVAL, REQUEST_MESSAGE
            510..=512 => self.about_message(),
            // REQUEST_PROTOCOL_VERSION, REQUEST_AUTOPILOT_CAPABILITIES
            519 => Meaning::Message { id: mav::PROTOCOL_VERSION_DATA::ID, argument: 0 },
            520 => Meaning::Message { id: mav::AUTOPILOT_VERSION_DATA::ID, argument: 0 },
            _ => Meaning::UNSUPPORTED,
        }
    }

    fn about_message(&self) -> Meaning {
        let [p1, p2, ..] = self.p;
        let Some(id) = whole(p1, 16_777_215.0).map(|id| id as u32) else {
            return Meaning::denied("Message refused: no such number");
        };
        match self.ticket.command {
            510 => Meaning::Message {
                id: mav::MESSAGE_INTERVAL_DATA::ID,
                argument: u16::try_from(id).unwrap_or(u16::MAX),
            },
            511 => Meaning::Interval { id, interval_us: p2 },
            // No argument is none.
            _ => Meaning::Message { id, argument: if p2.is_nan() { 0 } else { p2 as u16 } },
        }
    }

    /// PX4's main and sub mode, or the whole custom mode in p2.
    fn set_mode(&self) -> Meaning {
        let [base, main, sub, _] = self.p;
        let is_custom = whole(base, BASE_MODE_MAX).is_some_and(|base| base as u16 & CUSTOM != 0);
        let sub = if sub.is_nan() { 0.0 } else { sub };
        let number = match (whole(main, u32::MAX as f32), whole(sub, BASE_MODE_MAX)) {
            (Some(main), _) if main > BASE_MODE_MAX => Some(main as u32),
            (Some(main), Some(sub)) => Some(((main as u32) << 16) | ((sub as u32) << 24)),
            _ => None,
        };
        match number.filter(|_| is_custom).and_then(Mode::from_custom_mode) {
            Some(mode) => Meaning::Do(Action::SetMode(mode)),
            None => Meaning::denied("Mode refused: unknown"),
        }
    }

    fn motor_test(&self, rotor: f32, throttle: f32, seconds: f32) -> Meaning {
        match whole(rotor, BASE_MODE_MAX) {
            Some(rotor) => {
                Meaning::Do(Action::TestMotor { rotor: rotor as usize, throttle, seconds })
            }
            None => Meaning::denied("Motor test refused: no such motor"),
        }
    }

    /// One sensor at a time. Gyro (1) and level (5 = 2) can be taken; nothing at all cancels.
    fn calibrate(&self) -> Meaning {
        let [p1, p2, p3, p4] = self.p;
        let asked = [p1, p2, p3, p4, self.latitude as f32, self.longitude as f32, self.altitude];
        // NaN is nothing.
        match asked.map(|x| if x.is_nan() { 0.0 } else { x }) {
            [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0] => Meaning::CancelCalibration,
            [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0] | [0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0] => {
                Meaning::Do(Action::Level)
            }
            _ => Meaning::UNSUPPORTED,
        }
    }
}
