//! Fake AS5600 behind I2C.
//!
//! Traps reproduced: the pointer stays on the two bytes of the angle; without a magnet there is an angle all the same.

use super::registers::{RegisterPart, on_i2c};
use crate::encoder::as5600::{ADDRESS, COUNTS, MAGNET, STRONG, WEAK, register as reg};

/// How well the part sees its magnet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Magnet {
    /// As it should.
    #[default]
    Good,
    /// Too far.
    Weak,
    /// Too near.
    Strong,
    /// It fell off.
    Gone,
}

/// The part.
#[derive(Debug)]
pub struct FakeAs5600 {
    address: u8,
    configuration: [u8; 2],
    counts: u16,
    /// The magnet over it.
    pub magnet: Magnet,
    /// No answer on the bus.
    pub is_dead: bool,
}

impl Default for FakeAs5600 {
    fn default() -> Self {
        Self::new(ADDRESS)
    }
}

impl FakeAs5600 {
    /// Just powered up.
    #[must_use]
    pub fn new(address: u8) -> Self {
        let magnet = Magnet::Good;
        Self { address, configuration: [0; 2], counts: 0, magnet, is_dead: false }
    }

    /// The truth, rad.
    pub fn set_angle(&mut self, angle: f64) {
        let turns = (angle / std::f64::consts::TAU).rem_euclid(1.0);
        self.counts = (turns * f64::from(COUNTS)).round() as u16 % COUNTS;
    }
}

impl RegisterPart for FakeAs5600 {
    fn answers(&self, address: u8) -> bool {
        address == self.address && !self.is_dead
    }

    fn read(&mut self, register: u8) -> u8 {
        let [conf_high, conf_low] = self.configuration;
        let counts = if self.magnet == Magnet::Gone { 0x0A55 } else { self.counts };
        let [high, low] = counts.to_be_bytes();
        match register {
            reg::CONF_HIGH => conf_high,
            reg::CONF_LOW => conf_low,
            reg::STATUS => match self.magnet {
                Magnet::Good => MAGNET,
                Magnet::Weak => MAGNET | WEAK,
                Magnet::Strong => MAGNET | STRONG,
                Magnet::Gone => WEAK,
            },
            reg::RAW_ANGLE => high,
            _ if register == reg::RAW_ANGLE + 1 => low,
            _ => 0,
        }
    }

    fn write(&mut self, register: u8, value: u8) {
        let [high, low] = &mut self.configuration;
        match register {
            reg::CONF_HIGH => *high = value & 0x3F,
            reg::CONF_LOW => *low = value,
            _ => {}
        }
    }

    fn next(&self, register: u8) -> u8 {
        if register == reg::RAW_ANGLE + 1 { reg::RAW_ANGLE } else { register.wrapping_add(1) }
    }
}

on_i2c!(FakeAs5600);
