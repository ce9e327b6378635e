//! Fake TFmini-S behind a UART. Traps reproduced: its three "no reading" codes, weak echoes, lost
//! bytes, 0x59 inside the payload (a distance of 89 cm, say).

use super::FakeClock;
use crate::rangefinder::tfmini::HEADER;
use embedded_io::{ErrorType, Read, ReadReady};
use std::collections::VecDeque;
use std::convert::Infallible;

const PERIOD_US: u64 = 10_000;
const MAX_CM: f64 = 1_200.0;
const MIN_CM: f64 = 10.0;
const WEAK: u16 = 0xFFFF;

/// The part.
#[derive(Debug)]
pub struct FakeTfMini {
    clock: FakeClock,
    sent_at: u64,
    queue: VecDeque<u8>,
    frames: u64,
    /// Silent.
    pub is_dead: bool,
    /// Every n-th frame loses a byte on the line; 0 = none.
    pub lose_byte_every: u64,
}

impl FakeTfMini {
    /// Just powered up.
    #[must_use]
    pub fn new(clock: FakeClock) -> Self {
        Self {
            clock,
            sent_at: 0,
            queue: VecDeque::new(),
            frames: 0,
            is_dead: false,
            lose_byte_every: 0,
        }
    }

    /// Whether the next frame is due: measure then, and call [`Self::set_distance`].
    #[must_use]
    pub fn is_due(&self) -> bool {
        self.clock.now_us() >= self.sent_at + PERIOD_US
    }

    /// The truth, m; a frame goes out if one is due.
    pub fn set_distance(&mut self, metres: f64) {
        if !self.is_due() {
            return;
        }
        self.sent_at = self.clock.now_us();
        if self.is_dead {
            return;
        }
        let cm = metres * 100.0;
        let in_range = (MIN_CM..=MAX_CM).contains(&cm);
        let (distance, strength) = if in_range { (cm.round() as u16, 2_000) } else { (WEAK, 20) };
        let ([dl, dh], [sl, sh]) = (distance.to_le_bytes(), u16::to_le_bytes(strength));
        let body = [HEADER, HEADER, dl, dh, sl, sh, 0x00, 0x09];
        let sum = body.iter().fold(0_u8, |sum, &byte| sum.wrapping_add(byte));
        self.frames += 1;
        let loses = self.lose_byte_every > 0 && self.frames.is_multiple_of(self.lose_byte_every);
        let lost =
            if loses { (self.frames / self.lose_byte_every % 9) as usize } else { usize::MAX };
        let frame = body.into_iter().chain([sum]).enumerate();
        self.queue.extend(frame.filter(|&(at, _)| at != lost).map(|(_, byte)| byte));
    }

    /// Bytes as they are, for tests.
    pub fn inject(&mut self, bytes: &[u8]) {
        self.queue.extend(bytes);
    }
}

impl ErrorType for FakeTfMini {
    type Error = Infallible;
}

impl ReadReady for FakeTfMini {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        Ok(!self.queue.is_empty())
    }
}

impl Read for FakeTfMini {
    fn read(&mut self, into: &mut [u8]) -> Result<usize, Infallible> {
        let mut count = 0;
        for (slot, byte) in into.iter_mut().zip(std::iter::from_fn(|| self.queue.pop_front())) {
            *slot = byte;
            count += 1;
        }
        Ok(count)
    }
}
