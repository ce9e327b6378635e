//! Whoever sits at a page, as a ground station of its own.

use crate::flight::MavlinkSender;
use mavlink::MessageData;
use mavlink::dialects::common::{COMMAND_ACK_DATA, MANUAL_CONTROL_DATA, MavCmd};
use tautline_firmware::mavlink::Parser;
use tautline_firmware::supervisor::Mode;

/// MAVLink system of the first page; further ones count on.
const FIRST_SYSTEM: u8 = 240;
const COMPONENT: u8 = 190;

/// One page's sender.
#[derive(Clone, Copy, Debug)]
pub struct Pilot {
    sender: MavlinkSender,
    system: u8,
    target: u8,
}

impl Pilot {
    /// The page in a `seat`, from 0, of the vehicle `target`.
    #[must_use]
    pub fn new(seat: u8, target: u8) -> Self {
        let system = FIRST_SYSTEM.saturating_add(seat);
        Self { sender: MavlinkSender::new(u32::from(system), COMPONENT), system, target }
    }

    /// Its MAVLink system.
    #[must_use]
    pub fn system(&self) -> u8 {
        self.system
    }

    /// It is there.
    pub fn heartbeat(&mut self) -> Vec<u8> {
        self.sender.ground_heartbeat()
    }

    /// Asks the vehicle.
    pub fn command(&mut self, command: MavCmd, parameters: [f32; 7]) -> Vec<u8> {
        self.sender.command(self.target, command, parameters)
    }

    /// Asks for a mode.
    pub fn mode(&mut self, mode: Mode) -> Vec<u8> {
        self.sender.set_mode(self.target, mode)
    }

    /// Pitch, roll, throttle and yaw; what is not finite rests.
    pub fn sticks(&mut self, sticks: [f32; 4]) -> Vec<u8> {
        // A cast takes what is not a number to zero.
        let [x, y, z, r] = sticks.map(|x| (x.clamp(-1.0, 1.0) * 1e3) as i16);
        let message =
            MANUAL_CONTROL_DATA { x, y, z: z.max(0), r, target: self.target, ..Default::default() };
        self.sender.frame(&message)
    }
}

/// What a frame of the vehicle's answers to a command that it does not do, in one line.
pub fn answers(parser: &mut Parser, frame: &[u8], mut say: impl FnMut(String)) {
    parser.push(frame, |frame| {
        if frame.id != COMMAND_ACK_DATA::ID {
            return;
        }
        let (command, result) = (frame.word(0), frame.byte(2));
        // `MAV_RESULT`; what is accepted or under way shows in the flight.
        let why = match result {
            0 | 5 => return,
            1 => "not now",
            2 => "denied",
            3 => "not supported",
            _ => "failed",
        };
        say(format!("{}: {why}", name(command)));
    });
}

fn name(command: u16) -> &'static str {
    match command {
        22 => "Take-off",
        176 => "Mode",
        185 => "Motors off",
        400 => "Arming",
        31_010 => "Move",
        _ => "Command",
    }
}
