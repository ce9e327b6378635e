//! MAVLink 2 signing: who holds the key may ask; everybody else may look.
//!
//! A frame carries a time that only grows, and the beginning of a hash over key, frame and time. A sender whose time
//! does not grow is a recording. What each sender's time was is kept by the host over a restart.

use super::frame::{Frame, MAX_FRAME};
use crate::time::Micros;
use heapless::Vec;
use sha2::{Digest, Sha256};
use subtle::ConstantTimeEq;

/// Bytes of a key.
pub const KEY: usize = 32;
/// Senders whose time is known; the one that spoke least recently makes room.
const SENDERS: usize = 16;
/// A sender that nobody has heard yet may be so far behind, tens of µs: a minute.
const BEHIND: u64 = 6_000_000;

/// Somebody who signs, and the time of their last frame, tens of µs since 2015.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sender {
    /// System, component and link.
    pub id: [u8; 3],
    /// Of the last frame that was believed.
    pub timestamp: u64,
}

/// The key, and what has been heard under it.
#[derive(Clone)]
pub struct Signing {
    key: [u8; KEY],
    /// Of the next frame out, tens of µs since 2015.
    now: u64,
    /// When that was set.
    at: Option<Micros>,
    senders: Vec<Sender, SENDERS>,
}

impl core::fmt::Debug for Signing {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        // Not the key.
        f.debug_struct("Signing").field("now", &self.now).field("senders", &self.senders).finish()
    }
}

/// The first bytes of the hash over key and frame.
fn mac(key: &[u8; KEY], covered: &[u8]) -> [u8; 6] {
    let hash = Sha256::new().chain_update(key).chain_update(covered).finalize();
    let mut mac = [0; 6];
    mac.iter_mut().zip(hash).for_each(|(to, from)| *to = from);
    mac
}

impl Signing {
    /// With a key; `now` is the time of day, or the last that was kept, tens of µs since 2015.
    #[must_use]
    pub const fn new(key: [u8; KEY], now: u64) -> Self {
        Self { key, now, at: None, senders: Vec::new() }
    }

    /// What was kept of a sender.
    pub fn remember(&mut self, sender: Sender) {
        self.note(sender);
        self.now = self.now.max(sender.timestamp);
    }

    /// For the host to keep.
    #[must_use]
    pub fn senders(&self) -> &[Sender] {
        &self.senders
    }

    /// Time goes on.
    pub(super) fn tick(&mut self, now: Micros) {
        let past = self.at.map_or(0, |at| now.since(at)) / 10;
        if past > 0 || self.at.is_none() {
            self.at = Some(now);
            self.now = self.now.saturating_add(past);
        }
    }

    fn note(&mut self, sender: Sender) {
        let before = self.senders.len();
        self.senders.retain(|known| known.id != sender.id);
        if self.senders.len() == before && self.senders.is_full() {
            self.senders.remove(0);
        }
        let _ = self.senders.push(sender);
    }

    /// Whether a frame was made with the key, and not before.
    pub(super) fn believes(&mut self, frame: &Frame) -> bool {
        let Some(signature) = &frame.signature else { return false };
        if !bool::from(mac(&self.key, signature.covered).ct_eq(&signature.mac)) {
            return false;
        }
        let id = [frame.system, frame.component, signature.link];
        let timestamp = signature.timestamp;
        let known = self.senders.iter().find(|known| known.id == id);
        let is_new = match known {
            Some(known) => timestamp > known.timestamp,
            None => timestamp.saturating_add(BEHIND) > self.now,
        };
        if is_new {
            self.note(Sender { id, timestamp });
            self.now = self.now.max(timestamp);
        }
        is_new
    }

    /// Signs a frame of a link that is marked as signed; its whole length.
    pub(super) fn sign(&mut self, link: u8, frame: &mut [u8; MAX_FRAME], length: usize) -> usize {
        self.now += 1;
        let [a, b, c, d, e, f, ..] = self.now.to_le_bytes();
        let covered = put(frame, length, &[link, a, b, c, d, e, f]);
        let mac = mac(&self.key, frame.get(..covered).unwrap_or(&[]));
        put(frame, covered, &mac)
    }
}

/// Bytes at a place of a frame; where they end.
fn put(frame: &mut [u8; MAX_FRAME], at: usize, bytes: &[u8]) -> usize {
    let room = frame.iter_mut().skip(at);
    room.zip(bytes).for_each(|(to, from)| *to = *from);
    at + bytes.len()
}
