//! Nuvoton NAU7802 over I2C: a bridge of strain gauges at 24 bits, 80 times a second.

use crate::registers::Registers;
use embedded_hal::delay::DelayNs;
use embedded_hal::i2c::I2c;

/// Registers.
#[allow(missing_docs)] // The names are the data sheet's.
pub mod register {
    pub const PU_CTRL: u8 = 0x00;
    pub const CTRL1: u8 = 0x01;
    pub const CTRL2: u8 = 0x02;
    pub const ADCO: u8 = 0x12;
    pub const ADC: u8 = 0x15;
    pub const PGA_PWR: u8 = 0x1C;
    pub const REVISION: u8 = 0x1F;
}
use register as reg;

/// The only address.
pub const ADDRESS: u8 = 0x2A;
/// Low half of REVISION.
pub const REVISION: u8 = 0x0F;
/// PU_CTRL: all registers to their defaults while set.
pub const RESET: u8 = 1 << 0;
/// PU_CTRL: digital part on.
pub const DIGITAL_ON: u8 = 1 << 1;
/// PU_CTRL: analogue part on.
pub const ANALOGUE_ON: u8 = 1 << 2;
/// PU_CTRL: power is up.
pub const POWER_READY: u8 = 1 << 3;
/// PU_CTRL: conversions run.
pub const CYCLE_START: u8 = 1 << 4;
/// PU_CTRL: a new conversion.
pub const CYCLE_READY: u8 = 1 << 5;
/// PU_CTRL: the bridge is fed by the part's own regulator.
pub const REGULATOR: u8 = 1 << 7;
/// CTRL1: 3.3 V to the bridge, gain 128: ±12.9 mV at full scale.
pub const GAIN_128_AT_3V3: u8 = (0b100 << 3) | 0b111;
/// CTRL2: 80 conversions a second.
pub const RATE_80: u8 = 0b011 << 4;
/// CTRL2: find the own offset, inputs shorted inside; clears itself.
pub const CALIBRATE: u8 = 1 << 2;
/// CTRL2: that failed.
pub const CALIBRATION_FAILED: u8 = 1 << 3;
/// ADC: chopper clock off, as the data sheet asks for.
pub const CHOPPER_OFF: u8 = 0x30;
/// PGA_PWR: capacitor across the second channel's pins.
pub const CAPACITOR: u8 = 1 << 7;
/// Most that the converter shows.
pub const FULL_SCALE: i32 = 0x7F_FFFF;
/// Waits of 1 ms for the power.
const POWER_TRIES: u8 = 50;
/// Waits of 10 ms for the calibration, which takes about 350 ms at this rate.
const CALIBRATION_TRIES: u8 = 100;
/// Polls without a conversion before the part counts as silent; polled every 5 ms, a tenth of a second.
pub const SILENT_POLLS: u8 = 20;

/// What went wrong, with the evidence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Error<E> {
    /// The bus failed.
    Bus(E),
    /// Another part answers.
    Identity {
        /// What REVISION held.
        found: u8,
    },
    /// Power or calibration did not come to an end in time.
    NotReady {
        /// What PU_CTRL or CTRL2 held.
        found: u8,
    },
    /// The part does not find its own offset: its supply is bad.
    Calibration,
    /// The bridge is beyond what the converter shows: overloaded, or a wire is off.
    Saturated,
    /// It answers and does not convert: [`Nau7802::init`] again.
    Silent,
}

impl<E> From<E> for Error<E> {
    fn from(bus: E) -> Self {
        Self::Bus(bus)
    }
}

/// The driver.
#[derive(Debug)]
pub struct Nau7802<I2C> {
    part: Registers<I2C>,
    polls_without: u8,
}

impl<I2C: I2c> Nau7802<I2C> {
    /// Touches nothing yet; call [`Self::init`].
    pub fn new(i2c: I2C) -> Self {
        Self { part: Registers { i2c, address: ADDRESS }, polls_without: 0 }
    }

    /// Resets, identifies, finds its own offset and starts; takes about 0.6 s, and 1.3 s at most.
    ///
    /// # Errors
    /// [`Error`]; may be called again.
    pub fn init(&mut self, delay: &mut impl DelayNs) -> Result<(), Error<I2C::Error>> {
        self.part.write(reg::PU_CTRL, RESET)?;
        delay.delay_ms(1);
        self.part.write(reg::PU_CTRL, DIGITAL_ON)?;
        self.wait(delay, POWER_TRIES, 1, reg::PU_CTRL, |found| found & POWER_READY != 0)?;
        let found = self.part.read(reg::REVISION)?;
        if found & 0x0F != REVISION {
            return Err(Error::Identity { found });
        }
        let on = DIGITAL_ON | ANALOGUE_ON | REGULATOR;
        for (register, value) in [
            (reg::PU_CTRL, on),
            (reg::CTRL1, GAIN_128_AT_3V3),
            (reg::CTRL2, RATE_80),
            (reg::ADC, CHOPPER_OFF),
            (reg::PGA_PWR, CAPACITOR),
        ] {
            self.part.write(register, value)?;
        }
        // The regulator settles.
        delay.delay_ms(200);
        self.part.write(reg::CTRL2, RATE_80 | CALIBRATE)?;
        let is_done = |found| found & CALIBRATE == 0;
        let found = self.wait(delay, CALIBRATION_TRIES, 10, reg::CTRL2, is_done)?;
        if found & CALIBRATION_FAILED != 0 {
            return Err(Error::Calibration);
        }
        self.polls_without = 0;
        self.part.write(reg::PU_CTRL, on | CYCLE_START)?;
        Ok(())
    }

    /// Counts if a new conversion is there. Call it every 5 ms.
    ///
    /// # Errors
    /// [`Error::Bus`], [`Error::Saturated`]; [`Error::Silent`] once per [`SILENT_POLLS`] without a conversion.
    pub fn poll(&mut self) -> Result<Option<i32>, Error<I2C::Error>> {
        if self.part.read(reg::PU_CTRL)? & CYCLE_READY == 0 {
            self.polls_without += 1;
            if self.polls_without < SILENT_POLLS {
                return Ok(None);
            }
            self.polls_without = 0;
            return Err(Error::Silent);
        }
        self.polls_without = 0;
        let [high, middle, low] = self.part.read_from(reg::ADCO)?;
        let counts = i32::from_be_bytes([high, middle, low, 0]) >> 8;
        if counts >= FULL_SCALE || counts <= -FULL_SCALE {
            return Err(Error::Saturated);
        }
        Ok(Some(counts))
    }

    /// The bus, for its owner.
    pub fn bus_mut(&mut self) -> &mut I2C {
        &mut self.part.i2c
    }

    /// What `register` holds once it `is_done`.
    fn wait(
        &mut self,
        delay: &mut impl DelayNs,
        tries: u8,
        pause_ms: u32,
        register: u8,
        is_done: impl Fn(u8) -> bool,
    ) -> Result<u8, Error<I2C::Error>> {
        let mut found = self.part.read(register)?;
        for _ in 0..tries {
            if is_done(found) {
                return Ok(found);
            }
            delay.delay_ms(pause_ms);
            found = self.part.read(register)?;
        }
        Err(Error::NotReady { found })
    }
}
