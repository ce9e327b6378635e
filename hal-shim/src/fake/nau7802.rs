//! Fake NAU7802 behind I2C, with a bridge on it.
//!
//! Traps reproduced: power is ready only 200 µs after it was asked for; the analogue part needs its own bit; a rate that
//! was not calibrated after it was set reads wrong; a conversion is new once.

use super::FakeClock;
use super::registers::{RegisterPart, on_i2c};
use crate::load_cell::nau7802::{
    ADDRESS, ANALOGUE_ON, CALIBRATE, CALIBRATION_FAILED, CYCLE_READY, CYCLE_START, DIGITAL_ON,
    FULL_SCALE, POWER_READY, REGULATOR, RESET, REVISION, register as reg,
};

const POWER_US: u64 = 200;
const CALIBRATION_US: u64 = 344_000;
const PERIOD_US: u64 = 12_500;
/// What a rate that was not calibrated adds.
const UNBALANCED: i32 = 40_000;
/// RATE bits of CTRL2.
const RATE: u8 = 0x70;

/// The part.
#[derive(Debug)]
pub struct FakeNau7802 {
    clock: FakeClock,
    registers: [u8; 32],
    powered_at: u64,
    calibrates_until: Option<u64>,
    calibrated_rate: Option<u8>,
    converted_at: u64,
    counts: i32,
    /// A wire of the bridge is off: it reads full scale.
    pub is_open: bool,
    /// Its supply is bad: it does not find its own offset.
    pub is_starved: bool,
    /// It answers and does not convert.
    pub is_hung: bool,
    /// No answer on the bus.
    pub is_dead: bool,
}

impl FakeNau7802 {
    /// Just powered up.
    #[must_use]
    pub fn new(clock: FakeClock) -> Self {
        let mut part = Self {
            clock,
            registers: [0; 32],
            powered_at: 0,
            calibrates_until: None,
            calibrated_rate: None,
            converted_at: 0,
            counts: 0,
            is_open: false,
            is_starved: false,
            is_hung: false,
            is_dead: false,
        };
        part.reset();
        part
    }

    /// The truth at its input, counts. Call it often; the part takes a sample when a conversion is due.
    pub fn set_counts(&mut self, counts: f64) {
        let now = self.clock.now_us();
        let runs = DIGITAL_ON | ANALOGUE_ON | REGULATOR | CYCLE_START;
        let is_running = self.get(reg::PU_CTRL) & runs == runs && !self.is_hung;
        if !is_running || now < self.converted_at + PERIOD_US {
            return;
        }
        self.converted_at = now;
        let is_balanced = self.calibrated_rate == Some(self.get(reg::CTRL2) & RATE);
        let unbalanced = if is_balanced { 0 } else { UNBALANCED };
        let shown = (counts.round() as i32).saturating_add(unbalanced);
        self.counts = if self.is_open { FULL_SCALE } else { shown.clamp(-FULL_SCALE, FULL_SCALE) };
        let ready = self.get(reg::PU_CTRL) | CYCLE_READY;
        self.put(reg::PU_CTRL, ready);
    }

    fn reset(&mut self) {
        self.registers = [0; 32];
        self.put(reg::REVISION, 0xA0 | REVISION);
        (self.calibrates_until, self.calibrated_rate) = (None, None);
    }

    fn get(&self, register: u8) -> u8 {
        self.registers.get(usize::from(register)).copied().unwrap_or(0)
    }

    fn put(&mut self, register: u8, value: u8) {
        if let Some(slot) = self.registers.get_mut(usize::from(register)) {
            *slot = value;
        }
    }

    fn finish_calibration(&mut self) {
        if self.calibrates_until.is_some_and(|until| self.clock.now_us() >= until) {
            self.calibrates_until = None;
            let rest = self.get(reg::CTRL2) & !CALIBRATE;
            self.calibrated_rate = Some(rest & RATE);
            self.put(reg::CTRL2, if self.is_starved { rest | CALIBRATION_FAILED } else { rest });
        }
    }
}

impl RegisterPart for FakeNau7802 {
    fn answers(&self, address: u8) -> bool {
        address == ADDRESS && !self.is_dead
    }

    fn read(&mut self, register: u8) -> u8 {
        self.finish_calibration();
        let [_, high, middle, low] = self.counts.to_be_bytes();
        match register {
            reg::PU_CTRL => {
                let is_on = self.get(register) & DIGITAL_ON != 0;
                let is_ready = is_on && self.clock.now_us() >= self.powered_at + POWER_US;
                self.get(register) | if is_ready { POWER_READY } else { 0 }
            }
            reg::ADCO => {
                let rest = self.get(reg::PU_CTRL) & !CYCLE_READY;
                self.put(reg::PU_CTRL, rest);
                high
            }
            _ if register == reg::ADCO + 1 => middle,
            _ if register == reg::ADCO + 2 => low,
            _ => self.get(register),
        }
    }

    fn write(&mut self, register: u8, value: u8) {
        if register == reg::PU_CTRL && value & RESET != 0 {
            self.reset();
        }
        if register == reg::PU_CTRL
            && value & DIGITAL_ON != 0
            && self.get(register) & DIGITAL_ON == 0
        {
            self.powered_at = self.clock.now_us();
        }
        if register == reg::CTRL2 && value & CALIBRATE != 0 {
            self.calibrates_until = Some(self.clock.now_us() + CALIBRATION_US);
        }
        if !(reg::ADCO..reg::ADC).contains(&register) && register != reg::REVISION {
            self.put(
                register,
                value & if register == reg::PU_CTRL { !(POWER_READY | CYCLE_READY) } else { 0xFF },
            );
        }
    }
}

on_i2c!(FakeNau7802);
