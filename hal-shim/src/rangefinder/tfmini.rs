//! Benewake TFmini-S and TFmini Plus over UART.
//!
//! Nine bytes: `59 59 dist_l dist_h strength_l strength_h temp_l temp_h sum`. A byte 0x59 may stand
//! anywhere in the payload, so only the checksum tells a frame; after a failure the search goes on at
//! the second byte.

use embedded_io::{Read, ReadReady};

/// Both header bytes.
pub const HEADER: u8 = 0x59;
/// Bytes per frame.
pub const FRAME: usize = 9;
/// Weakest echo that counts (TFmini Plus; the S says so in the distance).
const STRENGTH_MIN: u16 = 100;
/// Distances that mean "no reading": -1 weak, -2 saturated, -4 ambient light.
const INVALID_FROM: u16 = 0xFFFC;

/// One frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reading {
    /// cm; `None` where the part says that it has none.
    pub distance_cm: Option<u16>,
    /// Echo strength.
    pub strength: u16,
}

/// The driver.
#[derive(Debug)]
pub struct TfMini<UART> {
    uart: UART,
    buffer: [u8; FRAME],
    filled: usize,
    /// Frames whose checksum failed.
    pub bad_frames: u32,
}

impl<UART: Read + ReadReady> TfMini<UART> {
    /// The part talks by itself, at 100 Hz.
    pub fn new(uart: UART) -> Self {
        Self { uart, buffer: [0; FRAME], filled: 0, bad_frames: 0 }
    }

    /// Reads what has arrived; the newest whole frame, if any. Never waits.
    ///
    /// # Errors
    /// The UART's.
    pub fn poll(&mut self) -> Result<Option<Reading>, UART::Error> {
        let mut newest = None;
        while self.uart.read_ready()? {
            let mut byte = [0];
            if self.uart.read(&mut byte)? == 0 {
                break;
            }
            let [byte] = byte;
            newest = self.push(byte).or(newest);
        }
        Ok(newest)
    }

    /// The UART, for its owner.
    pub fn bus_mut(&mut self) -> &mut UART {
        &mut self.uart
    }

    fn push(&mut self, byte: u8) -> Option<Reading> {
        if let Some(slot) = self.buffer.get_mut(self.filled) {
            *slot = byte;
            self.filled += 1;
        }
        loop {
            let [h0, h1, dl, dh, sl, sh, _, _, sum] = self.buffer;
            let is_start = h0 == HEADER && (self.filled < 2 || h1 == HEADER);
            if self.filled == 0 || (is_start && self.filled < FRAME) {
                return None;
            }
            let payload = self.buffer.iter().take(FRAME - 1);
            if is_start && payload.fold(0_u8, |sum, &b| sum.wrapping_add(b)) == sum {
                self.filled = 0;
                let (distance, strength) =
                    (u16::from_le_bytes([dl, dh]), u16::from_le_bytes([sl, sh]));
                let is_valid = distance > 0
                    && distance < INVALID_FROM
                    && (STRENGTH_MIN..u16::MAX).contains(&strength);
                return Some(Reading { distance_cm: is_valid.then_some(distance), strength });
            }
            self.bad_frames = self.bad_frames.wrapping_add(u32::from(is_start));
            self.buffer.rotate_left(1);
            self.filled -= 1;
        }
    }
}
