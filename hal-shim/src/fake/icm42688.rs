//! Fake ICM-42688-P: four register banks behind SPI.
//!
//! Traps reproduced: RESET_DONE only 1 ms after a reset; data registers 0x8000 until the sensors have
//! started; a bank that stays selected; the 1–2 ms gyro freeze near 100 °/s while the adaptive full
//! scale is on; an empty FIFO's header byte. The FIFO itself is not modelled.

use super::FakeClock;
use crate::imu::icm42688::{
    AFSR_MASK, AFSR_OFF, IDENTITY, INVALID, RESET_DONE, accel_full_scale, gyro_full_scale,
    register as reg,
};
use embedded_hal::spi::{ErrorType, Operation, SpiDevice};
use std::convert::Infallible;

const GYRO_START_US: u64 = 30_000;
const ACCEL_START_US: u64 = 10_000;
const RESET_US: u64 = 1_000;
const FREEZE_US: u64 = 1_500;
/// Rate at which the adaptive full scale switches, rad/s, and the width of the trap.
const AFSR_RATE: f64 = 1.745;
const AFSR_BAND: f64 = 0.05;
const FIFO_DATA: u8 = 0x30;
const FIFO_EMPTY: u8 = 0x80;

/// The part.
#[derive(Debug)]
pub struct FakeIcm42688 {
    clock: FakeClock,
    banks: [[u8; 128]; 4],
    reset_at: u64,
    powered_at: Option<u64>,
    frozen_until: u64,
    gyro: [i16; 3],
    accel: [i16; 3],
    temperature: i16,
    /// Temperature, accelerometer and gyro as their registers hold them.
    data: [u8; 14],
    /// Counts per m/s² and per rad/s, as the registers say.
    counts: [f64; 2],
    /// Data registers keep their values: a hung part.
    pub is_hung: bool,
    /// The part no longer drives the bus: all ones.
    pub is_dead: bool,
}

/// A count, saturated where the part saturates; as rounding does it, without a call.
fn nearest(x: f64) -> i16 {
    ((x + 0.5_f64.copysign(x)) as i32).clamp(-32_767, 32_767) as i16
}

impl FakeIcm42688 {
    /// Just powered up.
    #[must_use]
    pub fn new(clock: FakeClock) -> Self {
        let mut part = Self {
            clock,
            banks: [[0; 128]; 4],
            reset_at: 0,
            powered_at: None,
            frozen_until: 0,
            gyro: [INVALID; 3],
            accel: [INVALID; 3],
            temperature: 0,
            data: [0; 14],
            counts: [0.0; 2],
            is_hung: false,
            is_dead: false,
        };
        part.reset();
        part
    }

    /// The truth at the sensor, its own axes: specific force m/s², rate rad/s, temperature °C.
    pub fn set_motion(&mut self, accel: [f64; 3], gyro: [f64; 3], temperature: f64) {
        if self.is_hung {
            return;
        }
        let now = self.clock.now_us();
        let started = |after: u64| self.powered_at.is_some_and(|at| now >= at + after);
        let [accel_counts, gyro_counts] = self.counts;
        self.temperature = nearest((temperature - 25.0) * 132.48);
        if started(ACCEL_START_US) {
            self.accel = accel.map(|x| nearest(x * accel_counts));
        }
        let adapts = self.get(0, reg::INTF_CONFIG1) & AFSR_MASK != AFSR_OFF;
        let near = gyro.iter().any(|w| (w.abs() - AFSR_RATE).abs() < AFSR_BAND);
        if adapts && near && now >= self.frozen_until + 10 * FREEZE_US {
            self.frozen_until = now + FREEZE_US;
        }
        if started(GYRO_START_US) && now >= self.frozen_until {
            self.gyro = gyro.map(|w| nearest(w * gyro_counts));
        }
        self.latch();
    }

    fn latch(&mut self) {
        let ([ax, ay, az], [gx, gy, gz]) = (self.accel, self.gyro);
        let words = [self.temperature, ax, ay, az, gx, gy, gz];
        for (slot, word) in self.data.chunks_exact_mut(2).zip(words) {
            slot.copy_from_slice(&word.to_be_bytes());
        }
    }

    fn reset(&mut self) {
        self.banks = [[0; 128]; 4];
        for (register, value) in [
            (0x4C, 0x30),
            (reg::INTF_CONFIG1, 0x91),
            (reg::GYRO_CONFIG0, 0x06),
            (reg::ACCEL_CONFIG0, 0x06),
            (0x51, 0x16),
            (0x52, 0x11),
            (0x53, 0x0D),
            (0x54, 0x23),
            (0x62, 0x10),
            (reg::INT_CONFIG1, 0x10),
            (reg::WHO_AM_I, IDENTITY),
        ] {
            self.put(0, register, value);
        }
        self.reset_at = self.clock.now_us();
        self.powered_at = None;
        self.gyro = [INVALID; 3];
        self.accel = [INVALID; 3];
        self.latch();
    }

