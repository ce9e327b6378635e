//! Register-level fakes of every part: what the simulator plugs in and the drivers are tested on.
//!
//! A fake holds registers, a clock and a physical truth that its owner sets; it answers on the same bus
//! trait as the part. It quantises and saturates as its registers say, and it has the part's traps.

mod adc;
mod as5600;
mod dps310;
mod esc;
mod flash;
mod icm42688;
mod ist8310;
mod nau7802;
mod radio;
mod registers;
mod tfmini;

pub use adc::FakePin;
pub use as5600::{FakeAs5600, Magnet};
pub use dps310::FakeDps310;
pub use esc::FakeEsc;
pub use flash::{FakeFlash, FlashError};
pub use icm42688::FakeIcm42688;
pub use ist8310::FakeIst8310;
pub use nau7802::FakeNau7802;
pub use radio::{BusFault, FakeReceiver, Protocol};
pub use tfmini::FakeTfMini;

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Simulated time, shared by all fakes of a vehicle. As a delay it moves that time on, which is what
/// drivers wait for in `init`. One thread at a time has the vehicle, which may change.
#[derive(Clone, Debug, Default)]
pub struct FakeClock(Arc<AtomicU64>);

impl FakeClock {
    /// µs since power-up.
    #[must_use]
    pub fn now_us(&self) -> u64 {
        self.0.load(Relaxed) / 1000
    }
    /// Sets the time; it never runs back.
    pub fn advance_to(&self, now_us: u64) {
        self.0.store(self.0.load(Relaxed).max(now_us * 1000), Relaxed);
    }
}

impl embedded_hal::delay::DelayNs for FakeClock {
    fn delay_ns(&mut self, ns: u32) {
        self.0.store(self.0.load(Relaxed) + u64::from(ns), Relaxed);
    }
}
