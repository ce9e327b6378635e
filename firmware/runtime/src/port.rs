//! Bytes between an interrupt and a task, and the ports of the communications task.

use core::convert::Infallible;
use heapless::spsc::{Consumer, Producer};

/// A port that speaks MAVLink, as the communications task sees it.
pub trait Port {
    /// As much as has arrived, up to the length of `buffer`; the part that was filled.
    fn take<'b>(&mut self, buffer: &'b mut [u8]) -> &'b [u8];
    /// All of `frame` or nothing of it; whether it went. With nobody at the other end frames are left out.
    fn put(&mut self, frame: &[u8]) -> bool;
    /// What was put shall go.
    fn flush(&mut self);
}

/// A port that a board may lack.
impl<P: Port> Port for Option<P> {
    fn take<'b>(&mut self, buffer: &'b mut [u8]) -> &'b [u8] {
        match self {
            Some(port) => port.take(buffer),
            None => &[],
        }
    }
    fn put(&mut self, frame: &[u8]) -> bool {
        self.as_mut().is_some_and(|port| port.put(frame))
    }
    fn flush(&mut self) {
        if let Some(port) = self {
            port.flush();
        }
    }
}

/// Two queues and the interrupt at their other ends.
pub struct Queued {
    /// To the interrupt.
    pub out: Outward,
    /// From the interrupt.
    pub inward: Inward,
    /// Makes the interrupt look.
    pub pend: fn(),
}

impl Port for Queued {
    fn take<'b>(&mut self, buffer: &'b mut [u8]) -> &'b [u8] {
        self.inward.take(buffer)
    }
    fn put(&mut self, frame: &[u8]) -> bool {
        self.out.put(frame)
    }
    fn flush(&mut self) {
        (self.pend)();
    }
}

/// Where a task puts bytes.
pub struct Outward(pub Producer<'static, u8>);

impl Outward {
    /// For so many bytes.
    #[must_use]
    pub fn room(&self) -> usize {
        self.0.capacity() - self.0.len()
    }

    /// All of `bytes` or none of them; whether they went.
    pub fn put(&mut self, bytes: &[u8]) -> bool {
        if self.room() < bytes.len() {
            return false;
        }
        for &byte in bytes {
            let _ = self.0.enqueue(byte);
        }
        true
    }
}

/// Where a task gets what arrived.
pub struct Inward(pub Consumer<'static, u8>);

impl Inward {
    /// As much as there is, up to the length of `buffer`; the part that was filled.
    pub fn take<'b>(&mut self, buffer: &'b mut [u8]) -> &'b [u8] {
        let mut filled = 0;
        for slot in buffer.iter_mut() {
            let Some(byte) = self.0.dequeue() else { break };
            *slot = byte;
            filled += 1;
        }
        buffer.get(..filled).unwrap_or(&[])
    }
}

impl embedded_io::ErrorType for Inward {
    type Error = Infallible;
}

impl embedded_io::ReadReady for Inward {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        Ok(self.0.ready())
    }
}

impl embedded_io::Read for Inward {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Infallible> {
        Ok(self.take(buffer).len())
    }
}
