//! Infineon DPS310 and Goertek SPL06 over I2C: same registers, same identity.
//!
//! No kept crate speaks embedded-hal 1.0 for this family (`dps310` is at 0.2).

use crate::registers::Registers;
use embedded_hal::delay::DelayNs;
use embedded_hal::i2c::I2c;

/// Registers.
#[allow(missing_docs)] // The names are the data sheet's.
pub mod register {
    pub const PRESSURE: u8 = 0x00;
    pub const PRS_CFG: u8 = 0x06;
    pub const TMP_CFG: u8 = 0x07;
    pub const MEAS_CFG: u8 = 0x08;
    pub const CFG: u8 = 0x09;
    pub const RESET: u8 = 0x0C;
    pub const IDENTITY: u8 = 0x0D;
    pub const COEFFICIENTS: u8 = 0x10;
    pub const COEF_SRCE: u8 = 0x28;
}
use register as reg;

/// Identity of both parts.
pub const IDENTITY: u8 = 0x10;
/// Address with SDO low.
pub const ADDRESS: u8 = 0x76;
/// MEAS_CFG: the calibration can be read.
pub const COEF_READY: u8 = 1 << 7;
/// MEAS_CFG: start-up is over.
pub const SENSOR_READY: u8 = 1 << 6;
/// MEAS_CFG: a new temperature.
pub const TEMPERATURE_READY: u8 = 1 << 5;
/// MEAS_CFG: a new pressure.
pub const PRESSURE_READY: u8 = 1 << 4;
/// MEAS_CFG: continuous pressure and temperature.
pub const CONTINUOUS: u8 = 0x07;
/// PRS_CFG: 32 Hz, 8 times oversampled; with the temperature at 8 Hz single the part keeps up.
const PRS_32HZ_X8: u8 = 0x53;
/// TMP_CFG: 8 Hz, single; bit 7 chooses the external sensor.
const TMP_8HZ_X1: u8 = 0x30;
/// Raw full scale at 8 times oversampling.
pub const SCALE_X8: f32 = 7_864_320.0;
/// Raw full scale at single oversampling.
pub const SCALE_X1: f32 = 524_288.0;
/// Identity reads before giving up: the first may fail until the bus has toggled.
const IDENTITY_TRIES: u8 = 5;
/// Waits of 10 ms for the coefficients.
const READY_TRIES: u8 = 20;

/// What went wrong, with the evidence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Error<E> {
    /// The bus failed.
    Bus(E),
    /// Another part answers, or none.
    Identity {
        /// What the identity register held.
        found: u8,
    },
    /// Sensor or coefficients did not become ready.
    NotReady {
        /// What MEAS_CFG held.
        found: u8,
    },
}

impl<E> From<E> for Error<E> {
    fn from(bus: E) -> Self {
        Self::Bus(bus)
    }
}

/// Calibration, as stored in the part.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coefficients {
    /// Temperature: c0, c1.
    pub c: [f32; 2],
    /// Pressure: c00, c10, c20, c30.
    pub p: [f32; 4],
    /// Cross terms: c01, c11, c21.
    pub t: [f32; 3],
}

/// One compensated reading.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reading {
    /// Pa.
    pub pressure: f32,
    /// °C.
    pub temperature: f32,
}

impl Coefficients {
    /// From the 18 bytes at 0x10.
    #[must_use]
    pub fn from_bytes(b: &[u8; 18]) -> Self {
        let [b0, b1, b2, b3, b4, b5, b6, b7, rest @ ..] = *b;
        let bits = |value: u32, width: u32| ((value << (32 - width)) as i32 >> (32 - width)) as f32;
        let wide = |a: u8, b: u8| (u32::from(a) << 8) | u32::from(b);
        let [c01, c01b, c11, c11b, c20, c20b, c21, c21b, c30, c30b] = rest;
        let word = |a, b| f32::from(i16::from_be_bytes([a, b]));
        Self {
            c: [bits((u32::from(b0) << 4) | u32::from(b1 >> 4), 12), bits(wide(b1 & 0x0F, b2), 12)],
            p: [
                bits((wide(b3, b4) << 4) | u32::from(b5 >> 4), 20),
                bits((u32::from(b5 & 0x0F) << 16) | wide(b6, b7), 20),
                word(c20, c20b),
                word(c30, c30b),
            ],
            t: [word(c01, c01b), word(c11, c11b), word(c21, c21b)],
        }
    }