    fn get(&self, bank: u8, register: u8) -> u8 {
        let bank = self.banks.get(usize::from(bank & 3));
        bank.and_then(|bank| bank.get(usize::from(register & 0x7F))).copied().unwrap_or(0)
    }

    fn put(&mut self, bank: u8, register: u8, value: u8) {
        let bank = self.banks.get_mut(usize::from(bank & 3));
        if let Some(slot) = bank.and_then(|bank| bank.get_mut(usize::from(register & 0x7F))) {
            *slot = value;
        }
        if matches!(register, reg::ACCEL_CONFIG0 | reg::GYRO_CONFIG0) {
            let code = |register: u8| self.get(0, register) >> 5;
            let full = [
                accel_full_scale(code(reg::ACCEL_CONFIG0)),
                gyro_full_scale(code(reg::GYRO_CONFIG0)),
            ];
            self.counts = full.map(|full| 32_768.0 / f64::from(full));
        }
    }

    /// The measured values from `register` on, as a burst reads them.
    fn burst(&self, register: u8, length: usize) -> Option<&[u8]> {
        let from = usize::from(register.checked_sub(reg::TEMP_DATA1)?);
        let is_readable = !self.is_dead && self.selected() == 0;
        self.data.get(from..from + length).filter(|_| is_readable)
    }

    fn selected(&self) -> u8 {
        self.get(0, reg::REG_BANK_SEL) & 3
    }

    fn read(&mut self, register: u8) -> u8 {
        if self.is_dead {
            return 0xFF;
        }
        if register == reg::REG_BANK_SEL || self.selected() != 0 {
            return if register == reg::REG_BANK_SEL {
                self.selected()
            } else {
                self.get(self.selected(), register)
            };
        }
        match register {
            reg::TEMP_DATA1..=0x2A => {
                self.data.get(usize::from(register - reg::TEMP_DATA1)).copied().unwrap_or(0)
            }
            reg::INT_STATUS => {
                let done = self.clock.now_us() >= self.reset_at + RESET_US;
                let status = self.get(0, register) | if done { RESET_DONE } else { 0 };
                self.put(0, register, 0);
                status
            }
            FIFO_DATA => FIFO_EMPTY,
            _ => self.get(0, register),
        }
    }

    /// One byte of a transaction each way; the first is the address, which then counts up.
    fn exchange(&mut self, address: &mut Option<u8>, sent: u8) -> u8 {
        let Some(at) = *address else {
            *address = Some(sent);
            return 0;
        };
        *address = Some((at & reg::READ) | (at.wrapping_add(1) & !reg::READ));
        if at & reg::READ != 0 {
            return self.read(at & !reg::READ);
        }
        self.write(at, sent);
        0
    }

    fn write(&mut self, register: u8, value: u8) {
        if self.is_dead {
            return;
        }
        if register == reg::REG_BANK_SEL {
            return self.put(0, register, value & 7);
        }
        let bank = self.selected();
        if bank == 0 && register == reg::DEVICE_CONFIG && value & 1 != 0 {
            return self.reset();
        }
        if bank == 0
            && register == reg::PWR_MGMT0
            && value & 0x0F == 0x0F
            && self.powered_at.is_none()
        {
            self.powered_at = Some(self.clock.now_us());
        }
        if bank != 0 || register != reg::WHO_AM_I {
            self.put(bank, register, value);
        }
    }
}

impl ErrorType for FakeIcm42688 {
    type Error = Infallible;
}

impl SpiDevice for FakeIcm42688 {
    /// One chip select.
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Infallible> {
        let mut address: Option<u8> = None;
        for operation in operations {
            match operation {
                Operation::Write(bytes) => {
                    for &byte in bytes.iter() {
                        self.exchange(&mut address, byte);
                    }
                }
                Operation::Read(bytes) => {
                    for byte in bytes.iter_mut() {
                        *byte = self.exchange(&mut address, 0);
                    }
                }
                Operation::TransferInPlace(bytes) => {
                    if let [first, rest @ ..] = &mut **bytes
                        && address.is_none()
                        && *first & reg::READ != 0
                        && let Some(data) = self.burst(*first & !reg::READ, rest.len())
                    {
                        address = Some(*first + rest.len() as u8);
                        rest.copy_from_slice(data);
                        *first = 0;
                        continue;
                    }
                    for byte in bytes.iter_mut() {
                        *byte = self.exchange(&mut address, *byte);
                    }
                }
                Operation::Transfer(into, from) => {
                    let sent = from.iter().copied().chain(std::iter::repeat(0));
                    for (byte, sent) in into.iter_mut().zip(sent) {
                        *byte = self.exchange(&mut address, sent);
                    }
                }
                Operation::DelayNs(_) => {}
            }
        }
        Ok(())
    }
}
