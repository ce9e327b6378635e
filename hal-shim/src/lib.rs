//! Drivers and actuator outputs over embedded-hal 1.0: the only place where registers are known.
//!
//! | module | part | bus |
//! |---|---|---|
//! | [`imu::icm42688`] | TDK ICM-42688-P | SPI |
//! | [`barometer::dps310`] | Infineon DPS310, Goertek SPL06 | I2C |
//! | [`rangefinder::tfmini`] | Benewake TFmini-S / Plus | UART (embedded-io) |
//! | [`radio::crsf`] | receivers that speak CRSF: ExpressLRS, Crossfire | UART (embedded-io), both ways |
//! | [`radio::sbus`] | receivers that speak SBUS | UART (embedded-io) |
//! | [`encoder::as5600`] | ams AS5600, AS5600L | I2C |
//! | [`load_cell::nau7802`] | Nuvoton NAU7802 | I2C |
//! | [`magnetometer::ist8310`] | iSentek IST8310 | I2C |
//! | [`motors`] | ESCs by 400 Hz PWM or OneShot125 | `SetDutyCycle` |
//! | [`parameters`] | flash of the microcontroller | `NorFlash` (embedded-storage) |
//! | [`battery`] | voltage and current pins | [`battery::AdcPin`] |
//!
//! With the feature `fake`, [`fake`] holds a register-level fake of each: what the simulator plugs in,
//! so that it runs these very drivers. Drivers never wait for themselves except in `init`.

#![cfg_attr(not(any(test, feature = "fake")), no_std)]
#![forbid(unsafe_code)]

pub mod barometer;
pub mod battery;
pub mod encoder;
#[cfg(any(test, feature = "fake"))]
pub mod fake;
pub mod imu;
pub mod load_cell;
pub mod magnetometer;
pub mod motors;
pub mod parameters;
pub mod radio;
pub mod rangefinder;
mod registers;
