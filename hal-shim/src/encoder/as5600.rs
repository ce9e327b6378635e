//! ams AS5600 and AS5600L over I2C: the angle of a magnet over the part, 12 bits per turn.
//!
//! The part has no identity register and never says that an angle is new. What answers is taken for it if its status
//! has no bit set that the part does not have, and if the configuration reads back as written.

use crate::registers::Registers;
use embedded_hal::i2c::I2c;

/// Registers.
#[allow(missing_docs)] // The names are the data sheet's.
pub mod register {
    pub const CONF_HIGH: u8 = 0x07;
    pub const CONF_LOW: u8 = 0x08;
    pub const STATUS: u8 = 0x0B;
    pub const RAW_ANGLE: u8 = 0x0C;
}
use register as reg;

/// Address of an AS5600.
pub const ADDRESS: u8 = 0x36;
/// Address of an AS5600L: the way to have two on a bus.
pub const ADDRESS_L: u8 = 0x40;
/// STATUS: a magnet is there.
pub const MAGNET: u8 = 1 << 5;
/// STATUS: it is too weak.
pub const WEAK: u8 = 1 << 4;
/// STATUS: it is too strong.
pub const STRONG: u8 = 1 << 3;
/// CONF: always on, one count of hysteresis; filter of 0.29 ms that lets steps of 6 counts through at once, as a line that
/// jerks needs; no watchdog, which would make a line at rest slow.
pub const CONFIGURATION: [u8; 2] = [0b0000_0111, 0b0000_0100];
/// Counts per turn.
pub const COUNTS: u16 = 4096;

/// What went wrong, with the evidence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Error<E> {
    /// The bus failed.
    Bus(E),
    /// Another part answers.
    Identity {
        /// What STATUS and CONF held.
        found: [u8; 3],
    },
}

impl<E> From<E> for Error<E> {
    fn from(bus: E) -> Self {
        Self::Bus(bus)
    }
}

/// The driver.
#[derive(Debug)]
pub struct As5600<I2C> {
    part: Registers<I2C>,
}

impl<I2C: I2c> As5600<I2C> {
    /// Touches nothing yet; call [`Self::init`].
    pub fn new(i2c: I2C, address: u8) -> Self {
        Self { part: Registers { i2c, address } }
    }

    /// Configures and checks that it is the part; no wait.
    ///
    /// # Errors
    /// [`Error`]; may be called again.
    pub fn init(&mut self) -> Result<(), Error<I2C::Error>> {
        let [high, low] = CONFIGURATION;
        self.part.write(reg::CONF_HIGH, high)?;
        self.part.write(reg::CONF_LOW, low)?;
        let [high, low] = self.part.read_from(reg::CONF_HIGH)?;
        let status = self.part.read(reg::STATUS)?;
        if [high, low] != CONFIGURATION || status & !(MAGNET | WEAK | STRONG) != 0 {
            return Err(Error::Identity { found: [status, high, low] });
        }
        Ok(())
    }

    /// Angle now, 0 to 4095; `None`: no magnet, or one too weak or too strong to trust.
    ///
    /// # Errors
    /// [`Error::Bus`].
    pub fn poll(&mut self) -> Result<Option<u16>, Error<I2C::Error>> {
        let status = self.part.read(reg::STATUS)?;
        if status & (MAGNET | WEAK | STRONG) != MAGNET {
            return Ok(None);
        }
        let counts = u16::from_be_bytes(self.part.read_from(reg::RAW_ANGLE)?);
        // A bus that floats high is no angle.
        Ok((counts < COUNTS).then_some(counts))
    }

    /// The bus, for its owner.
    pub fn bus_mut(&mut self) -> &mut I2C {
        &mut self.part.i2c
    }
}
