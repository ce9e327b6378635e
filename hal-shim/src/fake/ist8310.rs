//! Fake IST8310 behind I2C.
//!
//! Traps reproduced: left-handed axes; nothing is measured that was not asked for; a measurement takes 6 ms and is new
//! once; a reset forgets the configuration and takes its time.

use super::FakeClock;
use super::registers::{RegisterPart, on_i2c};
use crate::magnetometer::ist8310::{
    ADDRESS, AVERAGE_16, IDENTITY, RANGE, READY, RESET, SINGLE, register as reg,
};

const MEASURE_US: u64 = 6_000;
const RESET_US: u64 = 10_000;
/// T per count.
const TESLA_PER_COUNT: f64 = 0.3e-6;
/// What a single measurement is off by without the average, counts.
const ROUGH: f64 = 5.0;

/// The part.
#[derive(Debug)]
pub struct FakeIst8310 {
    clock: FakeClock,
    field: [f64; 3],
    average: u8,
    reset_at: Option<u64>,
    asked_at: Option<u64>,
    has_new: bool,
    data: [u8; 6],
    /// It answers and does not measure.
    pub is_hung: bool,
    /// No answer on the bus.
    pub is_dead: bool,
}

impl FakeIst8310 {
    /// Just powered up.
    #[must_use]
    pub fn new(clock: FakeClock) -> Self {
        Self {
            clock,
            field: [0.0; 3],
            average: 0,
            reset_at: None,
            asked_at: None,
            has_new: false,
            data: [0; 6],
            is_hung: false,
            is_dead: false,
        }
    }

    /// The truth, right-handed axes, T.
    pub fn set_field(&mut self, field: [f64; 3]) {
        self.field = field;
    }

    fn measure(&mut self) {
        let is_due = self.asked_at.is_some_and(|at| self.clock.now_us() >= at + MEASURE_US);
        if !is_due || self.is_hung {
            return;
        }
        self.asked_at = None;
        self.has_new = true;
        let rough = if self.average == AVERAGE_16 { 0.0 } else { ROUGH };
        let most = f64::from(RANGE);
        let shown = |tesla: f64| {
            ((tesla / TESLA_PER_COUNT + rough).round().clamp(-most, most) as i16).to_le_bytes()
        };
        let [x, y, z] = self.field;
        let ([x0, x1], [y0, y1], [z0, z1]) = (shown(x), shown(y), shown(-z));
        self.data = [x0, x1, y0, y1, z0, z1];
    }
}

impl RegisterPart for FakeIst8310 {
    fn answers(&self, address: u8) -> bool {
        address == ADDRESS && !self.is_dead
    }

    fn read(&mut self, register: u8) -> u8 {
        self.measure();
        match register {
            reg::IDENTITY => IDENTITY,
            reg::STATUS => u8::from(self.has_new) * READY,
            reg::DATA..=0x08 => {
                self.has_new = false;
                self.data.get(usize::from(register - reg::DATA)).copied().unwrap_or(0)
            }
            reg::AVERAGE => self.average,
            _ => 0,
        }
    }

    fn write(&mut self, register: u8, value: u8) {
        let now = self.clock.now_us();
        match register {
            reg::CONTROL_2 if value & RESET != 0 => {
                (self.average, self.asked_at, self.has_new) = (0, None, false);
                self.reset_at = Some(now);
            }
            // Deaf while it resets.
            _ if self.reset_at.is_some_and(|at| now < at + RESET_US) => {}
            reg::CONTROL_1 if value == SINGLE => self.asked_at = Some(now),
            reg::AVERAGE => self.average = value,
            _ => {}
        }
    }
}

on_i2c!(FakeIst8310);
