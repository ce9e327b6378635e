//! What somebody outside asks of the vehicle, and what it answers.

use super::Setpoint;
use crate::supervisor::Mode;

/// Who asked: the answer finds its way back by it, and in flight it says whether they may.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Ticket {
    /// MAVLink command number; 0 where no acknowledgement is wanted.
    pub command: u16,
    /// System that asked; 0 for the vehicle's own machinery.
    pub system: u8,
    /// Its component.
    pub component: u8,
    /// Connection that it came by, as the host counts them.
    pub link: u8,
}

/// One request.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Request {
    /// For the answer.
    pub ticket: Ticket,
    /// What to do.
    pub action: Action,
}

/// Things that may be asked. Angles rad, lengths m; the values may be anything, the vehicle checks.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Action {
    /// Start the motors. `force` skips the checks, except those without which no flight is possible.
    Arm {
        /// Skip the checks that may be skipped.
        force: bool,
    },
    /// Stop the motors. In the air only with `force`.
    Disarm {
        /// Also in the air.
        force: bool,
    },
    /// Stop the motors wherever the vehicle is, and tell that it was meant.
    Terminate,
    /// Turn one motor, disarmed and without propellers.
    TestMotor {
        /// From 0.
        rotor: usize,
        /// 0 to 1; 0 stops the test.
        throttle: f32,
        /// s.
        seconds: f32,
    },
    /// Start the firmware anew, disarmed; the host does it when this is accepted.
    Reboot,
    /// Take the command, or give it back: in flight one ground station has it.
    Command {
        /// Else give it back.
        take: bool,
    },
    /// Change the flight mode.
    SetMode(Mode),
    /// Take off to this altitude over the anchor, or to the parameter's.
    Takeoff {
        /// m over the anchor.
        altitude: Option<f32>,
    },
    /// Move to a place in world axes (north, east, down from the anchor); `None` keeps a coordinate.
    MoveTo {
        /// m.
        ned: [Option<f32>; 3],
        /// Heading, rad from North.
        yaw: Option<f32>,
    },
    /// One set-point of a stream. Offboard follows it; other modes leave it be.
    Setpoint(Setpoint),
    /// Move in tether coordinates; `None` keeps a coordinate.
    MoveTether {
        /// Above the horizontal.
        elevation: Option<f32>,
        /// From North.
        azimuth: Option<f32>,
        /// From the anchor.
        length: Option<f32>,
        /// N.
        tension: Option<f32>,
    },
    /// A smooth step in a taut-link mode: start and end of each output, `None` for where the reference
    /// is or stays; its duration, s, or a suitable one.
    MoveTaut {
        /// Above the horizontal, rad.
        elevation: [Option<f32>; 2],
        /// Link force, N, positive in tension (Taut Force).
        force: [Option<f32>; 2],
        /// Pitch, rad, positive leaning away from the anchor (Taut Attitude).
        pitch: [Option<f32>; 2],
        /// s.
        duration: Option<f32>,
    },
    /// Stop where the vehicle is.
    Pause,
    /// Store a parameter. The link has checked the value.
    SetParam {
        /// Position in `param::META`.
        index: usize,
        /// New value.
        value: f32,
    },
    /// All parameters back to their defaults.
    ResetParams,
    /// Take level and gyro bias again (at rest, disarmed).
    Level,
    /// The nose points there: whatever was believed turns about the anchor.
    Face {
        /// From North, rad.
        heading: f32,
    },
}

/// How a request ended; MAVLink's results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Done or under way.
    Accepted,
    /// Not now; an event says why.
    Rejected,
    /// Never with these values; an event says why.
    Denied,
}

/// Answer to a [`Request`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reply {
    /// The request's ticket.
    pub ticket: Ticket,
    /// How it ended.
    pub outcome: Outcome,
    /// A stored parameter that changed, for the echo.
    pub parameter: Option<usize>,
}

impl Reply {
    /// Tells of a parameter that nobody asked to change.
    #[must_use]
    pub fn echo(parameter: usize) -> Self {
        Self { ticket: Ticket::default(), outcome: Outcome::Accepted, parameter: Some(parameter) }
    }
}

/// Throttle stick below which it counts as closed.
pub const CLOSED_THROTTLE: f32 = 0.05;

/// Joystick, each axis -1..1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sticks {
    /// Right positive.
    pub roll: f32,
    /// Forward (nose down) positive.
    pub pitch: f32,
    /// Clockwise positive.
    pub yaw: f32,
    /// 0 (bottom) to 1 (top).
    pub throttle: f32,
}
