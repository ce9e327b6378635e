//! Frames: finding them in a stream of bytes, and making them.
//!
//! The crate's reader wants a blocking source; here bytes are pushed. A candidate that fails is
//! searched again from its second byte, so garbage never hides a frame that follows it. MAVLink 1
//! frames are understood too: many scripts speak it until they receive version 2.

use mavlink::dialects::common::MavMessage;
use mavlink::{MAV_STX, MAV_STX_V2, Message, calculate_crc};

/// Longest frame, version 2 with signature.
pub const MAX_FRAME: usize = 280;
const SIGNED: u8 = 0x01;

/// A valid frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Message id.
    pub id: u32,
    /// Sender.
    pub system: u8,
    /// Sender's component.
    pub component: u8,
    length: u8,
    payload: [u8; 255],
}

impl Frame {
    /// As sent: version 2 cuts trailing zeros.
    #[must_use]
    pub fn payload(&self) -> &[u8] {
        self.payload.get(..usize::from(self.length)).unwrap_or(&[])
    }
    /// One byte of the payload, zero where it was cut.
    #[must_use]
    pub fn byte(&self, at: usize) -> u8 {
        self.payload().get(at).copied().unwrap_or(0)
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
    /// Two bytes of the payload.
    #[must_use]
    pub fn word(&self, at: usize) -> u16 {
        u16::from_le_bytes([self.byte(at), self.byte(at + 1)])
    }
}

/// What a scan of the buffer found.
#[expect(clippy::large_enum_variant, reason = "lives on the stack for one call")]
enum Scan {
    /// Wait for more bytes.
    More,
    /// The first byte begins no valid frame.
    No { is_frame: bool },
    /// A frame of so many bytes.
    Yes(Frame, usize),
}

/// Push parser.
#[derive(Clone, Debug)]
pub struct Parser {
    buffer: heapless::Vec<u8, MAX_FRAME>,
    /// Bytes that belong to no valid frame.
    pub garbage_bytes: u32,
    /// Whole frames whose checksum or id is wrong.
    pub bad_frames: u32,
}

impl Default for Parser {
    fn default() -> Self {
        Self::new()
    }
}

impl Parser {
    /// Empty.
    #[must_use]
    pub const fn new() -> Self {
        Self { buffer: heapless::Vec::new(), garbage_bytes: 0, bad_frames: 0 }
    }

    /// Takes one byte; a frame if it completed one. Call [`Self::pending`] until it is empty.
    pub fn push(&mut self, byte: u8) -> Option<Frame> {
        // Cannot overflow: a full buffer always holds a decidable candidate, and was decided.
        if self.buffer.push(byte).is_err() {
            self.buffer.clear();
        }
        self.pending()
    }

    /// Ends a datagram: no frame spans two, so what is left is garbage, unless a whole frame hides in it.
    pub fn flush(&mut self) -> Option<Frame> {
        while !self.buffer.is_empty() {
            self.garbage_bytes = self.garbage_bytes.wrapping_add(1);
            self.buffer.rotate_left(1);
            self.buffer.pop();
            if let Some(frame) = self.pending() {
                return Some(frame);
            }
        }
        None
    }

