//! Both analogue pins behind one converter.

use core::cell::RefCell;
use core::convert::Infallible;
use critical_section::Mutex;
use embassy_stm32::Peri;
use embassy_stm32::adc::{Adc, SampleTime};
use embassy_stm32::peripherals::{ADC1, PC0, PC1};
use tautline_hal_shim::battery::AdcPin;

const REFERENCE_MV: u32 = 3_300;
const FULL: u32 = u16::MAX as u32;

struct Converter {
    adc: Adc<'static, ADC1>,
    voltage: Peri<'static, PC0>,
    current: Peri<'static, PC1>,
}

static CONVERTER: Mutex<RefCell<Option<Converter>>> = Mutex::new(RefCell::new(None));

/// The pins of a started converter.
pub fn start(
    adc: Peri<'static, ADC1>,
    voltage: Peri<'static, PC0>,
    current: Peri<'static, PC1>,
) -> (VoltagePin, CurrentPin) {
    let converter = Converter { adc: Adc::new(adc), voltage, current };
    critical_section::with(|cs| CONVERTER.borrow(cs).replace(Some(converter)));
    (VoltagePin, CurrentPin)
}

fn millivolts(convert: impl FnOnce(&mut Converter) -> u16) -> u16 {
    let counts =
        critical_section::with(|cs| CONVERTER.borrow(cs).borrow_mut().as_mut().map_or(0, convert));
    (u32::from(counts) * REFERENCE_MV / FULL) as u16
}

/// The divided voltage.
pub struct VoltagePin;
/// The current sensor.
pub struct CurrentPin;

impl AdcPin for VoltagePin {
    type Error = Infallible;
    fn read_millivolts(&mut self) -> Result<u16, Infallible> {
        Ok(millivolts(|c| c.adc.blocking_read(&mut c.voltage, SampleTime::CYCLES32_5)))
    }
}

impl AdcPin for CurrentPin {
    type Error = Infallible;
    fn read_millivolts(&mut self) -> Result<u16, Infallible> {
        Ok(millivolts(|c| c.adc.blocking_read(&mut c.current, SampleTime::CYCLES32_5)))
    }
}
