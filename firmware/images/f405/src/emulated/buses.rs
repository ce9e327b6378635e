//! The bus traits, asked of the host.

use super::{bytes_of, host};
use core::convert::Infallible;
use core::sync::atomic::{AtomicU16, Ordering};
use embedded_hal::delay::DelayNs;
use embedded_hal::i2c::{self, I2c, NoAcknowledgeSource};
use embedded_hal::pwm::{self, SetDutyCycle};
use embedded_hal::spi::{self, SpiDevice};
use tautline_hal_shim::battery::AdcPin;
use tautline_hal_shim::motors::Protocol;
use tautline_runtime::wire::{OUTPUTS, Reply, Request};

/// Longest transaction on either bus.
const LONGEST: usize = 32;

/// The inertial sensor's.
#[derive(Debug)]
pub struct ImuBus;

impl spi::ErrorType for ImuBus {
    type Error = spi::ErrorKind;
}

impl SpiDevice for ImuBus {
    fn transaction(
        &mut self,
        operations: &mut [spi::Operation<'_, u8>],
    ) -> Result<(), Self::Error> {
        let mut out = heapless::Vec::<u8, LONGEST>::new();
        for operation in operations.iter() {
            let result = match operation {
                spi::Operation::Write(bytes) => out.extend_from_slice(bytes),
                spi::Operation::TransferInPlace(bytes) => out.extend_from_slice(bytes),
                spi::Operation::Transfer(_, bytes) => out.extend_from_slice(bytes),
                spi::Operation::Read(bytes) => out.resize(out.len() + bytes.len(), 0),
                spi::Operation::DelayNs(_) => Ok(()),
            };
            result.map_err(|_| spi::ErrorKind::Other)?;
        }
        host::request(&Request::Spi(&out), |reply| {
            let mut came = bytes_of(reply).ok_or(spi::ErrorKind::Other)?.iter().copied();
            for operation in operations.iter_mut() {
                match operation {
                    spi::Operation::Write(bytes) => came.by_ref().take(bytes.len()).for_each(drop),
                    spi::Operation::TransferInPlace(bytes)
                    | spi::Operation::Transfer(bytes, _)
                    | spi::Operation::Read(bytes) => {
                        for (slot, byte) in bytes.iter_mut().zip(came.by_ref()) {
                            *slot = byte;
                        }
                    }
                    spi::Operation::DelayNs(_) => {}
                }
            }
            Ok(())
        })
    }
}

/// The barometer's.
#[derive(Debug)]
pub struct SlowBus;

const SILENT: i2c::ErrorKind = i2c::ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address);

impl i2c::ErrorType for SlowBus {
    type Error = i2c::ErrorKind;
}

impl I2c for SlowBus {
    /// A write, a read, or a write and a read: what the drivers use.
    fn transaction(
        &mut self,
        address: u8,
        operations: &mut [i2c::Operation<'_>],
    ) -> Result<(), Self::Error> {
        let (write, read): (&[u8], &mut [u8]) = match operations {
            [i2c::Operation::Write(bytes)] => (bytes, &mut []),
            [i2c::Operation::Read(bytes)] => (&[], bytes),
            [i2c::Operation::Write(out), i2c::Operation::Read(into)] => (out, into),
            _ => return Err(i2c::ErrorKind::Other),
        };
        host::request(&Request::I2c { address, write, read: read.len() as u8 }, |reply| {
            let came = bytes_of(reply).ok_or(SILENT)?;
            for (slot, byte) in read.iter_mut().zip(came) {
                *slot = *byte;
            }
            Ok(())
        })
    }
}

/// The rangefinder's UART.
#[derive(Debug, Default)]
pub struct RangePort(heapless::Deque<u8, 64>);

impl embedded_io::ErrorType for RangePort {
    type Error = Infallible;
}

impl embedded_io::ReadReady for RangePort {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        if self.0.is_empty() {
            host::request(&Request::Range, |reply| {
                for byte in bytes_of(reply).unwrap_or(&[]) {
                    let _ = self.0.push_back(*byte);
                }
            });
        }
        Ok(!self.0.is_empty())
    }
}

impl embedded_io::Read for RangePort {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Infallible> {
        let mut filled = 0;
        for slot in buffer {
            let Some(byte) = self.0.pop_front() else { break };
            *slot = byte;
            filled += 1;
        }
        Ok(filled)
    }
}

/// The battery's pins.
#[derive(Debug)]
pub enum Pins {
    /// Behind the divider.
    Voltage,
    /// At the current sensor.
    Current,
}

impl AdcPin for Pins {
    type Error = Infallible;
    fn read_millivolts(&mut self) -> Result<u16, Infallible> {
        let (voltage, current) = host::request(&Request::Pins, |reply| match reply {
            Some(Reply::Pins(voltage, current)) => (voltage, current),
            _ => (0, 0),
        });
        Ok(match self {
            Self::Voltage => voltage,
            Self::Current => current,
        })
    }
}

static PULSES: [AtomicU16; OUTPUTS] = [const { AtomicU16::new(0) }; OUTPUTS];

/// The stop pulse as a share of the period.
static STOP: AtomicU16 = AtomicU16::new(0);

/// Sets the stop pulse of a protocol.
pub fn set_stop(protocol: Protocol) {
    let share = protocol.pulse_us(0.0) / protocol.period_us();
    STOP.store((share * f32::from(u16::MAX)) as u16, Ordering::Relaxed);
}

/// As [`set_stop`] said.
pub fn stop() -> u16 {
    STOP.load(Ordering::Relaxed)
}

/// One motor's channel; the last of the four sends them all.
#[derive(Debug)]
pub struct Motor(usize);

impl Motor {
    pub fn new(index: usize) -> Self {
        Self(index)
    }
}

impl pwm::ErrorType for Motor {
    type Error = Infallible;
}

impl SetDutyCycle for Motor {
    fn max_duty_cycle(&self) -> u16 {
        u16::MAX
    }
    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        if let Some(pulse) = PULSES.get(self.0) {
            pulse.store(duty, Ordering::Relaxed);
        }
        if self.0 + 1 == OUTPUTS {
            let pulses =
                core::array::from_fn(|i| PULSES.get(i).map_or(0, |p| p.load(Ordering::Relaxed)));
            host::post(&Request::Motors(pulses));
        }
        Ok(())
    }
}

/// Time passes at the host.
#[derive(Clone, Copy, Debug)]
pub struct Delay;

impl DelayNs for Delay {
    fn delay_ns(&mut self, ns: u32) {
        host::post(&Request::Delay(ns));
    }
}
