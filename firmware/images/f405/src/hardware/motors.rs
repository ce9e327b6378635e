//! The motor outputs on their timers.

use super::pins;
use core::convert::Infallible;
use core::sync::atomic::{AtomicU32, Ordering};
use embedded_hal::pwm::{ErrorType, SetDutyCycle};
use stm32f4xx_hal::rcc::Rcc;
use tautline_firmware::param::Params;
use tautline_hal_shim::motors::MotorOutputs;
use tautline_runtime::inner_loop::protocol;

/// The stop pulse as a share of the period, of 65536.
static STOP: AtomicU32 = AtomicU32::new(0);

/// The timers before anybody knows the ESCs' protocol.
pub struct Motors {
    pub timers: pins::MotorTimers,
    pub rcc: Rcc,
}

impl Motors {
    pub fn run(mut self, params: &Params) -> MotorOutputs<Motor> {
        let protocol = protocol(params);
        let period = protocol.period_us();
        STOP.store((protocol.pulse_us(0.0) / period * 65_536.0) as u32, Ordering::Relaxed);
        let channels = self.timers.run((1e6 / period) as u32, &mut self.rcc);
        match MotorOutputs::try_new(channels.map(Motor), protocol) {
            Ok(outputs) => outputs,
            Err(never) => match never {},
        }
    }
}

/// The stop pulse on every motor, at once and from any context.
pub fn stop_motors() {
    pins::force(STOP.load(Ordering::Relaxed));
}

/// One output.
pub struct Motor(pins::Channel);

impl ErrorType for Motor {
    type Error = Infallible;
}

impl SetDutyCycle for Motor {
    fn max_duty_cycle(&self) -> u16 {
        self.0.max()
    }
    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        self.0.set(duty);
        Ok(())
    }
}
