//! The rangefinder's UART.

use heapless::spsc::Queue;
use stm32f4xx_hal::gpio::PC7;
use stm32f4xx_hal::pac::USART6;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::serial::{Rx, config::Config};
use tautline_runtime::port::Inward;
use tautline_runtime::serial;

/// What the parts speak at.
const BAUD: u32 = 115_200;

/// Memory of the queue.
pub type Memory = Queue<u8, 64>;
/// The interrupt's side.
pub type Listener = serial::Listener<Rx<USART6>>;

/// Interrupt's and task's side.
pub fn start(
    (usart, pin): (USART6, PC7),
    memory: &'static mut Memory,
    rcc: &mut Rcc,
) -> (Option<Listener>, Inward) {
    let (inward, out_of) = memory.split();
    let listener = usart.rx(pin, Config::default().baudrate(BAUD.bps()), rcc).ok().map(|mut rx| {
        rx.listen();
        Listener::new(rx, inward)
    });
    (listener, Inward(out_of))
}
