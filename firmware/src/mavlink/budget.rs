//! What a narrow link carries: a bucket that fills with time.

use crate::time::Micros;

/// The bucket holds what the link carries in this time, µs.
const DEPTH_US: u64 = 200_000;

/// Bytes that may go now; below zero after what could not wait.
#[derive(Clone, Copy, Debug)]
pub(super) struct Budget {
    bytes_per_second: u32,
    /// Bytes, times a million.
    level: i64,
    filled_at: Option<Micros>,
}

impl Budget {
    pub const fn new(bytes_per_second: u32) -> Self {
        Self { bytes_per_second, level: 0, filled_at: None }
    }

    pub fn refill(&mut self, now: Micros) {
        let past = self.filled_at.map_or(0, |at| now.since(at)).min(DEPTH_US);
        self.filled_at = Some(now);
        let rate = i64::from(self.bytes_per_second);
        self.level = (self.level + past as i64 * rate).min(DEPTH_US as i64 * rate);
    }

    pub fn has_room(&self) -> bool {
        self.level > 0
    }

    pub fn spend(&mut self, bytes: usize) {
        self.level -= bytes as i64 * 1_000_000;
    }
}
