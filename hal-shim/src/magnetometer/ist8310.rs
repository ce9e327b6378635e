//! iSentek IST8310 over I2C: one measurement at a time, 0.3 µT per count.

use crate::registers::Registers;
use embedded_hal::delay::DelayNs;
use embedded_hal::i2c::I2c;

/// Registers.
#[allow(missing_docs)] // The names are the data sheet's.
pub mod register {
    pub const IDENTITY: u8 = 0x00;
    pub const STATUS: u8 = 0x02;
    pub const DATA: u8 = 0x03;
    pub const CONTROL_1: u8 = 0x0A;
    pub const CONTROL_2: u8 = 0x0B;
    pub const AVERAGE: u8 = 0x41;
    pub const PULSE: u8 = 0x42;
}
use register as reg;

/// The address that flight controllers wire.
pub const ADDRESS: u8 = 0x0E;
/// Of the part.
pub const IDENTITY: u8 = 0x10;
/// STATUS: a measurement is there.
pub const READY: u8 = 1 << 0;
/// CONTROL_1: measure once.
pub const SINGLE: u8 = 1;
/// CONTROL_2: back to the defaults.
pub const RESET: u8 = 1 << 0;
/// AVERAGE: 16 measurements per axis.
pub const AVERAGE_16: u8 = 0x24;
/// PULSE: as the data sheet wants it for low noise.
pub const PULSE_NORMAL: u8 = 0xC0;
/// Most that the part shows, counts.
pub const RANGE: i16 = 5_400;
/// Polls that wait for one measurement before it is asked for anew; polled every 10 ms, 50 ms.
pub const LATE_POLLS: u8 = 5;

/// What went wrong, with the evidence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Error<E> {
    /// The bus failed.
    Bus(E),
    /// Another part answers.
    Identity {
        /// What the identity register held.
        found: u8,
    },
    /// A measurement did not come; the next is asked for.
    Late,
    /// Beyond the range: a magnet or a heavy current is near.
    Saturated,
}

impl<E> From<E> for Error<E> {
    fn from(bus: E) -> Self {
        Self::Bus(bus)
    }
}

/// The driver.
#[derive(Debug)]
pub struct Ist8310<I2C> {
    part: Registers<I2C>,
    polls_without: u8,
}

impl<I2C: I2c> Ist8310<I2C> {
    /// Touches nothing yet; call [`Self::init`].
    pub fn new(i2c: I2C) -> Self {
        Self { part: Registers { i2c, address: ADDRESS }, polls_without: 0 }
    }

    /// Resets, identifies, configures and asks for a first measurement; takes 10 ms.
    ///
    /// # Errors
    /// [`Error`]; may be called again.
    pub fn init(&mut self, delay: &mut impl DelayNs) -> Result<(), Error<I2C::Error>> {
        self.part.write(reg::CONTROL_2, RESET)?;
        delay.delay_ms(10);
        let found = self.part.read(reg::IDENTITY)?;
        if found != IDENTITY {
            return Err(Error::Identity { found });
        }
        self.part.write(reg::AVERAGE, AVERAGE_16)?;
        self.part.write(reg::PULSE, PULSE_NORMAL)?;
        self.ask()?;
        Ok(())
    }

    /// x, y, z in a right-handed frame, if a measurement is there, and asks for the next. Call it every 10 ms.
    ///
    /// # Errors
    /// [`Error::Bus`], [`Error::Saturated`]; [`Error::Late`] once per [`LATE_POLLS`] without a measurement.
    pub fn poll(&mut self) -> Result<Option<[i16; 3]>, Error<I2C::Error>> {
        if self.part.read(reg::STATUS)? & READY == 0 {
            self.polls_without += 1;
            if self.polls_without < LATE_POLLS {
                return Ok(None);
            }
            self.ask()?;
            return Err(Error::Late);
        }
        let [x0, x1, y0, y1, z0, z1] = self.part.read_from(reg::DATA)?;
        self.ask()?;
        let [x, y, z] = [[x0, x1], [y0, y1], [z0, z1]].map(i16::from_le_bytes);
        if [x, y, z].iter().any(|n| n.unsigned_abs() >= RANGE.unsigned_abs()) {
            return Err(Error::Saturated);
        }
        // The part's own axes are left-handed.
        Ok(Some([x, y, -z]))
    }

    /// The bus, for its owner.
    pub fn bus_mut(&mut self) -> &mut I2C {
        &mut self.part.i2c
    }

    fn ask(&mut self) -> Result<(), I2C::Error> {
        self.polls_without = 0;
        self.part.write(reg::CONTROL_1, SINGLE)
    }
}
