//! The interrupt's side of a UART: one interrupt moves bytes both ways.
//!
//! Whoever puts bytes into the queue pends it; the transmitter's interrupt then asks for the next byte. (QEMU's has
//! none, and takes every byte at once.)

use crate::port::{Inward, Outward, Queued};
use embedded_hal_nb::serial::{Read, Write};
use heapless::spsc::{Consumer, Producer, Queue};

/// A transmitter with an interrupt of its own.
pub trait Transmit: Write {
    /// Interrupt or not when there is room for a byte.
    fn listen(&mut self, on: bool);
}

/// Memory of the queues.
#[derive(Debug)]
pub struct Memory<const OUT: usize, const IN: usize> {
    out: Queue<u8, OUT>,
    inward: Queue<u8, IN>,
}

impl<const OUT: usize, const IN: usize> Memory<OUT, IN> {
    /// Empty.
    #[must_use]
    pub const fn new() -> Self {
        Self { out: Queue::new(), inward: Queue::new() }
    }
}

impl<const OUT: usize, const IN: usize> Default for Memory<OUT, IN> {
    fn default() -> Self {
        Self::new()
    }
}

/// Both ways.
pub struct Serial<RX, TX> {
    listener: Listener<RX>,
    tx: TX,
    out: Consumer<'static, u8>,
}

impl<RX: Read, TX: Transmit> Serial<RX, TX> {
    /// Interrupt's and task's side; `pend` pends the interrupt.
    pub fn new<const OUT: usize, const IN: usize>(
        rx: RX,
        tx: TX,
        memory: &'static mut Memory<OUT, IN>,
        pend: fn(),
    ) -> (Self, Queued) {
        let (out, from_task) = memory.out.split();
        let (inward, out_of) = memory.inward.split();
        let serial = Self { listener: Listener::new(rx, inward), tx, out: from_task };
        (serial, Queued { out: Outward(out), inward: Inward(out_of), pend })
    }

    /// The interrupt.
    pub fn serve(&mut self) {
        self.listener.serve();
        while let Some(&byte) = self.out.peek() {
            if self.tx.write(byte).is_err() {
                self.tx.listen(true);
                return;
            }
            let _ = self.out.dequeue();
        }
        self.tx.listen(false);
    }
}

/// One way: in.
pub struct Listener<RX> {
    rx: RX,
    inward: Producer<'static, u8>,
}

impl<RX: Read> Listener<RX> {
    /// Bytes from `rx` go to `inward`.
    pub fn new(rx: RX, inward: Producer<'static, u8>) -> Self {
        Self { rx, inward }
    }

    /// The interrupt. A byte that found the queue full, or came with an error, is lost; the parser finds the next
    /// frame.
    pub fn serve(&mut self) {
        while let Ok(byte) = self.rx.read() {
            let _ = self.inward.enqueue(byte);
        }
    }
}
