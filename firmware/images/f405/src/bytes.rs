//! Bytes between an interrupt and a task.

use heapless::spsc::{Consumer, Producer};

/// Where a task puts frames.
pub struct Into(pub Producer<'static, u8>);

impl Into {
    /// All of `bytes` or none of them; whether they went.
    pub fn put(&mut self, bytes: &[u8]) -> bool {
        if self.0.capacity() - self.0.len() < bytes.len() {
            return false;
        }
        for &byte in bytes {
            let _ = self.0.enqueue(byte);
        }
        true
    }
}

/// Where a task gets what arrived.
pub struct OutOf(pub Consumer<'static, u8>);

impl OutOf {
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
