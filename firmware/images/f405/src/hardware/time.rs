//! Microseconds, the millisecond pulse, the watchdog, and waiting.

use core::sync::atomic::{AtomicU32, Ordering};
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use embedded_hal::delay::DelayNs;
use stm32f4xx_hal::pac::{IWDG, TIM5};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::{BusTimerClock, Enable, Rcc};
use stm32f4xx_hal::watchdog::IndependentWatchdog;
use tautline_cortex::micros;
use tautline_firmware::time::Micros;

/// The sensor is silent when its edge is this late, µs: the pulse then paces the flight task.
const SILENT_US: u32 = 2_500;
/// Longer than the erasing of a parameter sector, ms.
const WATCHDOG_MS: u32 = 2_000;
const RELOAD_KEY: u16 = 0xAAAA;

static SAMPLE_AT: AtomicU32 = AtomicU32::new(0);

fn count() -> u32 {
    // SAFETY: reads a counter that nobody writes after the start.
    unsafe { TIM5::steal() }.cnt().read().bits()
}

pub fn start(timer: TIM5, mut syst: SYST, watchdog: IWDG, rcc: &mut Rcc) {
    TIM5::enable(rcc);
    let mhz = TIM5::timer_clock(&rcc.clocks).raw() / 1_000_000;
    timer.psc().write(|w| w.psc().set(mhz.saturating_sub(1) as u16));
    timer.arr().write(|w| w.set(u32::MAX));
    timer.egr().write(|w| w.ug().set_bit());
    timer.cr1().modify(|_, w| w.cen().enabled());

    syst.set_clock_source(SystClkSource::Core);
    syst.set_reload(rcc.clocks.sysclk().raw() / 1_000 - 1);
    syst.clear_current();
    syst.enable_counter();
    syst.enable_interrupt();

    IndependentWatchdog::new(watchdog).start(WATCHDOG_MS.millis());
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
    // SAFETY: the key that reloads the counter and does nothing else.
    unsafe { IWDG::steal() }.kr().write(|w| unsafe { w.key().bits(RELOAD_KEY) });
}

/// Waits by the counter.
#[derive(Clone, Copy)]
pub struct Delay;

pub fn delay() -> Delay {
    Delay
}

impl DelayNs for Delay {
    fn delay_ns(&mut self, ns: u32) {
        let (from, wait) = (count(), ns.div_ceil(1_000) + 1);
        // Only the flight task feeds the watchdog: whoever waits here says nothing of it.
        while count().wrapping_sub(from) < wait {}
    }
}
