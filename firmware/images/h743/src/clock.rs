//! Clocks, with every wait for a source bounded: a dead crystal must not ground the code.
//!
//! The HAL waits for ever for what it is told to use, so each source is tried by hand first. In the order of
//! preference: crystal and PLL (400 MHz), internal oscillator and PLL (400 MHz), internal oscillator alone. USB has an
//! oscillator of its own, trimmed by the host's frames.

use embassy_stm32::pac::RCC;
use embassy_stm32::pac::rcc::vals::{Pllrge, Pllsrc, Pllvcosel};
use embassy_stm32::rcc::mux::{Adcsel, Usbsel};
use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, Hse, HseMode, Pll, PllDiv, PllMul, PllPreDiv, PllSource, Sysclk,
    VoltageScale,
};
use embassy_stm32::time::Hertz;
use embassy_stm32::{Config, Peripherals};

const CRYSTAL: Hertz = Hertz(8_000_000);
/// Polls of a ready bit: some 10 ms at the 64 MHz of reset.
const PATIENCE: u32 = 80_000;

/// What runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, defmt::Format)]
pub enum Source {
    /// Crystal and PLL.
    Crystal,
    /// Internal oscillator and PLL.
    Internal,
    /// Internal oscillator, 64 MHz.
    Slow,
}

fn waits(is_ready: impl Fn() -> bool) -> bool {
    (0..PATIENCE).any(|_| is_ready())
}

fn crystal_starts() -> bool {
    RCC.cr().modify(|w| w.set_hseon(true));
    let starts = waits(|| RCC.cr().read().hserdy());
    if !starts {
        RCC.cr().modify(|w| w.set_hseon(false));
    }
    starts
}

/// The first PLL, from 8 MHz of this source.
fn pll_locks(source: Pllsrc, divide: PllPreDiv) -> bool {
    RCC.pllckselr().modify(|w| {
        w.set_pllsrc(source);
        w.set_divm(0, divide);
    });
    RCC.pllcfgr().modify(|w| {
        w.set_pllrge(0, Pllrge::RANGE8);
        w.set_pllvcosel(0, Pllvcosel::WIDE_VCO);
    });
    RCC.plldivr(0).modify(|w| w.set_plln(PllMul::MUL100));
    RCC.cr().modify(|w| w.set_pllon(0, true));
    let locks = waits(|| RCC.cr().read().pllrdy(0));
    // The HAL sets it up anew.
    RCC.cr().modify(|w| w.set_pllon(0, false));
    locks && waits(|| !RCC.cr().read().pllrdy(0))
}

fn fast(config: &mut Config, source: PllSource, prediv: PllPreDiv) {
    let rcc = &mut config.rcc;
    rcc.pll1 = Some(Pll {
        source,
        prediv,
        mul: PllMul::MUL100,
        fracn: None,
        divp: Some(PllDiv::DIV2),
        // Kernel clock of SPI and of the card, 100 MHz.
        divq: Some(PllDiv::DIV8),
        divr: None,
    });
    rcc.sys = Sysclk::PLL1_P;
    rcc.ahb_pre = AHBPrescaler::DIV2;
    rcc.apb1_pre = APBPrescaler::DIV2;
    rcc.apb2_pre = APBPrescaler::DIV2;
    rcc.apb3_pre = APBPrescaler::DIV2;
    rcc.apb4_pre = APBPrescaler::DIV2;
    rcc.voltage_scale = VoltageScale::Scale1;
}

/// The best source that works.
pub fn start() -> (Peripherals, Source) {
    let mut config = Config::default();
    config.rcc.mux.adcsel = Adcsel::PER;
    config.rcc.mux.usbsel = Usbsel::HSI48;
    let source = if crystal_starts() && pll_locks(Pllsrc::HSE, PllPreDiv::DIV1) {
        config.rcc.hse = Some(Hse { freq: CRYSTAL, mode: HseMode::Oscillator });
        fast(&mut config, PllSource::HSE, PllPreDiv::DIV1);
        Source::Crystal
    } else if pll_locks(Pllsrc::HSI, PllPreDiv::DIV8) {
        fast(&mut config, PllSource::HSI, PllPreDiv::DIV8);
        Source::Internal
    } else {
        Source::Slow
    };
    (embassy_stm32::init(config), source)
}
