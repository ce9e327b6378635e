//! Matek F405-TE: which pin is what.
//!
//! Written out whole, also where two boards agree: wiring is read, and changed, a board at a time.
//!
//! Pins as ArduPilot's and Betaflight's board files give them. The inertial sensor's axes are parameters' business:
//! body = (-y, x, z) of the chip.

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
pub const NAME: &str = "Tautline Matek F405-TE";
/// The card's bus.
pub type CardSpi = Spi<pac::SPI2>;
/// The pin that reads the battery's voltage, and the one that reads its current.
pub type VoltagePin = stm32f4xx_hal::gpio::PC4<stm32f4xx_hal::gpio::Analog>;
pub type CurrentPin = stm32f4xx_hal::gpio::PC5<stm32f4xx_hal::gpio::Analog>;

/// Timers of the motor outputs, stopped.
pub struct MotorTimers {
    outer: pac::TIM8,
    inner: pac::TIM1,
    pins: (
        stm32f4xx_hal::gpio::PC9,
        stm32f4xx_hal::gpio::PC8,
        stm32f4xx_hal::gpio::PB15,
        stm32f4xx_hal::gpio::PA8,
    ),
}

/// One output.
pub enum Channel {
    /// M1 and M2.
    Outer(ErasedChannel<pac::TIM8>),
    /// M4.
    Inner(ErasedChannel<pac::TIM1>),
    /// M3: the HAL makes no channel of a complementary pin alone.
    Third,
}

impl Channel {
    /// Counts of the period.
    pub fn max(&self) -> u16 {
        match self {
            Self::Outer(channel) => channel.get_max_duty(),
            Self::Inner(channel) => channel.get_max_duty(),
            // SAFETY: reads.
            Self::Third => unsafe { pac::TIM1::steal() }.arr().read().bits() as u16 + 1,
        }
    }

    /// Counts of the pulse.
    pub fn set(&mut self, duty: u16) {
        match self {
            Self::Outer(channel) => channel.set_duty(duty),
            Self::Inner(channel) => channel.set_duty(duty),
            // SAFETY: the whole register of a channel that is M3's alone.
            Self::Third => {
                let timer = unsafe { pac::TIM1::steal() };
                timer.ccr3().write(|w| unsafe { w.bits(u32::from(duty)) });
            }
        }
    }
}

/// What differs from the reference board.
pub fn defaults(params: &mut Params) {
    params.board_rotation = 2.0;
    params.battery_divider = 21.0;
    params.battery_amps_per_volt = 66.7;
}

impl MotorTimers {
    /// M1 to M4 at that rate. M3 sits on a complementary output: alone enabled, it follows the channel unchanged.
    pub fn run(self, hertz: u32, rcc: &mut Rcc) -> [Channel; 4] {
        let (_, (_, _, m2, m1)) = self.outer.pwm_hz(hertz.Hz(), rcc);
        let (_, (m4, ..)) = self.inner.pwm_hz(hertz.Hz(), rcc);
        let (pin1, pin2, pin3, pin4) = self.pins;
        let (mut m1, mut m2, mut m4) = (m1.with(pin1), m2.with(pin2), m4.with(pin4));
        let _pin3: stm32f4xx_hal::gpio::PB15<stm32f4xx_hal::gpio::Alternate<1>> =
            pin3.into_alternate();
        m1.enable();
        m2.enable();
        m4.enable();
        // SAFETY: mode and enable bits of one output of a timer that only the motors use.
        let timer = unsafe { pac::TIM1::steal() };
        timer.ccmr2_output().modify(|_, w| w.oc3m().pwm_mode1().oc3pe().set_bit());
        timer.ccer().modify(|_, w| w.cc3ne().set_bit());
        [
            Channel::Outer(m1.erase()),
            Channel::Outer(m2.erase()),
            Channel::Third,
            Channel::Inner(m4.erase()),
        ]
    }
}

/// This share (of 65536) of the period on every output, at once and from any context.
pub fn force(share: u32) {
    // SAFETY: whole registers of timers that only the motor outputs use.
    let (outer, inner) = unsafe { (pac::TIM8::steal(), pac::TIM1::steal()) };
    let ticks = |reload: u32| ((reload + 1) * share) >> 16;
    let (o, i) = (ticks(outer.arr().read().bits()), ticks(inner.arr().read().bits()));
    outer.ccr4().write(|w| unsafe { w.bits(o) });
    outer.ccr3().write(|w| unsafe { w.bits(o) });
    inner.ccr3().write(|w| unsafe { w.bits(i) });
    inner.ccr1().write(|w| unsafe { w.bits(i) });
    outer.egr().write(|w| w.ug().set_bit());
    inner.egr().write(|w| w.ug().set_bit());
}

/// From the rate at which a card starts to the one at which it is written.
pub fn card_fast() {
    // SAFETY: the rate of a bus that only the card uses, changed between two transfers.
    let spi = unsafe { pac::SPI2::steal() };
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
            Some(gpiob.pb4.into_alternate()),
            Some(gpioa.pa7.into_alternate().speed(Speed::High)),
        ),
        fast::MODE,
        fast::IMU_HZ.Hz(),
        &mut rcc,
    );
    let mut ready = gpioc.pc15.into_pull_down_input();
    ready.make_interrupt_source(&mut syscfg);
    ready.trigger_on_edge(&mut exti, Edge::Rising);
    ready.enable_interrupt(&mut exti);

    let card = Spi::new(
        device.SPI2,
        (Some(gpiob.pb13), Some(gpioc.pc2), Some(gpioc.pc3)),
        fast::MODE,
        fast::CARD_HZ.Hz(),
        &mut rcc,
    );
    let i2c = device.I2C1.i2c((gpiob.pb8, gpiob.pb7), fast::I2C_HZ.Hz(), &mut rcc);
    let adc = Adc::new(device.ADC1, true, AdcConfig::default(), &mut rcc);
    Wired {
        imu: super::wiring::device(imu, chip_select(gpioc.pc14.into_push_pull_output().erase())),
        card: super::wiring::device(card, chip_select(gpioc.pc1.into_push_pull_output().erase())),
        i2c,
        battery: Battery {
            adc,
            voltage: gpioc.pc4.into_analog(),
            current: gpioc.pc5.into_analog(),
        },
        motors: MotorTimers {
            outer: device.TIM8,
            inner: device.TIM1,
            pins: (gpioc.pc9, gpioc.pc8, gpiob.pb15, gpioa.pa8),
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