    /// Pa and °C from scaled raw values `p = Praw/kP`, `t = Traw/kT`.
    #[must_use]
    pub fn compensate(&self, p: f32, t: f32) -> Reading {
        let ([c0, c1], [c00, c10, c20, c30], [c01, c11, c21]) = (self.c, self.p, self.t);
        Reading {
            pressure: c00 + p * (c10 + p * (c20 + p * c30)) + t * c01 + t * p * (c11 + p * c21),
            temperature: c0 * 0.5 + c1 * t,
        }
    }
}

/// The driver.
#[derive(Debug)]
pub struct Dps310<I2C> {
    part: Registers<I2C>,
    coefficients: Coefficients,
    temperature_raw: f32,
}

impl<I2C: I2c> Dps310<I2C> {
    /// Touches nothing yet; call [`Self::init`].
    pub fn new(i2c: I2C, address: u8) -> Self {
        let part = Registers { i2c, address };
        Self { part, coefficients: Coefficients::default(), temperature_raw: 0.0 }
    }

    /// Resets, identifies, reads the calibration and starts; takes 40 to 240 ms.
    ///
    /// # Errors
    /// [`Error`]; `init` may be called again.
    pub fn init(&mut self, delay: &mut impl DelayNs) -> Result<(), Error<I2C::Error>> {
        self.part.write(reg::RESET, 0x09)?;
        delay.delay_us(40_000);
        let mut found = 0;
        for _ in 0..IDENTITY_TRIES {
            found = self.part.read(reg::IDENTITY)?;
            if found == IDENTITY {
                break;
            }
            delay.delay_us(1_000);
        }
        if found != IDENTITY {
            return Err(Error::Identity { found });
        }
        let ready = COEF_READY | SENSOR_READY;
        let mut state = self.part.read(reg::MEAS_CFG)?;
        for _ in 0..READY_TRIES {
            if state & ready == ready {
                break;
            }
            delay.delay_us(10_000);
            state = self.part.read(reg::MEAS_CFG)?;
        }
        if state & ready != ready {
            return Err(Error::NotReady { found: state });
        }
        let bytes = self.part.read_from(reg::COEFFICIENTS)?;
        self.coefficients = Coefficients::from_bytes(&bytes);
        // The coefficients belong to one of two temperature sensors; use that one.
        let source = self.part.read(reg::COEF_SRCE)? & 0x80;
        self.part.write(reg::PRS_CFG, PRS_32HZ_X8)?;
        self.part.write(reg::TMP_CFG, TMP_8HZ_X1 | source)?;
        self.part.write(reg::CFG, 0)?;
        self.temperature_fix()?;
        self.part.write(reg::MEAS_CFG, CONTINUOUS)?;
        Ok(())
    }

    /// A reading if a new pressure is there. Call it at 32 Hz or faster.
    ///
    /// # Errors
    /// [`Error::Bus`].
    pub fn poll(&mut self) -> Result<Option<Reading>, Error<I2C::Error>> {
        let state = self.part.read(reg::MEAS_CFG)?;
        if state & PRESSURE_READY == 0 {
            return Ok(None);
        }
        let [p2, p1, p0, t2, t1, t0] = self.part.read_from(reg::PRESSURE)?;
        let raw = |a, b, c| (i32::from_be_bytes([a, b, c, 0]) >> 8) as f32;
        self.temperature_raw = raw(t2, t1, t0);
        let (p, t) = (raw(p2, p1, p0) / SCALE_X8, self.temperature_raw / SCALE_X1);
        Ok(Some(self.coefficients.compensate(p, t)))
    }

    /// The bus, for its owner.
    pub fn bus_mut(&mut self) -> &mut I2C {
        &mut self.part.i2c
    }

    /// Some DPS310 read 60 °C after reset without this sequence (known from their drivers).
    fn temperature_fix(&mut self) -> Result<(), Error<I2C::Error>> {
        for (register, value) in
            [(0x0E, 0xA5), (0x0F, 0x96), (0x62, 0x02), (0x0E, 0x00), (0x0F, 0x00)]
        {
            self.part.write(register, value)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Issue 30 of Infineon's driver gives these coefficients and raw values.
    #[test]
    fn the_published_example_comes_out() {
        let k = Coefficients {
            c: [222.0, -297.0],
            p: [79832.0, -56308.0, -9701.0, -1289.0],
            t: [-2295.0, 1444.0, 111.0],
        };
        let x16 = 253_952.0;
        let got = k.compensate(-108_202.0 / x16, 73_535.0 / x16);
        assert!((got.temperature - 25.0).abs() < 0.01, "{got:?}");
        assert!((got.pressure - 101_325.0).abs() < 2.0, "{got:?}");
    }
}
