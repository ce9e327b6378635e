//! TDK ICM-42688-P over SPI.
//!
//! The crate `icm426xx` reads the FIFO; here the data registers are read in one burst at data-ready,
//! which is what a 1 kHz control loop wants, and the part's traps are handled: the adaptive full scale
//! that freezes the gyro near 100 °/s, the asynchronous-reset bit, and bank switching.

use embedded_hal::delay::DelayNs;
use embedded_hal::spi::SpiDevice;

/// Registers of bank 0, and of banks 1 and 2 for the anti-alias filter.
#[allow(missing_docs)] // The names are the data sheet's.
pub mod register {
    pub const DEVICE_CONFIG: u8 = 0x11;
    pub const INT_CONFIG: u8 = 0x14;
    pub const TEMP_DATA1: u8 = 0x1D;
    pub const INT_STATUS: u8 = 0x2D;
    pub const INTF_CONFIG1: u8 = 0x4D;
    pub const PWR_MGMT0: u8 = 0x4E;
    pub const GYRO_CONFIG0: u8 = 0x4F;
    pub const ACCEL_CONFIG0: u8 = 0x50;
    pub const GYRO_ACCEL_CONFIG0: u8 = 0x52;
    pub const INT_CONFIG0: u8 = 0x63;
    pub const INT_CONFIG1: u8 = 0x64;
    pub const INT_SOURCE0: u8 = 0x65;
    pub const WHO_AM_I: u8 = 0x75;
    pub const REG_BANK_SEL: u8 = 0x76;
    /// Bank 1.
    pub const GYRO_CONFIG_STATIC3: u8 = 0x0C;
    /// Bank 2.
    pub const ACCEL_CONFIG_STATIC2: u8 = 0x03;
    /// Set in the address byte of a read.
    pub const READ: u8 = 0x80;
}
use register as reg;

/// Identity in `WHO_AM_I`.
pub const IDENTITY: u8 = 0x47;
/// Data registers hold this until their sensor runs.
pub const INVALID: i16 = i16::MIN;
/// INT_STATUS: reset done.
pub const RESET_DONE: u8 = 1 << 4;
/// Both sensors in low-noise mode.
pub const LOW_NOISE: u8 = 0x0F;
/// INTF_CONFIG1 bits 7:6 = 01: adaptive full scale off.
pub const AFSR_OFF: u8 = 0x40;
/// The bits it changes.
pub const AFSR_MASK: u8 = 0xC0;

/// Gyro full scale; the value is the register's code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum GyroRange {
    /// ±2000 °/s.
    Dps2000 = 0,
    /// ±1000 °/s.
    Dps1000 = 1,
    /// ±500 °/s.
    Dps500 = 2,
    /// ±250 °/s.
    Dps250 = 3,
}

/// Accelerometer full scale; the value is the register's code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum AccelRange {
    /// ±16 g.
    G16 = 0,
    /// ±8 g.
    G8 = 1,
    /// ±4 g.
    G4 = 2,
    /// ±2 g.
    G2 = 3,
}

/// Output data rate; the value is the register's code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum DataRate {
    /// 4 kHz.
    Hz4000 = 4,
    /// 2 kHz.
    Hz2000 = 5,
    /// 1 kHz.
    Hz1000 = 6,
    /// 500 Hz.
    Hz500 = 15,
}

/// Set-up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Config {
    /// Gyro full scale.
    pub gyro: GyroRange,
    /// Accelerometer full scale.
    pub accel: AccelRange,
    /// Output data rate of both.
    pub rate: DataRate,
}

impl Default for Config {
    fn default() -> Self {
        Self { gyro: GyroRange::Dps2000, accel: AccelRange::G16, rate: DataRate::Hz1000 }
    }
}

/// What went wrong, with the evidence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Error<E> {
    /// The bus failed.
    Bus(E),
    /// Another part answers, or none.
    Identity {
        /// What `WHO_AM_I` held.
        found: u8,
    },
    /// The reset did not finish in time.
    Reset,
    /// A register did not keep what was written.
    Readback {
        /// Its address.
        register: u8,
        /// What it held.
        found: u8,
    },
}

/// One burst, sensor axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reading {
    /// Counts.
    pub accel: [i16; 3],
    /// Counts.
    pub gyro: [i16; 3],
    /// °C.
    pub temperature: f32,
}

/// The driver.
#[derive(Debug)]
pub struct Icm42688<SPI> {
    spi: SPI,
    config: Config,
}

impl<SPI: SpiDevice> Icm42688<SPI> {
    /// Touches nothing yet; call [`Self::init`].
    pub fn new(spi: SPI, config: Config) -> Self {
        Self { spi, config }
    }

