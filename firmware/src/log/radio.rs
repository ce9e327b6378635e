//! A pilot's radio in the log.

use super::flight::SLOW;
use super::ulog::record;

/// PX4's numbers of the protocols: only CRSF tells a link quality.
const CRSF: u8 = 14;
const SBUS: u8 = 9;
/// What it takes a link quality for that is not told.
const UNKNOWN: i8 = -1;

record! {
    /// `input_rc`: the last frame of a pilot's radio, once there was one.
    InputRc {
        /// Of that frame, µs.
        timestamp_last_signal: u64,
        /// Strength of the pilot's signal, dBm; NaN: unknown.
        rssi_dbm: f32,
        /// Link quality, %; -1: unknown.
        rssi: i32,
        /// The receiver says that it has lost the pilot.
        rc_failsafe: bool,
        /// It was silent for half a second, or has lost the pilot.
        rc_lost: bool,
        /// 14: CRSF, 9: SBUS.
        input_source: u8,
        /// Link quality, %; -1: unknown.
        link_quality: i8,
        /// Of `values`.
        channel_count: u8,
        /// Pulses, µs.
        values: [u16; 18],
    }
    topic "input_rc" every SLOW;
    of |out| {
        let frame = out.radio?;
        let radio = &frame.value;
        let quality = radio.link_quality.map_or(UNKNOWN, |quality| quality.min(100) as i8);
        let mut values = [0; 18];
        for (value, channel) in values.iter_mut().zip(radio.channels) {
            *value = channel;
        }
        Some(Self {
            timestamp: out.now.0,
            timestamp_last_signal: frame.at.0,
            rssi_dbm: radio.rssi_dbm.map_or(f32::NAN, f32::from),
            rssi: quality.into(),
            rc_failsafe: radio.is_failsafe,
            rc_lost: !out.radio_is_heard(),
            input_source: if radio.link_quality.is_some() { CRSF } else { SBUS },
            link_quality: quality,
            channel_count: radio.channels.len() as u8,
            values,
        })
    }
}
