//! What a receiver of a pilot's radio says.

/// Channels of a radio.
pub const RADIO_CHANNELS: usize = 16;

/// One frame, as its driver read it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RawRadio {
    /// As a servo's pulses, µs.
    pub channels: [u16; RADIO_CHANNELS],
    /// Share of the pilot's packets that arrived lately, %; `None` where the receiver does not say.
    pub link_quality: Option<u8>,
    /// Strength of the pilot's signal, dBm; `None` where the receiver does not say.
    pub rssi_dbm: Option<i16>,
    /// The receiver says that it has lost the pilot.
    pub is_failsafe: bool,
}

impl RawRadio {
    /// A pilot is behind these channels; else they are what the receiver was told to give without one.
    #[must_use]
    pub fn is_heard(&self) -> bool {
        !self.is_failsafe && self.link_quality != Some(0)
    }
}
