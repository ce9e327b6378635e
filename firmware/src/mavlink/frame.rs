//! Frames: finding them in a stream of bytes, and making them.
//!
//! The crate's reader wants a blocking source; here bytes are pushed, in chunks of any size. A frame that is
//! whole in a chunk is read where it stands; one that is cut is gathered first. A candidate that fails is
//! searched again from its second byte, so garbage never hides a frame that follows it. MAVLink 1
//! frames are understood too: many scripts speak it until they receive version 2.

use super::checksum::checksum;
use crate::signal::Ticket;
use mavlink::dialects::common::MavMessage;
use mavlink::{MAV_STX, MAV_STX_V2, Message};

/// Longest frame, version 2 with signature.
pub const MAX_FRAME: usize = 280;
const SIGNED: u8 = 0x01;
const SIGNATURE: usize = 13;

/// A valid frame; it lives where its bytes do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame<'a> {
    /// Message id.
    pub id: u32,
    /// Sender.
    pub system: u8,
    /// Sender's component.
    pub component: u8,
    /// As sent: version 2 cuts trailing zeros.
    pub payload: &'a [u8],
    /// Behind it, if it is signed.
    pub signature: Option<Signature<'a>>,
}

/// Who says that it comes from them; nobody has looked yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Signature<'a> {
    /// What is signed: the frame, the link and the time.
    pub covered: &'a [u8],
    /// Link, as the sender counts its own.
    pub link: u8,
    /// Tens of µs since 2015.
    pub timestamp: u64,
    /// The first bytes of the hash.
    pub mac: [u8; 6],
}

impl<'a> Signature<'a> {
    /// Of a whole signed frame.
    fn of(frame: &'a [u8]) -> Option<Self> {
        let (covered, mac) = frame.split_last_chunk::<6>()?;
        let [.., link, a, b, c, d, e, f] = *covered else { return None };
        let timestamp = u64::from_le_bytes([a, b, c, d, e, f, 0, 0]);
        Some(Self { covered, link, timestamp, mac: *mac })
    }
}

impl Frame<'_> {
    /// One byte of the payload, zero where it was cut.
    #[must_use]
    pub fn byte(&self, at: usize) -> u8 {
        self.payload.get(at).copied().unwrap_or(0)
    }
    /// Four bytes of the payload as a float.
    #[must_use]
    pub fn float(&self, at: usize) -> f32 {
        f32::from_le_bytes([self.byte(at), self.byte(at + 1), self.byte(at + 2), self.byte(at + 3)])
    }
    /// Four bytes of the payload as an integer.
    #[must_use]
    pub fn int(&self, at: usize) -> i32 {
        i32::from_le_bytes([self.byte(at), self.byte(at + 1), self.byte(at + 2), self.byte(at + 3)])
    }
    /// For what its sender asks; 0 where no acknowledgement is wanted.
    pub(super) fn ticket(&self, command: u16) -> Ticket {
        Ticket { command, system: self.system, component: self.component, link: 0 }
    }
    /// Two bytes of the payload.
    #[must_use]
    pub fn word(&self, at: usize) -> u16 {
        u16::from_le_bytes([self.byte(at), self.byte(at + 1)])
    }
}

/// What begins at the first byte.
enum Scan<'a> {
    /// Not to be told before so many bytes are there.
    More(usize),
    /// No valid frame.
    No { is_frame: bool },
    /// A frame of so many bytes.
    Yes(Frame<'a>, usize),
}

/// What belongs to no valid frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Losses {
    /// Bytes outside of valid frames.
    pub garbage_bytes: u32,
    /// Whole frames whose checksum or id is wrong.
    pub bad_frames: u32,
}

/// Push parser.
#[derive(Clone, Default)]
pub struct Parser {
    /// The cut beginning of a frame, undecided.
    buffer: heapless::Vec<u8, MAX_FRAME>,
    losses: Losses,
}

impl core::fmt::Debug for Parser {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        // Not the bytes: they may be half of a key.
        f.debug_struct("Parser").field("losses", &self.losses).finish_non_exhaustive()
    }
}

impl Parser {
    /// Empty.
    #[must_use]
    pub const fn new() -> Self {
        Self { buffer: heapless::Vec::new(), losses: Losses { garbage_bytes: 0, bad_frames: 0 } }
    }

    /// What was dropped so far.
    #[must_use]
    pub fn losses(&self) -> Losses {
        self.losses
    }

    /// Takes bytes in chunks of any size; `each` gets every frame that they complete.
    pub fn push(&mut self, bytes: &[u8], mut each: impl FnMut(&Frame)) {
        let mut bytes = bytes;
        while let Scan::More(wanted) = scan(&self.buffer) {
            let missing = wanted.saturating_sub(self.buffer.len());
            let Some((taken, rest)) = bytes.split_at_checked(missing) else {
                // Fits: what is wanted is no longer than the longest frame.
                let _ = self.buffer.extend_from_slice(bytes);
                return;
            };
            let _ = self.buffer.extend_from_slice(taken);
            bytes = rest;
            let used = read(&self.buffer, &mut self.losses, &mut each);
            self.drop_front(used);
        }
        let used = read(bytes, &mut self.losses, &mut each);
        let _ = self.buffer.extend_from_slice(bytes.get(used..).unwrap_or(&[]));
    }

