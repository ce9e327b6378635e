//! UARTs: telemetry and a pilot's receiver both ways, the rangefinder one way.

use embassy_stm32::mode::Blocking;
use embassy_stm32::pac::usart::Usart;
use embassy_stm32::usart::{self, UartRx, UartTx};
use tautline_runtime::serial::Transmit;

/// Bits per second.
const BAUD: u32 = 115_200;

pub fn config() -> usart::Config {
    at(BAUD)
}

/// At another rate, bits per second.
pub fn at(baud: u32) -> usart::Config {
    let mut config = usart::Config::default();
    config.baudrate = baud;
    config
}

/// The receiver interrupts when there is a byte.
pub fn listen(registers: Usart) {
    registers.cr1().modify(|w| w.set_rxneie(true));
}

/// A transmitter and the registers of its interrupt.
pub struct Tx {
    pub tx: UartTx<'static, Blocking>,
    pub registers: Usart,
}

/// A receiver.
pub type Rx = UartRx<'static, Blocking>;

impl embedded_hal_nb::serial::ErrorType for Tx {
    type Error = usart::Error;
}

impl embedded_hal_nb::serial::Write for Tx {
    fn write(&mut self, byte: u8) -> nb::Result<(), Self::Error> {
        embedded_hal_nb::serial::Write::write(&mut self.tx, byte)
    }
    fn flush(&mut self) -> nb::Result<(), Self::Error> {
        embedded_hal_nb::serial::Write::flush(&mut self.tx)
    }
}

impl Transmit for Tx {
    fn listen(&mut self, on: bool) {
        self.registers.cr1().modify(|w| w.set_txeie(on));
    }
}
