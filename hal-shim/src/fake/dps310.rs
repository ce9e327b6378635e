//! Fake DPS310 behind I2C.
//!
//! Traps reproduced: the first identity read after power-up fails; coefficients and sensor become ready
//! 40 ms after a reset; a reading stays the same until its conversion is due.

use super::FakeClock;
use super::registers::{RegisterPart, on_i2c};
use crate::barometer::dps310::{
    ADDRESS, COEF_READY, CONTINUOUS, Coefficients, IDENTITY, PRESSURE_READY, SCALE_X1, SCALE_X8,
    SENSOR_READY, TEMPERATURE_READY, register as reg,
};

const READY_US: u64 = 40_000;
const PRESSURE_PERIOD_US: u64 = 31_250;
/// The calibration of a real part: c0, c1, c00, c10, c01, c11, c20, c21, c30.
const CALIBRATION: [i32; 9] = [222, -297, 79_832, -56_308, -2_295, 1_444, -9_701, 111, -1_289];

/// The part.
#[derive(Debug)]
pub struct FakeDps310 {
    clock: FakeClock,
    registers: [u8; 128],
    coefficients: Coefficients,
    reset_at: u64,
    converted_at: u64,
    has_new: bool,
    identity_reads: u32,
    pressure: f64,
    temperature: f64,
    /// No answer on the bus.
    pub is_dead: bool,
}

impl FakeDps310 {
    /// Just powered up.
    #[must_use]
    pub fn new(clock: FakeClock) -> Self {
        let bytes = calibration_bytes();
        let mut part = Self {
            clock,
            registers: [0; 128],
            coefficients: Coefficients::from_bytes(&bytes),
            reset_at: 0,
            converted_at: 0,
            has_new: false,
            identity_reads: 0,
            pressure: 101_325.0,
            temperature: 25.0,
            is_dead: false,
        };
        for (slot, byte) in
            part.registers.iter_mut().skip(usize::from(reg::COEFFICIENTS)).zip(bytes)
        {
            *slot = byte;
        }
        part.put(reg::IDENTITY, IDENTITY);
        part.put(reg::COEF_SRCE, 0x80);
        part
    }

    /// The truth: Pa and °C. Call it often; the part takes a sample when a conversion is due.
    pub fn set_air(&mut self, pressure: f64, temperature: f64) {
        (self.pressure, self.temperature) = (pressure, temperature);
        let now = self.clock.now_us();
        let runs = self.get(reg::MEAS_CFG) & CONTINUOUS == CONTINUOUS;
        if runs && now >= self.converted_at + PRESSURE_PERIOD_US {
            self.converted_at = now;
            self.convert();
        }
    }

    fn convert(&mut self) {
        let k = &self.coefficients;
        let [c0, c1] = k.c;
        let t = (self.temperature as f32 - c0 * 0.5) / c1;
        // The pressure falls with the raw value: halve the bracket until it is one count wide.
        let (mut low, mut high) = (-8_388_608_i32, 8_388_607_i32);
        while high - low > 1 {
            let middle = low.midpoint(high);
            if f64::from(k.compensate(middle as f32 / SCALE_X8, t).pressure) > self.pressure {
                low = middle;
            } else {
                high = middle;
            }
        }
        let [_, p2, p1, p0] = low.to_be_bytes();
        let [_, t2, t1, t0] = ((t * SCALE_X1).round() as i32).to_be_bytes();
        for (slot, byte) in self.registers.iter_mut().zip([p2, p1, p0, t2, t1, t0]) {
            *slot = byte;
        }
        self.has_new = true;
    }

    fn get(&self, register: u8) -> u8 {
        self.registers.get(usize::from(register)).copied().unwrap_or(0)
    }

    fn put(&mut self, register: u8, value: u8) {
        if let Some(slot) = self.registers.get_mut(usize::from(register)) {
            *slot = value;
        }
    }
}

impl RegisterPart for FakeDps310 {
    fn answers(&self, address: u8) -> bool {
        address == ADDRESS && !self.is_dead
    }

    fn read(&mut self, register: u8) -> u8 {
        match register {
            reg::IDENTITY => {
                self.identity_reads += 1;
                if self.identity_reads == 1 { 0 } else { self.get(register) }
            }
            reg::MEAS_CFG => {
                let mut status = self.get(register) & CONTINUOUS;
                if self.clock.now_us() >= self.reset_at + READY_US {
                    status |= COEF_READY | SENSOR_READY;
                }
                if self.has_new {
                    status |= PRESSURE_READY | TEMPERATURE_READY;
                }
                status
            }
            reg::PRESSURE => {
                self.has_new = false;
                self.get(register)
            }
            _ => self.get(register),
        }
    }

    fn write(&mut self, register: u8, value: u8) {
        if register == reg::RESET && value & 0x0F == 0x09 {
            self.reset_at = self.clock.now_us();
            self.put(reg::MEAS_CFG, 0);
            self.has_new = false;
        } else if !(reg::IDENTITY..=0x21).contains(&register) {
            self.put(register, value);
        }
    }
}

/// The nine coefficients packed as the part stores them.
fn calibration_bytes() -> [u8; 18] {
    let [c0, c1, c00, c10, c01, c11, c20, c21, c30] = CALIBRATION;
    let b = |value: i32, shift: u32| (value >> shift) as u8;
    [
        b(c0, 4),
        (b(c0, 0) << 4) | (b(c1, 8) & 0x0F),
        b(c1, 0),
        b(c00, 12),
        b(c00, 4),
        (b(c00, 0) << 4) | (b(c10, 16) & 0x0F),
        b(c10, 8),
        b(c10, 0),
        b(c01, 8),
        b(c01, 0),
        b(c11, 8),
        b(c11, 0),
        b(c20, 8),
        b(c20, 0),
        b(c21, 8),
        b(c21, 0),
        b(c30, 8),
        b(c30, 0),
    ]
}

on_i2c!(FakeDps310);
