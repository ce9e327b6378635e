//! The second USB core, full speed on PA11 and PA12, for the driver that the other family's HAL uses too.

use embassy_stm32::Peri;
use embassy_stm32::gpio::{AfType, Flex, OutputType, Speed};
use embassy_stm32::pac::{PWR, RCC, USB_OTG_FS};
use embassy_stm32::peripherals::{PA11, PA12};
use synopsys_usb_otg::UsbPeripheral;

const PIN_FUNCTION: u8 = 10;

/// The peripheral and the rate of its bus, Hz.
pub struct Usb {
    hclk: u32,
}

impl Usb {
    pub fn new(minus: Peri<'static, PA11>, plus: Peri<'static, PA12>, hclk: u32) -> Self {
        for pin in [Flex::new(minus), Flex::new(plus)] {
            let mut pin = pin;
            let function = AfType::output(OutputType::PushPull, Speed::VeryHigh);
            pin.set_as_af_unchecked(PIN_FUNCTION, function);
            // A dropped pin would be let go.
            core::mem::forget(pin);
        }
        Self { hclk }
    }
}

// SAFETY: the registers of a core of this design, touched by the interrupt alone after the start.
unsafe impl UsbPeripheral for Usb {
    const REGISTERS: *const () = USB_OTG_FS.as_ptr().cast_const().cast();
    const HIGH_SPEED: bool = true;
    const FIFO_DEPTH_WORDS: usize = 1024;
    const ENDPOINT_COUNT: usize = 9;

    fn enable() {
        critical_section::with(|_| {
            PWR.cr3().modify(|w| w.set_usb33den(true));
            RCC.ahb1enr().modify(|w| w.set_usb_otg_fsen(true));
            // The clock of a PHY that is not there would keep the core from sleeping.
            RCC.ahb1lpenr().modify(|w| w.set_usb_otg_fs_ulpilpen(false));
            RCC.ahb1rstr().modify(|w| w.set_usb_otg_fsrst(true));
            RCC.ahb1rstr().modify(|w| w.set_usb_otg_fsrst(false));
        });
    }

    fn ahb_frequency_hz(&self) -> u32 {
        self.hclk
    }
}
