//! Receivers of a pilot's radio.
//!
//! Both protocols carry sixteen channels of 11 bits, packed alike.

pub mod crsf;
pub mod sbus;

use uf_crsf::packets::{CrsfPacket, RcChannelsPacked};

/// Channels of a frame.
pub const CHANNELS: usize = 16;

/// One frame of channels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reading {
    /// Pulse widths as a servo would have them, µs: 880 to 2159, of which sticks use 988 to 2012.
    pub channels: [u16; CHANNELS],
    /// Share of the pilot's packets that arrived lately, %; `None` where the receiver does not say.
    pub link_quality: Option<u8>,
    /// Strength of the pilot's signal, dBm; `None` where the receiver does not say.
    pub rssi_dbm: Option<i16>,
    /// The receiver says that it has lost the pilot: its channels are what it was told to give then.
    pub is_failsafe: bool,
}

/// From packed channels; `None` for fewer bytes than they have.
fn channels(packed: &[u8]) -> Option<[u16; CHANNELS]> {
    RcChannelsPacked::from_bytes(packed).ok().map(|packed| packed.0.map(microseconds))
}

/// Of a channel's 11 bits: 992 is the middle, a step is 5/8 µs.
const fn microseconds(ticks: u16) -> u16 {
    (ticks * 5 + 4) / 8 + 880
}