    /// Ends a datagram: no frame spans two, so what is left is garbage, unless a whole frame hides in it.
    pub fn flush(&mut self, mut each: impl FnMut(&Frame)) {
        let mut left = self.buffer.as_slice();
        while let [_, rest @ ..] = left {
            self.losses.garbage_bytes = self.losses.garbage_bytes.wrapping_add(1);
            let used = read(rest, &mut self.losses, &mut each);
            left = rest.get(used..).unwrap_or(&[]);
        }
        self.buffer.clear();
    }

    fn drop_front(&mut self, count: usize) {
        let left = self.buffer.len().saturating_sub(count);
        if left > 0 {
            self.buffer.copy_within(count.., 0);
        }
        self.buffer.truncate(left);
    }
}

/// Gives every frame to `each`; how many bytes are decided.
fn read(bytes: &[u8], losses: &mut Losses, each: &mut impl FnMut(&Frame)) -> usize {
    let mut left = bytes;
    while !left.is_empty() {
        let used = match scan(left) {
            Scan::More(_) => break,
            Scan::Yes(frame, length) => {
                each(&frame);
                length
            }
            Scan::No { is_frame } => {
                losses.garbage_bytes = losses.garbage_bytes.wrapping_add(1);
                losses.bad_frames = losses.bad_frames.wrapping_add(u32::from(is_frame));
                1
            }
        };
        left = left.get(used..).unwrap_or(&[]);
    }
    bytes.len() - left.len()
}

fn scan(bytes: &[u8]) -> Scan<'_> {
    match *bytes {
        [MAV_STX_V2, _, flags, ..] if flags & !SIGNED != 0 => Scan::No { is_frame: false },
        [MAV_STX_V2, length, flags, ..] => {
            let end = 10 + usize::from(length);
            let total = end + 2 + if flags == SIGNED { SIGNATURE } else { 0 };
            let Some([_, _, _, _, _, system, component, a, b, c, payload @ ..]) = bytes.get(..end)
            else {
                return Scan::More(total);
            };
            let id = u32::from_le_bytes([*a, *b, *c, 0]);
            let signature = None;
            let frame = Frame { id, system: *system, component: *component, payload, signature };
            whole(bytes, frame, end, total)
        }
        [MAV_STX, length, ..] => {
            let end = 6 + usize::from(length);
            let Some([_, _, _, system, component, id, payload @ ..]) = bytes.get(..end) else {
                return Scan::More(end + 2);
            };
            let id = u32::from(*id);
            let signature = None;
            let frame = Frame { id, system: *system, component: *component, payload, signature };
            whole(bytes, frame, end, end + 2)
        }
        [MAV_STX_V2, ..] => Scan::More(3),
        [MAV_STX] => Scan::More(2),
        _ => Scan::No { is_frame: false },
    }
}

/// A frame whose checksum begins at `end`, if all of it is there and the checksum is right.
fn whole<'a>(bytes: &'a [u8], frame: Frame<'a>, end: usize, total: usize) -> Scan<'a> {
    let (Some(covered), Some([low, high, ..])) = (bytes.get(1..end), bytes.get(end..total)) else {
        return Scan::More(total);
    };
    if checksum(covered, MavMessage::extra_crc(frame.id)) == u16::from_le_bytes([*low, *high]) {
        let is_signed = total > end + 2;
        let signature = bytes.get(..total).filter(|_| is_signed).and_then(Signature::of);
        Scan::Yes(Frame { signature, ..frame }, total)
    } else {
        Scan::No { is_frame: true }
    }
}

/// Sender and number of a frame.
#[derive(Clone, Copy, Debug)]
pub struct Header {
    pub sequence: u8,
    pub system: u8,
    pub component: u8,
}

