//! Microseconds, the millisecond pulse, the watchdog, and waiting.

use core::sync::atomic::{AtomicU32, Ordering};
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use embassy_stm32::Peri;
use embassy_stm32::pac::iwdg::vals::Key;
use embassy_stm32::pac::{IWDG1, TIM2};
use embassy_stm32::peripherals;
use embassy_stm32::rcc::{enable_and_reset, frequency};
use embassy_stm32::wdg::IndependentWatchdog;
use embedded_hal::delay::DelayNs;
use tautline_cortex::micros;
use tautline_firmware::time::Micros;

/// The sensor is silent when its edge is this late, µs: the pulse then paces the flight task.
const SILENT_US: u32 = 2_500;
const WATCHDOG_US: u32 = 2_000_000;

static SAMPLE_AT: AtomicU32 = AtomicU32::new(0);

fn count() -> u32 {
    TIM2.cnt().read()
}

/// Starts the counter and the pulse; `core_hz` is the processor's clock.
pub fn start(mut syst: SYST, core_hz: u32) {
    enable_and_reset::<peripherals::TIM2>();
    // The timers' clock is twice their bus's, or the bus's where that is not divided.
    let mhz = frequency::<peripherals::TIM2>().0 / 1_000_000;
    TIM2.psc().write_value(mhz.saturating_sub(1) as u16);
    TIM2.arr().write_value(u32::MAX);
    TIM2.egr().write(|w| w.set_ug(true));
    TIM2.cr1().modify(|w| w.set_cen(true));

    syst.set_clock_source(SystClkSource::Core);
    syst.set_reload(core_hz / 1_000 - 1);
    syst.clear_current();
    syst.enable_counter();
    syst.enable_interrupt();
}

/// Starts the watchdog, which only the flight task feeds: not before the parameters are read, since mending what a
/// power cut left may erase sectors of seconds each.
pub fn guard(watchdog: Peri<'static, peripherals::IWDG1>) {
    IndependentWatchdog::new(watchdog, WATCHDOG_US).unleash();
}

/// µs since power-up.
pub fn now() -> Micros {
    micros::now(count)
}

/// An edge of the inertial sensor.
pub fn saw_sample() {
    SAMPLE_AT.store(count(), Ordering::Relaxed);
}

/// Every millisecond.
pub fn pulse() {
    if count().wrapping_sub(SAMPLE_AT.load(Ordering::Relaxed)) > SILENT_US {
        rtic::pend(crate::app::FLIGHT);
    }
}

/// The watchdog is content.
pub fn feed() {
    IWDG1.kr().write(|w| w.set_key(Key::RESET));
}

/// Waits by the counter.
#[derive(Clone, Copy)]
pub struct Delay;

impl DelayNs for Delay {
    fn delay_ns(&mut self, ns: u32) {
        let (from, wait) = (count(), ns.div_ceil(1_000) + 1);
        while count().wrapping_sub(from) < wait {}
    }
}
