//! SpeedyBee F405 V4: which pin is what.
//!
//! Written out whole, also where two boards agree: wiring is read, and changed, a board at a time.
//!
//! Pins as ArduPilot's and Betaflight's board files give them. The inertial sensor's axes are parameters' business:
//! body = (y, x, -z) of the chip, SENS_BOARD_ROT = 10, the default.

use super::wiring::{Battery, Wired, chip_select, fast};
use stm32f4xx_hal::adc::{Adc, config::AdcConfig};
use stm32f4xx_hal::gpio::{Edge, Speed};
use stm32f4xx_hal::pac;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::spi::Spi;
use stm32f4xx_hal::timer::{ErasedChannel, PwmExt};
use tautline_firmware::param::Params;

/// What the board calls itself on USB.
pub const NAME: &str = "Tautline SpeedyBee F405 V4";
/// The card's bus.
pub type CardSpi = Spi<pac::SPI3>;
/// The pin that reads the battery's voltage, and the one that reads its current.
pub type VoltagePin = stm32f4xx_hal::gpio::PC0<stm32f4xx_hal::gpio::Analog>;
pub type CurrentPin = stm32f4xx_hal::gpio::PC1<stm32f4xx_hal::gpio::Analog>;

/// Timers of the motor outputs, stopped.
pub struct MotorTimers {
    front: pac::TIM4,
    rear: pac::TIM3,
    pins: (
        stm32f4xx_hal::gpio::PB6,
        stm32f4xx_hal::gpio::PB7,
        stm32f4xx_hal::gpio::PB0,
        stm32f4xx_hal::gpio::PB1,
    ),
}

/// One output.
pub enum Channel {
    /// M1 and M2.
    Front(ErasedChannel<pac::TIM4>),
    /// M3 and M4.
    Rear(ErasedChannel<pac::TIM3>),
}

impl Channel {
    /// Counts of the period.
    pub fn max(&self) -> u16 {
        match self {
            Self::Front(channel) => channel.get_max_duty(),
            Self::Rear(channel) => channel.get_max_duty(),
        }
    }

    /// Counts of the pulse.
    pub fn set(&mut self, duty: u16) {
        match self {
            Self::Front(channel) => channel.set_duty(duty),
            Self::Rear(channel) => channel.set_duty(duty),
        }
    }
}

/// What differs from the reference board: nothing, this is it.
pub fn defaults(_: &mut Params) {}

impl MotorTimers {
    /// M1 to M4 at that rate.
    pub fn run(self, hertz: u32, rcc: &mut Rcc) -> [Channel; 4] {
        let (_, (m1, m2, ..)) = self.front.pwm_hz(hertz.Hz(), rcc);
        let (_, (_, _, m3, m4)) = self.rear.pwm_hz(hertz.Hz(), rcc);
        let (pin1, pin2, pin3, pin4) = self.pins;
        let (mut m1, mut m2) = (m1.with(pin1), m2.with(pin2));
        let (mut m3, mut m4) = (m3.with(pin3), m4.with(pin4));
        m1.enable();
        m2.enable();
        m3.enable();
        m4.enable();
        [
            Channel::Front(m1.erase()),
            Channel::Front(m2.erase()),
            Channel::Rear(m3.erase()),
            Channel::Rear(m4.erase()),
        ]
    }
}

/// This share (of 65536) of the period on every output, at once and from any context.
pub fn force(share: u32) {
    // SAFETY: whole registers of timers that only the motor outputs use.
    let (front, rear) = unsafe { (pac::TIM4::steal(), pac::TIM3::steal()) };
    let ticks = |reload: u32| ((reload + 1) * share) >> 16;
    let (f, r) = (ticks(front.arr().read().bits()), ticks(rear.arr().read().bits()));
    front.ccr1().write(|w| unsafe { w.bits(f) });
    front.ccr2().write(|w| unsafe { w.bits(f) });
    rear.ccr3().write(|w| unsafe { w.bits(r) });
    rear.ccr4().write(|w| unsafe { w.bits(r) });
    front.egr().write(|w| w.ug().set_bit());
    rear.egr().write(|w| w.ug().set_bit());
}

/// From the rate at which a card starts to the one at which it is written.
pub fn card_fast() {
    // SAFETY: the rate of a bus that only the card uses, changed between two transfers.
    let spi = unsafe { pac::SPI3::steal() };
    spi.cr1().modify(|_, w| w.spe().clear_bit());
    spi.cr1().modify(|_, w| w.br().div4().spe().set_bit());
}

/// Connects everything.
pub fn wire(device: pac::Peripherals, mut rcc: Rcc) -> Wired {
    let gpioa = device.GPIOA.split(&mut rcc);
    let gpiob = device.GPIOB.split(&mut rcc);
    let gpioc = device.GPIOC.split(&mut rcc);
    let mut syscfg = device.SYSCFG.constrain(&mut rcc);
    let mut exti = device.EXTI;

    let imu = Spi::new(
        device.SPI1,
        (
            Some(gpioa.pa5.into_alternate().speed(Speed::High)),
            Some(gpioa.pa6),
            Some(gpioa.pa7.into_alternate().speed(Speed::High)),
        ),
        fast::MODE,
        fast::IMU_HZ.Hz(),
        &mut rcc,
    );
    let mut ready = gpioc.pc4.into_pull_down_input();
    ready.make_interrupt_source(&mut syscfg);
    ready.trigger_on_edge(&mut exti, Edge::Rising);
    ready.enable_interrupt(&mut exti);

    let card = Spi::new(
        device.SPI3,
        (Some(gpiob.pb3.into_alternate()), Some(gpiob.pb4.into_alternate()), Some(gpiob.pb5)),
        fast::MODE,
        fast::CARD_HZ.Hz(),
        &mut rcc,
    );
    let i2c = device.I2C1.i2c((gpiob.pb8, gpiob.pb9), fast::I2C_HZ.Hz(), &mut rcc);
    let adc = Adc::new(device.ADC1, true, AdcConfig::default(), &mut rcc);
    Wired {
        imu: super::wiring::device(imu, chip_select(gpioa.pa4.into_push_pull_output().erase())),
        card: super::wiring::device(card, chip_select(gpioc.pc14.into_push_pull_output().erase())),
        i2c,
        battery: Battery {
            adc,
            voltage: gpioc.pc0.into_analog(),
            current: gpioc.pc1.into_analog(),
        },
        motors: MotorTimers {
            front: device.TIM4,
            rear: device.TIM3,
            pins: (gpiob.pb6, gpiob.pb7, gpiob.pb0, gpiob.pb1),
        },
        telemetry: (device.USART1, gpioa.pa9, gpioa.pa10),
        range: (device.USART6, gpioc.pc7),
        radio: (device.USART2, gpioa.pa2, gpioa.pa3),
        usb: (
            device.OTG_FS_GLOBAL,
            device.OTG_FS_DEVICE,
            device.OTG_FS_PWRCLK,
            gpioa.pa11,
            gpioa.pa12,
        ),
        flash: device.FLASH,
        timer: device.TIM5,
        watchdog: device.IWDG,
        power: device.PWR,
        exti,
        rcc,
    }
}