    /// Resets, identifies and sets up the part; takes about 60 ms.
    ///
    /// # Errors
    /// [`Error`]; the part is then in an unknown state and `init` may be called again.
    pub fn init(&mut self, delay: &mut impl DelayNs) -> Result<(), Error<SPI::Error>> {
        self.bank(0)?;
        self.write(reg::DEVICE_CONFIG, 0x01)?;
        delay.delay_us(2_000);
        if self.read(reg::INT_STATUS)? & RESET_DONE == 0 {
            return Err(Error::Reset);
        }
        let found = self.read(reg::WHO_AM_I)?;
        if found != IDENTITY {
            return Err(Error::Identity { found });
        }
        let intf = self.read(reg::INTF_CONFIG1)?;
        self.write_checked(reg::INTF_CONFIG1, (intf & !AFSR_MASK) | AFSR_OFF)?;
        self.anti_alias_258hz()?;
        let rate = self.config.rate as u8;
        self.write_checked(reg::GYRO_CONFIG0, (self.config.gyro as u8) << 5 | rate)?;
        self.write_checked(reg::ACCEL_CONFIG0, (self.config.accel as u8) << 5 | rate)?;
        // Both UI filters at max(400 Hz, ODR/4).
        self.write(reg::GYRO_ACCEL_CONFIG0, 0x11)?;
        // Active high, push-pull, latched until the status is read.
        self.write(reg::INT_CONFIG, 0x07)?;
        self.write(reg::INT_CONFIG0, 0x00)?;
        let int1 = self.read(reg::INT_CONFIG1)?;
        self.write_checked(reg::INT_CONFIG1, int1 & !(1 << 4))?;
        self.write(reg::INT_SOURCE0, 1 << 3)?;
        self.write(reg::PWR_MGMT0, LOW_NOISE)?;
        delay.delay_us(300);
        // The gyro takes 30 ms to start.
        delay.delay_us(50_000);
        Ok(())
    }

    /// One burst of temperature, accelerometer and gyro.
    ///
    /// # Errors
    /// [`Error::Bus`].
    pub fn read_all(&mut self) -> Result<Reading, Error<SPI::Error>> {
        let mut bytes = [0_u8; 15];
        bytes[0] = reg::TEMP_DATA1 | reg::READ;
        self.spi.transfer_in_place(&mut bytes).map_err(Error::Bus)?;
        let [_, t1, t0, ax1, ax0, ay1, ay0, az1, az0, gx1, gx0, gy1, gy0, gz1, gz0] = bytes;
        let word = |high, low| i16::from_be_bytes([high, low]);
        Ok(Reading {
            accel: [word(ax1, ax0), word(ay1, ay0), word(az1, az0)],
            gyro: [word(gx1, gx0), word(gy1, gy0), word(gz1, gz0)],
            temperature: f32::from(word(t1, t0)) / 132.48 + 25.0,
        })
    }

    /// rad/s per count.
    #[must_use]
    pub fn gyro_scale(&self) -> f32 {
        gyro_full_scale(self.config.gyro as u8) / 32_768.0
    }

    /// m/s² per count.
    #[must_use]
    pub fn accel_scale(&self) -> f32 {
        accel_full_scale(self.config.accel as u8) / 32_768.0
    }

    /// The bus, for its owner.
    pub fn bus_mut(&mut self) -> &mut SPI {
        &mut self.spi
    }

    /// Cut-off 258 Hz: DELT 6, DELTSQR 36, BITSHIFT 10.
    fn anti_alias_258hz(&mut self) -> Result<(), Error<SPI::Error>> {
        self.bank(1)?;
        self.write(reg::GYRO_CONFIG_STATIC3, 6)?;
        self.write(reg::GYRO_CONFIG_STATIC3 + 1, 36)?;
        self.write(reg::GYRO_CONFIG_STATIC3 + 2, 10 << 4)?;
        self.bank(2)?;
        self.write(reg::ACCEL_CONFIG_STATIC2, 6 << 1)?;
        self.write(reg::ACCEL_CONFIG_STATIC2 + 1, 36)?;
        self.write(reg::ACCEL_CONFIG_STATIC2 + 2, 10 << 4)?;
        self.bank(0)
    }

    fn bank(&mut self, bank: u8) -> Result<(), Error<SPI::Error>> {
        self.write(reg::REG_BANK_SEL, bank)
    }

    fn write(&mut self, register: u8, value: u8) -> Result<(), Error<SPI::Error>> {
        self.spi.write(&[register, value]).map_err(Error::Bus)
    }

    fn write_checked(&mut self, register: u8, value: u8) -> Result<(), Error<SPI::Error>> {
        self.write(register, value)?;
        let found = self.read(register)?;
        if found == value { Ok(()) } else { Err(Error::Readback { register, found }) }
    }

    fn read(&mut self, register: u8) -> Result<u8, Error<SPI::Error>> {
        let mut bytes = [register | reg::READ, 0];
        self.spi.transfer_in_place(&mut bytes).map_err(Error::Bus)?;
        let [_, value] = bytes;
        Ok(value)
    }
}

/// Full scale of a gyro range code, rad/s.
#[must_use]
pub fn gyro_full_scale(code: u8) -> f32 {
    (2000.0 / f32::from(1_u16 << code.min(7))) * core::f32::consts::PI / 180.0
}

/// Full scale of an accelerometer range code, m/s² (standard gravity).
#[must_use]
pub fn accel_full_scale(code: u8) -> f32 {
    16.0 / f32::from(1_u16 << code.min(3)) * 9.806_65
}
