//! How an emulated board asks its host: the buses, the clock and the console of an image whose back ends are a
//! stream of bytes. One [`Request`] in a frame of its own; where it says so, one [`Reply`] comes back.
//!
//! A frame is its length in two bytes, little-endian, and then the message as `postcard` writes it.

pub use crate::status::Status;

use serde::{Deserialize, Serialize};

/// Motor outputs of the emulated board.
pub const OUTPUTS: usize = 4;

/// Longest message.
pub const MAX_MESSAGE: usize = 600;

/// What the board wants.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Request<'a> {
    /// Inertial sensor: one chip select; as many bytes come back.
    Spi(&'a [u8]),
    /// Barometer: a write, then a read of so many bytes. [`Reply::Bytes`] or [`Reply::Failed`].
    I2c {
        /// Seven bits.
        address: u8,
        /// May be empty.
        write: &'a [u8],
        /// May be 0.
        read: u8,
    },
    /// Rangefinder: the bytes that have arrived. [`Reply::Bytes`].
    Range,
    /// Battery: [`Reply::Pins`].
    Pins,
    /// Let so much time pass, ns. No reply.
    Delay(u32),
    /// Parameter flash. [`Reply::Bytes`] or [`Reply::Failed`].
    FlashRead {
        /// Offset.
        at: u32,
        /// Bytes.
        length: u16,
    },
    /// [`Reply::Done`] or [`Reply::Failed`].
    FlashWrite {
        /// Offset.
        at: u32,
        /// What.
        bytes: &'a [u8],
    },
    /// [`Reply::Done`] or [`Reply::Failed`].
    FlashErase {
        /// First byte.
        from: u32,
        /// End.
        to: u32,
    },
    /// The four pulses as shares of the timer's period, of 65535. No reply.
    Motors([u16; OUTPUTS]),
    /// Bytes out of the console port. No reply.
    Console(&'a [u8]),
    /// Bytes for the log's file. No reply.
    Log(&'a [u8]),
    /// What the step said, for the pilot and the comparison. No reply.
    Status(Status),
    /// Everything for this millisecond is done: [`Reply::Tick`].
    Advance,
    /// Counted at the end, or when asked. No reply.
    Counts(Counts),
}

/// More instructions than a step should take.
pub const DEAR: u32 = 12_000;

/// What was counted since power-up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Counts {
    /// Calls of `Vehicle::step`.
    pub steps: u32,
    /// Instructions of all of them.
    pub instructions: u64,
    /// Instructions of the dearest.
    pub worst: u32,
    /// Which step that was.
    pub worst_step: u32,
    /// Steps of more than [`DEAR`] instructions.
    pub dear: u32,
    /// Outputs that found the queue to the communications task full.
    pub lost_outputs: u32,
    /// Deepest stack so far, bytes.
    pub stack: u32,
    /// Room for the stack, bytes.
    pub stack_room: u32,
}

/// A fault that the host makes the board suffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Injury {
    /// An access that the bus refuses.
    HardFault,
    /// A panic.
    Panic,
}

/// What the host says.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Reply<'a> {
    /// As asked.
    Bytes(&'a [u8]),
    /// Done.
    Done,
    /// The device does not answer.
    Failed,
    /// mV at the voltage and the current pin.
    Pins(u16, u16),
    /// A new millisecond.
    Tick {
        /// µs since power-up.
        now_us: u64,
        /// The inertial sensor's data-ready line.
        is_ready: bool,
        /// Bytes into the console port.
        console: &'a [u8],
        /// Suffer this now.
        injury: Option<Injury>,
    },
    /// The flight is over.
    End,
}
