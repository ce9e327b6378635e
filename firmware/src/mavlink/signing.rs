//! MAVLink 2 signing: who holds the key may ask; everybody else may look.
//!
//! A frame carries a time that only grows, and the beginning of a hash over key, frame and time. A sender whose time
//! does not grow is a recording, also one from before a restart. For that
//!
//! - a host with a clock of day and a disk keeps each sender's time ([`Signing::new`], [`Signing::senders`]);
//! - a board has neither, and its flash stands ten thousand erasings, each of which may stop the processor. It keeps one
//!   time with the key that is ahead of everybody's ([`Kept`]): on the ground nothing later is believed before a later
//!   one is in flash, and after a restart nothing up to it is. [`RESERVE`] says how far ahead.
//!
//! What that costs an honest station after a restart is the first frame it signs, with which the next time is kept. The
//! board's own time begins at the kept one, which is ahead of the day's, but a station goes on from the latest time it
//! has heard, as the protocol wants it (pymavlink, MAVLink's C library): the board's first heartbeat brings it there.
//! Only who sends without listening waits for the reserve to pass.
//!
//! In flight nothing is written. A flight that outlasts the reserve and ends with the power lost leaves recordings of its
//! later part that pass until a holder of the key is heard: the price of not refusing a station in the air.

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
/// How far ahead a board keeps its time, tens of µs: two hours, and at least one at take-off, since it is kept anew when
/// half is used up. Up to twelve restarts a day its time does not run away from the day's; the flash is written once an
/// hour while somebody signs.
pub const RESERVE: u64 = 2 * 3600 * 100_000;
/// First time that a frame cannot carry.
const END: u64 = 1 << 48;

/// Somebody who signs, and the time of their last frame, tens of µs since 2015.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sender {
    /// System, component and link.
    pub id: [u8; 3],
    /// Of the last frame that was believed.
    pub timestamp: u64,
}

/// What a board has in its flash: the key, and up to which time nothing is believed after a restart.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Kept {
    key: [u8; KEY],
    until: u64,
}

/// A key that somebody sets, all zeros to sign no more.
#[derive(Clone, Copy)]
pub struct NewKey {
    key: [u8; KEY],
    /// From when on frames signed with it are believed, tens of µs since 2015.
    start: u64,
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
    /// What is not later was heard before a restart.
    floor: u64,
    /// What is later is believed when this has moved.
    until: u64,
}

/// What to make of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// Made with the key, and not before.
    Good,
    /// Good, but a restart would forget it.
    Early,
    /// Unsigned, wrongly signed, or a recording.
    Bad,
}

/// Not the key.
macro_rules! hide_key {
    ($($name:ident: $($field:ident)*;)*) => {$(
        impl core::fmt::Debug for $name {
            fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                f.debug_struct(stringify!($name))$(.field(stringify!($field), &self.$field))*.finish_non_exhaustive()
            }
        }
    )*};
}
hide_key! {
    Kept: until;
    NewKey: start;
    Signing: now senders floor until;
}

/// The first bytes of the hash over key and frame.
fn mac(key: &[u8; KEY], covered: &[u8]) -> [u8; 6] {
    let hash = Sha256::new().chain_update(key).chain_update(covered).finalize();
    let mut mac = [0; 6];
    mac.iter_mut().zip(hash).for_each(|(to, from)| *to = from);
    mac
}

impl Kept {
    /// Bytes of it.
    pub const BYTES: usize = KEY + 8;

    /// As a flash holds it.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; Self::BYTES] {
        let mut bytes = [0; Self::BYTES];
        let all = self.key.into_iter().chain(self.until.to_le_bytes());
        bytes.iter_mut().zip(all).for_each(|(to, from)| *to = from);
        bytes
    }

    /// From a flash.
    #[must_use]
    pub fn from_bytes(bytes: &[u8; Self::BYTES]) -> Option<Self> {
        let (key, rest) = bytes.split_first_chunk()?;
        Some(Self { key: *key, until: u64::from_le_bytes(*rest.first_chunk()?) })
    }
}

impl NewKey {
    /// `start`: tens of µs since 2015; `None` of a time that no frame can carry.
    #[must_use]
    pub fn try_new(key: [u8; KEY], start: u64) -> Option<Self> {
        (start < END).then_some(Self { key, start })
    }

    fn is_none(&self) -> bool {
        self.key == [0; KEY]
    }

    /// In the place of the key before: what was heard under that stays a recording, if it is the same.
    #[must_use]
    pub fn after(self, before: Option<&Signing>) -> Self {
        Self { start: before.map_or(self.start, |signing| self.start.max(signing.now)), ..self }
    }

    /// What is to be in flash before it is in force.
    #[must_use]
    pub fn kept(&self) -> Kept {
        let until = if self.is_none() { 0 } else { self.start.saturating_add(RESERVE) };
        Kept { key: self.key, until }
    }

    /// In force, now that it is kept; `None`: nothing is signed.
    #[must_use]
    pub fn in_force(&self) -> Option<Signing> {
        let begun = Signing { floor: self.start, ..Signing::new(self.key, self.start) };
        (!self.is_none()).then_some(Signing { until: self.kept().until, ..begun })
    }
}

impl Signing {
    /// With a key, on a host that keeps what each sender's time was; `now` is the time of day, tens of µs since 2015.
    #[must_use]
    pub const fn new(key: [u8; KEY], now: u64) -> Self {
        Self { key, now, at: None, senders: Vec::new(), floor: 0, until: u64::MAX }
    }

    /// On a board that starts; `None` without a key.
    #[must_use]
    pub fn resume(kept: &Kept) -> Option<Self> {
        let Kept { key, until } = *kept;
        let signing = Self { floor: until, until, ..Self::new(key, until) };
        (key != [0; KEY]).then_some(signing)
    }

    /// What a board is to keep now, on the ground; nothing before somebody was heard, or every start would move it.
    #[must_use]
    pub fn to_keep(&self) -> Option<Kept> {
        let is_due = !self.senders.is_empty() && self.until.saturating_sub(self.now) < RESERVE / 2;
        is_due.then_some(Kept { key: self.key, until: self.now.saturating_add(RESERVE) })
    }

    /// It is in flash.
    pub fn note_kept(&mut self, kept: &Kept) {
        if kept.key == self.key {
            self.until = self.until.max(kept.until);
        }
    }

    /// The flash takes nothing more: better to believe without than nobody.
    pub fn keep_nothing(&mut self) {
        self.until = u64::MAX;
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
            // Whom nobody remembers has to be newer than what is forgotten of them.
            self.floor = self.floor.max(self.senders.remove(0).timestamp);
        }
        let _ = self.senders.push(sender);
    }

    /// Whether a frame was made with the key, and not before. In the air whatever is good is believed.
    pub(super) fn judge(&mut self, frame: &Frame, is_armed: bool) -> Verdict {
        let Some(signature) = &frame.signature else { return Verdict::Bad };
        if !bool::from(mac(&self.key, signature.covered).ct_eq(&signature.mac)) {
            return Verdict::Bad;
        }
        let id = [frame.system, frame.component, signature.link];
        let timestamp = signature.timestamp;
        let known = self.senders.iter().find(|known| known.id == id);
        let is_new = match known {
            Some(known) => timestamp > known.timestamp,
            None => timestamp > self.floor && timestamp.saturating_add(BEHIND) > self.now,
        };
        if !is_new {
            return Verdict::Bad;
        }
        self.remember(Sender { id, timestamp });
        if timestamp > self.until && !is_armed { Verdict::Early } else { Verdict::Good }
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
