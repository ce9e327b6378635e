//! What every F405 board has, whatever its pins.

use super::{Delay, pins};
use core::convert::Infallible;
use embedded_hal_bus::spi::ExclusiveDevice;
use stm32f4xx_hal::adc::{Adc, config::SampleTime};
use stm32f4xx_hal::gpio::{AnyPin, Output, PA2, PA3, PA9, PA10, PA11, PA12, PC7};
use stm32f4xx_hal::i2c::I2c;
use stm32f4xx_hal::pac;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::spi::Spi;
use tautline_hal_shim::battery::AdcPin;

/// Rates of the buses.
pub mod fast {
    /// Clock idles low, sampled on the first edge: both the sensor and cards take it.
    pub const MODE: embedded_hal::spi::Mode = embedded_hal::spi::MODE_0;
    /// The sensor takes 24 MHz; half of that is plenty for fifteen bytes.
    pub const IMU_HZ: u32 = 10_500_000;
    /// As cards want it until they are set up.
    pub const CARD_HZ: u32 = 400_000;
    /// Fast mode.
    pub const I2C_HZ: u32 = 400_000;
}

/// A device alone on its bus. Without a delay of its own it would panic when asked for one.
pub type Device<BUS> = ExclusiveDevice<BUS, AnyPin<Output>, Delay>;

/// High: not selected.
pub fn chip_select(mut pin: AnyPin<Output>) -> AnyPin<Output> {
    pin.set_high();
    pin
}

/// `bus` with its chip select.
pub fn device<BUS>(bus: BUS, select: AnyPin<Output>) -> Device<BUS> {
    match ExclusiveDevice::new(bus, select, Delay) {
        Ok(device) => device,
        Err(never) => match never {},
    }
}

/// Both analogue pins behind one converter.
pub struct Battery {
    pub adc: Adc<pac::ADC1>,
    pub voltage: pins::VoltagePin,
    pub current: pins::CurrentPin,
}

/// The first pin.
pub struct VoltagePin(pub &'static BatteryCell);
/// The second.
pub struct CurrentPin(pub &'static BatteryCell);

/// Where both find the converter; a conversion takes some microseconds.
pub type BatteryCell = critical_section::Mutex<core::cell::RefCell<Option<Battery>>>;

fn convert(cell: &'static BatteryCell, read: impl FnOnce(&mut Battery) -> u16) -> u16 {
    critical_section::with(|cs| cell.borrow(cs).borrow_mut().as_mut().map_or(0, read))
}

impl AdcPin for VoltagePin {
    type Error = Infallible;
    fn read_millivolts(&mut self) -> Result<u16, Infallible> {
        Ok(convert(self.0, |b| {
            let sample = b.adc.convert(&b.voltage, SampleTime::Cycles_84);
            b.adc.sample_to_millivolts(sample)
        }))
    }
}

impl AdcPin for CurrentPin {
    type Error = Infallible;
    fn read_millivolts(&mut self) -> Result<u16, Infallible> {
        Ok(convert(self.0, |b| {
            let sample = b.adc.convert(&b.current, SampleTime::Cycles_84);
            b.adc.sample_to_millivolts(sample)
        }))
    }
}

/// Everything a board's pins lead to.
pub struct Wired {
    pub imu: Device<Spi<pac::SPI1>>,
    pub card: Device<pins::CardSpi>,
    pub i2c: I2c<pac::I2C1>,
    pub battery: Battery,
    pub motors: pins::MotorTimers,
    pub telemetry: (pac::USART1, PA9, PA10),
    pub range: (pac::USART6, PC7),
    pub radio: (pac::USART2, PA2, PA3),
    pub usb: (pac::OTG_FS_GLOBAL, pac::OTG_FS_DEVICE, pac::OTG_FS_PWRCLK, PA11, PA12),
    pub flash: pac::FLASH,
    pub timer: pac::TIM5,
    pub watchdog: pac::IWDG,
    pub power: pac::PWR,
    pub exti: pac::EXTI,
    pub rcc: Rcc,
}
