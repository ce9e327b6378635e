//! The rangefinder's UART: an interrupt per byte, read by a task.

use crate::bytes::OutOf;
use core::convert::Infallible;
use heapless::spsc::{Producer, Queue};
use stm32f4xx_hal::gpio::PC7;
use stm32f4xx_hal::pac::USART6;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::serial::{Rx, config::Config};

/// What the parts speak at.
const BAUD: u32 = 115_200;

/// Memory of the queue.
pub type Memory = Queue<u8, 64>;

/// The interrupt's side.
pub struct Listener {
    rx: Rx<USART6>,
    inward: Producer<'static, u8>,
}

/// The task's side.
pub struct RangePort(OutOf);

pub fn start(
    (usart, pin): (USART6, PC7),
    memory: &'static mut Memory,
    rcc: &mut Rcc,
) -> (Option<Listener>, RangePort) {
    let (inward, out_of) = memory.split();
    let listener = usart.rx(pin, Config::default().baudrate(BAUD.bps()), rcc).ok().map(|mut rx| {
        rx.listen();
        Listener { rx, inward }
    });
    (listener, RangePort(OutOf(out_of)))
}

impl Listener {
    /// The interrupt. A byte that finds no room is lost, and with it a frame.
    pub fn serve(&mut self) {
        while let Ok(byte) = self.rx.read() {
            let _ = self.inward.enqueue(byte);
        }
    }
}

impl embedded_io::ErrorType for RangePort {
    type Error = Infallible;
}

impl embedded_io::ReadReady for RangePort {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        Ok(self.0.0.ready())
    }
}

impl embedded_io::Read for RangePort {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Infallible> {
        Ok(self.0.take(buffer).len())
    }
}