    /// A further frame from what is already buffered.
    pub fn pending(&mut self) -> Option<Frame> {
        let mut skip = 0;
        let found = loop {
            let rest = self.buffer.get(skip..).unwrap_or(&[]);
            if rest.is_empty() {
                break None;
            }
            match scan(rest) {
                Scan::More => break None,
                Scan::Yes(frame, used) => {
                    skip += used;
                    break Some(frame);
                }
                Scan::No { is_frame } => {
                    skip += 1;
                    self.garbage_bytes = self.garbage_bytes.wrapping_add(1);
                    self.bad_frames = self.bad_frames.wrapping_add(u32::from(is_frame));
                }
            }
        };
        if skip > 0 {
            let kept = self.buffer.len().saturating_sub(skip);
            let by = skip.min(self.buffer.len());
            self.buffer.rotate_left(by);
            self.buffer.truncate(kept);
        }
        found
    }
}

fn scan(bytes: &[u8]) -> Scan {
    match bytes {
        [MAV_STX_V2] => Scan::More,
        [MAV_STX_V2, length, rest @ ..] => {
            let flags = rest.first().copied();
            if flags.is_some_and(|flags| flags & !SIGNED != 0) {
                return Scan::No { is_frame: false };
            }
            let signature = if flags == Some(SIGNED) { 13 } else { 0 };
            whole(bytes, 10, usize::from(*length), signature, |h| {
                let [_, _, _, _, _, system, component, a, b, c] = h else {
                    return None;
                };
                Some((u32::from_le_bytes([*a, *b, *c, 0]), *system, *component))
            })
        }
        [MAV_STX] => Scan::More,
        [MAV_STX, length, ..] => whole(bytes, 6, usize::from(*length), 0, |h| {
            let [_, _, _, system, component, id] = h else {
                return None;
            };
            Some((u32::from(*id), *system, *component))
        }),
        _ => Scan::No { is_frame: false },
    }
}

fn whole(
    bytes: &[u8],
    header: usize,
    length: usize,
    signature: usize,
    fields: impl Fn(&[u8]) -> Option<(u32, u8, u8)>,
) -> Scan {
    let end = header + length;
    let total = end + 2 + signature;
    let (Some(head), Some(body), Some([low, high])) =
        (bytes.get(..header), bytes.get(header..end), bytes.get(end..end + 2))
    else {
        return Scan::More;
    };
    if bytes.len() < total {
        return Scan::More;
    }
    let Some((id, system, component)) = fields(head) else {
        return Scan::No { is_frame: false };
    };
    let covered = bytes.get(1..end).unwrap_or(&[]);
    let crc = calculate_crc(covered, MavMessage::extra_crc(id));
    if crc != u16::from_le_bytes([*low, *high]) {
        return Scan::No { is_frame: true };
    }
    let mut payload = [0; 255];
    for (to, from) in payload.iter_mut().zip(body) {
        *to = *from;
    }
    Scan::Yes(Frame { id, system, component, length: length as u8, payload }, total)
}

/// Sender and number of a frame.
#[derive(Clone, Copy, Debug)]
pub struct Header {
    pub sequence: u8,
    pub system: u8,
    pub component: u8,
}

/// Makes a version 2 frame in `out`; `None` if it does not fit.
pub fn encode<'a>(
    header: Header,
    id: u32,
    extra_crc: u8,
    payload: &[u8],
    out: &'a mut [u8; MAX_FRAME],
) -> Option<&'a [u8]> {
    let [a, b, c, _] = id.to_le_bytes();
    let length = u8::try_from(payload.len()).ok()?;
    let head =
        [MAV_STX_V2, length, 0, 0, header.sequence, header.system, header.component, a, b, c];
    let end = head.len() + payload.len();
    for (to, from) in out.iter_mut().zip(head.iter().chain(payload)) {
        *to = *from;
    }
    let crc = calculate_crc(out.get(1..end)?, extra_crc).to_le_bytes();
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
        encode(header, 0, 50, &[0, 0, 0, 0, 6, 8, 0, 4, 3], &mut out).unwrap().to_vec()
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
            let mut next = parser.push(byte);
            while let Some(frame) = next {
                assert_eq!((frame.id, frame.system, frame.byte(4)), (0, 255, 6));
                count += 1;
                next = parser.pending();
            }
        }
        assert_eq!(count, 50);
        assert!(parser.garbage_bytes > 1000);
    }

    #[test]
    fn a_flipped_bit_is_never_accepted() {
        let good = heartbeat(7);
        for bit in 0..good.len() * 8 {
            let mut bad = good.clone();
            bad[bit / 8] ^= 1 << (bit % 8);
            let mut parser = Parser::new();
            let got: Vec<_> = bad.iter().filter_map(|&b| parser.push(b)).collect();
            assert!(got.is_empty(), "bit {bit}");
        }
    }
}
