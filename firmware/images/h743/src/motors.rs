//! The motor outputs: M1 and M2 on channels 3 and 4 of TIM3, M3 and M4 on channels 1 and 2 of TIM5.

use core::convert::Infallible;
use core::sync::atomic::{AtomicU32, Ordering};
use embassy_stm32::Peri;
use embassy_stm32::gpio::OutputType;
use embassy_stm32::pac::common::{RW, Reg};
use embassy_stm32::pac::timer::TimGp16;
use embassy_stm32::pac::timer::regs::Ccr1ch;
use embassy_stm32::pac::{TIM3, TIM5};
use embassy_stm32::peripherals::{self, PA0, PA1, PB0, PB1};
use embassy_stm32::rcc::frequency;
use embassy_stm32::time::Hertz;
use embassy_stm32::timer::low_level::CountingMode;
use embassy_stm32::timer::simple_pwm::{PwmPin, SimplePwm};
use embedded_hal::pwm::{ErrorType, SetDutyCycle};
use tautline_firmware::param::Params;
use tautline_hal_shim::motors::MotorOutputs;
use tautline_runtime::inner_loop::protocol;

/// Counts of both timers, a whole part of their clock by PLL (200 MHz) and without (64 MHz), or pulses were off.
const COUNT_HZ: u32 = 8_000_000;
/// The stop pulse as a share of the period, of 65536.
static STOP: AtomicU32 = AtomicU32::new(0);
const OUTPUTS: [Motor; 4] = [Motor::First, Motor::Second, Motor::Third, Motor::Fourth];

/// TIM5 counts to 32 bits; used as one of 16 it has the same registers.
fn back() -> TimGp16 {
    // SAFETY: a general-purpose timer, whose registers these are.
    unsafe { TimGp16::from_ptr(TIM5.as_ptr()) }
}

/// The timers before anybody knows the ESCs' protocol.
pub struct Motors {
    pub front: Peri<'static, peripherals::TIM3>,
    pub rear: Peri<'static, peripherals::TIM5>,
    pub pins: (Peri<'static, PB0>, Peri<'static, PB1>, Peri<'static, PA0>, Peri<'static, PA1>),
}

impl Motors {
    pub fn run(self, params: &Params) -> MotorOutputs<Motor> {
        let protocol = protocol(params);
        let period = protocol.period_us();
        STOP.store((protocol.pulse_us(0.0) / period * 65_536.0) as u32, Ordering::Relaxed);
        let rate = Hertz((1e6 / period) as u32);
        let (m1, m2, m3, m4) = self.pins;
        let out = OutputType::PushPull;
        let mode = CountingMode::EdgeAlignedUp;
        let (m1, m2) = (Some(PwmPin::new(m1, out)), Some(PwmPin::new(m2, out)));
        let (m3, m4) = (Some(PwmPin::new(m3, out)), Some(PwmPin::new(m4, out)));
        let front = SimplePwm::new(self.front, None, None, m1, m2, rate, mode);
        let rear = SimplePwm::new(self.rear, m3, m4, None, None, rate, mode);
        let (front, rear) = (front.split(), rear.split());
        for (registers, bus) in
            [(TIM3, frequency::<peripherals::TIM3>()), (back(), frequency::<peripherals::TIM5>())]
        {
            registers.psc().write_value((bus.0 / COUNT_HZ).saturating_sub(1) as u16);
            registers.arr().write(|w| w.set_arr((COUNT_HZ / rate.0 - 1) as u16));
        }
        let (mut m1, mut m2, mut m3, mut m4) = (front.ch3, front.ch4, rear.ch1, rear.ch2);
        stop();
        m1.enable();
        m2.enable();
        m3.enable();
        m4.enable();
        match MotorOutputs::try_new(OUTPUTS, protocol) {
            Ok(outputs) => outputs,
            Err(never) => match never {},
        }
    }
}

/// The stop pulse on every motor, at once and from any context.
pub fn stop() {
    for mut motor in OUTPUTS {
        let pulse = (u32::from(motor.max_duty_cycle()) * STOP.load(Ordering::Relaxed)) >> 16;
        let Ok(()) = motor.set_duty_cycle(pulse as u16);
        motor.timer().egr().write(|w| w.set_ug(true));
    }
}

/// One output.
pub enum Motor {
    First,
    Second,
    Third,
    Fourth,
}

impl Motor {
    fn timer(&self) -> TimGp16 {
        match self {
            Self::First | Self::Second => TIM3,
            Self::Third | Self::Fourth => back(),
        }
    }

    /// Constants, or looking up the channel could panic.
    fn pulse(&self) -> Reg<Ccr1ch, RW> {
        match self {
            Self::First => TIM3.ccr(2),
            Self::Second => TIM3.ccr(3),
            Self::Third => back().ccr(0),
            Self::Fourth => back().ccr(1),
        }
    }
}

impl ErrorType for Motor {
    type Error = Infallible;
}

impl SetDutyCycle for Motor {
    fn max_duty_cycle(&self) -> u16 {
        self.timer().arr().read().arr().saturating_add(1)
    }
    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        self.pulse().write(|w| w.set_ccr(duty));
        Ok(())
    }
}
