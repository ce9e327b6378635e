//! The pilot's receiver: USART2, both ways.

use stm32f4xx_hal::gpio::{PA2, PA3};
use stm32f4xx_hal::pac::{Interrupt, USART2};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::serial::{Rx, Serial, config::Config};
use tautline_hal_shim::radio::crsf::BAUD;
use tautline_runtime::port::Queued;
use tautline_runtime::serial::{Memory as Queues, Serial as Both};

use crate::telemetry::Tx;

/// Of the queues: a frame out, and six milliseconds in.
pub type Memory = Queues<128, 256>;
/// The interrupt's side.
pub type Port = Both<Rx<USART2>, Tx<USART2>>;

/// Interrupt's and task's side.
pub fn start(
    (usart, tx, rx): (USART2, PA2, PA3),
    memory: &'static mut Memory,
    rcc: &mut Rcc,
) -> Option<(Port, Queued)> {
    let config = Config::default().baudrate(BAUD.bps());
    let serial: Serial<USART2> = Serial::new(usart, (tx, rx), config, rcc).ok()?;
    let (tx, mut rx) = serial.split();
    rx.listen();
    Some(Both::new(rx, Tx(tx), memory, || rtic::pend(Interrupt::USART2)))
}