/// Makes a version 2 frame in `out`; `None` if it does not fit. One that is to be signed says so.
pub fn encode<'a>(
    (header, is_signed): (Header, bool),
    id: u32,
    extra_crc: u8,
    payload: &[u8],
    out: &'a mut [u8; MAX_FRAME],
) -> Option<&'a [u8]> {
    let [a, b, c, _] = id.to_le_bytes();
    let length = u8::try_from(payload.len()).ok()?;
    let flags = if is_signed { SIGNED } else { 0 };
    let head =
        [MAV_STX_V2, length, flags, 0, header.sequence, header.system, header.component, a, b, c];
    let end = head.len() + payload.len();
    for (to, from) in out.iter_mut().zip(head.iter().chain(payload)) {
        *to = *from;
    }
    let crc = checksum(out.get(1..end)?, extra_crc).to_le_bytes();
    out.get_mut(end..end + 2)?.copy_from_slice(&crc);
    out.get(..end + 2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    fn heartbeat(sequence: u8) -> Vec<u8> {
        let mut out = [0; MAX_FRAME];
        let header = Header { sequence, system: 255, component: 190 };
        encode((header, false), 0, 50, &[0, 0, 0, 0, 6, 8, 0, 4, 3], &mut out).unwrap().to_vec()
    }

    #[test]
    fn frames_survive_any_chunking_and_any_garbage_between_them() {
        let mut stream = Vec::new();
        let mut seed = 1_u32;
        for i in 0..50 {
            stream.extend(heartbeat(i));
            for _ in 0..i {
                seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                stream.push((seed >> 24) as u8);
            }
            // A truncated frame, whose length promises more than comes.
            stream.extend_from_slice(heartbeat(i).get(..9).unwrap());
        }
        // What the last truncated frame swallowed must come out again.
        stream.extend(std::iter::repeat_n(0_u8, 300));
        let mut parser = Parser::new();
        let mut count = 0;
        for byte in stream {
            parser.push(&[byte], |frame| {
                assert_eq!((frame.id, frame.system, frame.byte(4)), (0, 255, 6));
                count += 1;
            });
        }
        assert_eq!(count, 50);
        assert!(parser.losses().garbage_bytes > 1000);
    }

    #[test]
    fn a_flipped_bit_is_never_accepted() {
        let good = heartbeat(7);
        for bit in 0..good.len() * 8 {
            let mut bad = good.clone();
            bad[bit / 8] ^= 1 << (bit % 8);
            let mut parser = Parser::new();
            parser.push(&bad, |_| panic!("bit {bit}"));
        }
    }

    /// What a frame says, with its bytes.
    type Owned = (u32, u8, u8, Vec<u8>);

    /// Frames and losses of datagrams, each cut into chunks.
    fn parse(datagrams: &[Vec<u8>], mut chunk: impl FnMut() -> usize) -> (Vec<Owned>, Vec<Losses>) {
        let (mut parser, mut frames, mut losses) = (Parser::new(), Vec::new(), Vec::new());
        for datagram in datagrams {
            let mut own = |frame: &Frame| {
                frames.push((frame.id, frame.system, frame.component, frame.payload.to_vec()));
            };
            let mut rest = datagram.as_slice();
            while !rest.is_empty() {
                let (now, later) = rest.split_at(chunk().clamp(1, rest.len()));
                parser.push(now, &mut own);
                rest = later;
            }
            losses.push(parser.losses());
            // Every other one is a serial port's: its end says nothing.
            if losses.len().is_multiple_of(2) {
                parser.flush(&mut own);
            }
            losses.push(parser.losses());
        }
        (frames, losses)
    }

    /// Frames of both versions, signed, cut, flipped, inside of each other, and bytes that promise one.
    fn stream(random: &mut impl FnMut() -> usize) -> Vec<u8> {
        let mut out = Vec::new();
        for _ in 0..1 + random() % 12 {
            let mut part = match random() % 6 {
                0 => heartbeat(random() as u8),
                1 => {
                    let mut frame = heartbeat(3);
                    frame[2] = SIGNED;
                    let end = frame.len() - 2;
                    let crc = checksum(&frame[1..end], 50).to_le_bytes();
                    frame[end..].copy_from_slice(&crc);
                    frame.extend((0..SIGNATURE).map(|_| random() as u8));
                    frame
                }
                2 => {
                    let mut frame =
                        std::vec![MAV_STX, 9, 7, 255, 190, 0, 0, 0, 0, 0, 6, 8, 0, 4, 3];
                    let crc = checksum(&frame[1..], 50).to_le_bytes();
                    frame.extend(crc);
                    frame
                }
                // A frame in the payload of one that fails.
                3 => {
                    let mut frame = std::vec![MAV_STX_V2, 40, 0, 0, 0, 1, 1, 30, 0, 0];
                    frame.extend(heartbeat(9));
                    frame.resize(52, random() as u8);
                    frame
                }
                4 => (0..random() % 40).map(|_| random() as u8).collect(),
                _ => (0..random() % 40)
                    .map(|_| [MAV_STX, MAV_STX_V2, 0, 1, 255][random() % 5])
                    .collect(),
            };
            if random().is_multiple_of(4) && !part.is_empty() {
                part.truncate(random() % part.len());
            }
            if random().is_multiple_of(6) && !part.is_empty() {
                let at = random() % part.len();
                part[at] ^= 1 << (random() % 8);
            }
            out.extend(part);
        }
        out
    }

    #[test]
    fn any_chunking_gives_what_single_bytes_give() {
        let mut seed = 1_u64;
        let mut random = move || {
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) as usize
        };
        let mut count = 0;
        for _ in 0..3000 {
            let datagrams: Vec<_> = (0..1 + random() % 4).map(|_| stream(&mut random)).collect();
            let single = parse(&datagrams, || 1);
            for most in [2, 13, 64, 300, usize::MAX] {
                assert_eq!(parse(&datagrams, || 1 + random() % most), single, "{datagrams:?}");
            }
            assert_eq!(parse(&datagrams, || usize::MAX), single, "{datagrams:?}");
            count += single.0.len();
        }
        assert!(count > 10_000, "{count}");
    }
}
