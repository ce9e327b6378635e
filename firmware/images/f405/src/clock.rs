//! Clocks, with every wait bounded: a dead crystal must not ground the code.
//!
//! The HAL waits for ever for what it is told to use, so each source is tried by hand first. In the order of
//! preference: crystal and PLL (168 MHz), internal oscillator and PLL (168 MHz, no USB), internal oscillator alone.

use stm32f4xx_hal::pac::RCC;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::{Config, Rcc};

const CRYSTAL_MHZ: u32 = 8;
const CORE_MHZ: u32 = 168;
/// Polls of a ready bit: some 10 ms at the 16 MHz of reset; a crystal starts in 2.
const PATIENCE: u32 = 20_000;

/// What runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, defmt::Format)]
pub enum Source {
    /// Crystal and PLL.
    Crystal,
    /// Internal oscillator and PLL: good for flight, not for USB.
    Internal,
    /// Internal oscillator, 16 MHz. Only an emulator without clocks should end here.
    Slow,
}

fn waits(is_ready: impl Fn() -> bool) -> bool {
    (0..PATIENCE).any(|_| is_ready())
}

fn crystal_starts(rcc: &RCC) -> bool {
    rcc.cr().modify(|_, w| w.hseon().on());
    let starts = waits(|| rcc.cr().read().hserdy().is_ready());
    if !starts {
        rcc.cr().modify(|_, w| w.hseon().off());
    }
    starts
}

fn pll_locks(rcc: &RCC, on_crystal: bool) -> bool {
    let input = if on_crystal { CRYSTAL_MHZ } else { 16 };
    rcc.pllcfgr().modify(|_, w| {
        w.pllsrc().bit(on_crystal);
        // SAFETY: divided to 1 MHz, times 336, halved: in the ranges of the reference manual.
        unsafe { w.pllm().bits(input as u8).plln().bits(336).pllq().bits(7) };
        w.pllp().div2()
    });
    rcc.cr().modify(|_, w| w.pllon().on());
    let locks = waits(|| rcc.cr().read().pllrdy().is_ready());
    // The HAL sets it up anew.
    rcc.cr().modify(|_, w| w.pllon().off());
    locks && waits(|| !rcc.cr().read().pllrdy().is_ready())
}

/// The best source that works.
pub fn start(rcc: RCC) -> (Rcc, Source) {
    let has_crystal = crystal_starts(&rcc);
    let source = if has_crystal && pll_locks(&rcc, true) {
        Source::Crystal
    } else if pll_locks(&rcc, false) {
        Source::Internal
    } else {
        Source::Slow
    };
    let fast = |config: Config| config.sysclk(CORE_MHZ.MHz()).require_pll48clk();
    let config = match source {
        Source::Crystal => fast(Config::hse(CRYSTAL_MHZ.MHz())),
        Source::Internal => fast(Config::hsi()),
        Source::Slow => Config::hsi(),
    };
    (rcc.freeze(config), source)
}
