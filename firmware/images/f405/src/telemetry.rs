//! MAVLink over USART1: the same driver on a board and under emulation.
//!
//! One interrupt moves bytes both ways. Whoever puts bytes into the queue pends it; on a board the transmitter's
//! interrupt then asks for the next byte (QEMU's has none, and takes every byte at once).

use heapless::spsc::{Consumer, Producer, Queue};
use stm32f4xx_hal::pac::USART1;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::serial::{Rx, Serial, Tx, config};

use crate::bytes::{Into, OutOf};

/// Bits per second.
const BAUD: u32 = 115_200;
const OUT: usize = 1024;
const IN: usize = 512;

/// Memory of the queues.
pub struct Memory {
    out: Queue<u8, OUT>,
    inward: Queue<u8, IN>,
}

impl Memory {
    /// Empty.
    pub const fn new() -> Self {
        Self { out: Queue::new(), inward: Queue::new() }
    }
}

/// The interrupt's side.
pub struct Port {
    tx: Tx<USART1>,
    rx: Rx<USART1>,
    out: Consumer<'static, u8>,
    inward: Producer<'static, u8>,
}

/// Interrupt's and task's side.
pub fn start(
    usart: USART1,
    pins: (
        impl core::convert::Into<stm32f4xx_hal::gpio::alt::usart1::Tx<stm32f4xx_hal::gpio::PushPull>>,
        impl core::convert::Into<stm32f4xx_hal::gpio::alt::usart1::Rx<stm32f4xx_hal::gpio::PushPull>>,
    ),
    memory: &'static mut Memory,
    rcc: &mut Rcc,
) -> Option<(Port, Into, OutOf)> {
    let config = config::Config::default().baudrate(BAUD.bps());
    let serial: Serial<USART1> = Serial::new(usart, pins, config, rcc).ok()?;
    let (tx, mut rx) = serial.split();
    rx.listen();
    let (out, from_task) = memory.out.split();
    let (to_task, inward) = memory.inward.split();
    Some((Port { tx, rx, out: from_task, inward: to_task }, Into(out), OutOf(inward)))
}

impl Port {
    /// The interrupt.
    pub fn serve(&mut self) {
        // A byte that found the queue full, or came with an error, is lost; the parser finds the next frame.
        while let Ok(byte) = self.rx.read() {
            let _ = self.inward.enqueue(byte);
        }
        while self.tx.is_tx_empty() {
            let Some(byte) = self.out.dequeue() else {
                self.tx.unlisten();
                return;
            };
            let _ = self.tx.write(byte);
        }
        self.tx.listen();
    }
}
