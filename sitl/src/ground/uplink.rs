//! The radio from the ground stations to the vehicle: loses and delays what a fault says.

use crate::plant::{Generator, generator, uniform};
use crate::scenario::{FaultKind, Faults};
use std::collections::VecDeque;

/// What is under way: when it arrives, s, by which link, and its bytes.
#[derive(Debug)]
pub struct Uplink {
    rng: Generator,
    under_way: VecDeque<(f64, u8, Vec<u8>)>,
}

impl Uplink {
    /// Nothing under way.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self { rng: generator(seed, 8), under_way: VecDeque::new() }
    }

    /// Whether the datagram arrives at once at `time` s; one that is late comes by [`Self::arrived`].
    pub fn passes(&mut self, faults: &Faults, time: f64, link: u8, datagram: &[u8]) -> bool {
        let dropped = faults.added(FaultKind::LinkLoss, time);
        if dropped > 0.0 && 0.5 * (1.0 + uniform(&mut self.rng)) < dropped {
            return false;
        }
        let delay = faults.added(FaultKind::LinkDelay, time);
        if delay > 0.0 || !self.under_way.is_empty() {
            self.under_way.push_back((time + delay, link, datagram.to_vec()));
            return false;
        }
        true
    }

    /// The next late datagram that has arrived by `time` s, and its link.
    pub fn arrived(&mut self, time: f64) -> Option<(u8, Vec<u8>)> {
        let (_, link, datagram) = self.under_way.pop_front_if(|(due, ..)| *due <= time)?;
        Some((link, datagram))
    }
}
