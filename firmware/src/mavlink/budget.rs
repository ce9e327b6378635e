//! What a link carries: a bucket that fills with time.
//!
//! Nobody says how wide a link is: until a client asks for rates of its own, it gets no more than a line of 57,600 baud
//! carries. A list of parameters is paced by the same bucket, and nothing of it is lost.

use crate::time::Micros;

/// A little less than a line of 57,600 baud, for others speak there too.
const BYTES_PER_SECOND: i64 = 5_500;
/// The bucket holds what the link carries in this time, µs.
const DEPTH_US: u64 = 100_000;

/// Bytes that may go now; below zero after what could not wait.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Budget {
    /// Bytes, times a million.
    level: i64,
    filled_at: Option<Micros>,
    /// The line is as narrow as that.
    is_fixed: bool,
    /// A client has said that it carries more.
    is_lifted: bool,
}

impl Budget {
    /// Whatever a client asks for.
    pub fn fix(&mut self) {
        self.is_fixed = true;
    }

    /// A client asks for rates of its own, and knows its link.
    pub fn lift(&mut self) {
        self.is_lifted = !self.is_fixed;
    }

    pub fn refill(&mut self, now: Micros) {
        let past = self.filled_at.map_or(0, |at| now.since(at)).min(DEPTH_US);
        self.filled_at = Some(now);
        let full = DEPTH_US as i64 * BYTES_PER_SECOND;
        self.level = (self.level + past as i64 * BYTES_PER_SECOND).min(full);
    }

    pub fn is_wide(&self) -> bool {
        self.is_lifted
    }

    pub fn has_room(&self) -> bool {
        self.is_lifted || self.level > 0
    }

    pub fn spend(&mut self, bytes: usize) {
        let floor = -(DEPTH_US as i64) * BYTES_PER_SECOND;
        self.level = (self.level - bytes as i64 * 1_000_000).max(floor);
    }
}
