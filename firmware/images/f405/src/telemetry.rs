//! USART1, which speaks MAVLink: the same driver on a board and under emulation.

use core::convert::Into;
use stm32f4xx_hal::gpio::{PushPull, alt::usart1};
use stm32f4xx_hal::pac::{Interrupt, USART1};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::serial::{self, Instance, Rx, Serial, config::Config};
use tautline_runtime::port::Queued;
use tautline_runtime::serial::{Memory as Queues, Serial as Both, Transmit};

/// Bits per second.
const BAUD: u32 = 115_200;

/// Of the queues.
pub type Memory = Queues<1024, 512>;
/// The interrupt's side.
pub type Port = Both<Rx<USART1>, Tx<USART1>>;

/// The HAL's transmitter.
pub struct Tx<USART: Instance>(pub serial::Tx<USART>);

impl<USART: Instance> embedded_hal_nb::serial::ErrorType for Tx<USART> {
    type Error = serial::Error;
}

impl<USART: Instance> embedded_hal_nb::serial::Write for Tx<USART> {
    fn write(&mut self, byte: u8) -> nb::Result<(), Self::Error> {
        embedded_hal_nb::serial::Write::write(&mut self.0, byte)
    }
    fn flush(&mut self) -> nb::Result<(), Self::Error> {
        embedded_hal_nb::serial::Write::<u8>::flush(&mut self.0)
    }
}

impl<USART: Instance> Transmit for Tx<USART> {
    fn listen(&mut self, on: bool) {
        if on { self.0.listen() } else { self.0.unlisten() }
    }
}

/// Interrupt's and task's side.
pub fn start(
    usart: USART1,
    pins: (impl Into<usart1::Tx<PushPull>>, impl Into<usart1::Rx<PushPull>>),
    memory: &'static mut Memory,
    rcc: &mut Rcc,
) -> Option<(Port, Queued)> {
    let config = Config::default().baudrate(BAUD.bps());
    let serial: Serial<USART1> = Serial::new(usart, pins, config, rcc).ok()?;
    let (tx, mut rx) = serial.split();
    rx.listen();
    Some(Both::new(rx, Tx(tx), memory, || rtic::pend(Interrupt::USART1)))
}
