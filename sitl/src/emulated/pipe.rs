//! The two FIFOs, and what went through them.

use std::fs::File;
use std::io::{self, Read, Write};
use tautline_runtime::wire::{Reply, Request};

/// Frames with their length in front.
#[derive(Debug)]
pub struct Pipe {
    requests: File,
    reply: File,
    buffer: Vec<u8>,
    /// FNV-1a over every byte in both directions.
    digest: u64,
    /// Messages from the board.
    pub received: u64,
}

const BASIS: u64 = 0xCBF2_9CE4_8422_2325;
const PRIME: u64 = 0x100_0000_01B3;

impl Pipe {
    /// Over open ends.
    #[must_use]
    pub fn new(requests: File, reply: File) -> Self {
        Self { requests, reply, buffer: Vec::new(), digest: BASIS, received: 0 }
    }

    /// Of everything so far: two equal runs have equal digests.
    #[must_use]
    pub fn digest(&self) -> u64 {
        self.digest
    }

    fn mix(&mut self, bytes: &[u8]) {
        self.digest =
            bytes.iter().fold(self.digest, |sum, &b| (sum ^ u64::from(b)).wrapping_mul(PRIME));
    }

    /// The next message; waits for it.
    ///
    /// # Errors
    /// When the board has gone or sends something that is no message.
    pub fn receive(&mut self) -> io::Result<Vec<u8>> {
        let mut head = [0; 2];
        self.requests.read_exact(&mut head)?;
        let mut message = vec![0; usize::from(u16::from_le_bytes(head))];
        self.requests.read_exact(&mut message)?;
        self.mix(&message);
        self.received += 1;
        Ok(message)
    }

    /// Answers.
    ///
    /// # Errors
    /// When the board has gone.
    pub fn reply(&mut self, reply: &Reply) -> io::Result<()> {
        let mut body = [0; tautline_runtime::wire::MAX_MESSAGE];
        let message = postcard::to_slice(reply, &mut body).map_err(io::Error::other)?;
        let length = message.len() as u16;
        self.buffer.clear();
        self.buffer.extend_from_slice(&length.to_le_bytes());
        self.buffer.extend_from_slice(message);
        self.reply.write_all(&self.buffer)?;
        let sent = std::mem::take(&mut self.buffer);
        self.mix(&sent);
        self.buffer = sent;
        Ok(())
    }
}

/// The message in these bytes.
///
/// # Errors
/// When there is none.
pub fn decode(message: &[u8]) -> io::Result<Request<'_>> {
    postcard::from_bytes(message).map_err(io::Error::other)
}
