//! SBUS: 100,000 baud, 8 data bits, even parity, 2 stop bits, inverted on the wire, one way.
//!
//! Twenty-five bytes: `0F`, sixteen channels of 11 bits, flags, an end byte. There is no checksum: header, end and the
//! flags' empty half tell a frame, and the silence between two of them, in which what was not whole is dropped.
//! The published crate for it reads whole frames and does not find one again.

use super::{Reading, channels};
use embedded_io::{Read, ReadReady};

/// Bits per second.
pub const BAUD: u32 = 100_000;
/// Bytes per frame.
pub const FRAME: usize = 25;
/// The first byte.
pub const HEADER: u8 = 0x0F;
/// Flags: this frame never arrived at the receiver, which repeats the last one; it has lost the pilot; never set.
pub(crate) const LOST: u8 = 1 << 2;
pub(crate) const FAILSAFE: u8 = 1 << 3;
const EMPTY: u8 = 0xF0;
/// End bytes: plain, and of the second version's four slots.
const ENDS: [u8; 5] = [0x00, 0x04, 0x14, 0x24, 0x34];

/// The driver.
#[derive(Debug)]
pub struct Sbus<UART> {
    uart: UART,
    buffer: [u8; FRAME],
    filled: usize,
    /// Bytes that began no frame.
    pub bad_bytes: u32,
}

impl<UART: Read + ReadReady> Sbus<UART> {
    /// The part talks by itself, 70 or 140 times a second.
    pub fn new(uart: UART) -> Self {
        Self { uart, buffer: [0; FRAME], filled: 0, bad_bytes: 0 }
    }

    /// Reads what has arrived; the newest whole frame, if any. Never waits. Call it once a millisecond: a call that
    /// finds nothing is the silence between two frames.
    ///
    /// # Errors
    /// The UART's.
    pub fn poll(&mut self) -> Result<Option<Reading>, UART::Error> {
        let mut newest = None;
        let mut is_silent = true;
        while self.uart.read_ready()? {
            let mut byte = [0];
            if self.uart.read(&mut byte)? == 0 {
                break;
            }
            let [byte] = byte;
            is_silent = false;
            newest = self.push(byte).or(newest);
        }
        if is_silent {
            self.bad_bytes = self.bad_bytes.wrapping_add(self.filled as u32);
            self.filled = 0;
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
        while self.filled > 0 {
            let [header, packed @ .., flags, end] = &self.buffer;
            let (flags, is_whole) = (*flags, self.filled == FRAME);
            let is_frame = *header == HEADER;
            if is_frame && !is_whole {
                return None;
            }
            if is_frame && ENDS.contains(end) && flags & EMPTY == 0 {
                let reading = channels(packed).map(|channels| Reading {
                    channels,
                    link_quality: None,
                    rssi_dbm: None,
                    is_failsafe: flags & FAILSAFE != 0,
                });
                self.filled = 0;
                // What did not arrive says nothing, unless the receiver says that nothing will.
                return reading.filter(|reading| flags & LOST == 0 || reading.is_failsafe);
            }
            self.bad_bytes = self.bad_bytes.wrapping_add(1);
            self.buffer.rotate_left(1);
            self.filled -= 1;
        }
        None
    }
}
