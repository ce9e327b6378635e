//! Fake ESC behind a PWM channel: arms after a second of continuous minimum, disarms when the signal
//! is lost.

use super::FakeClock;
use crate::motors::Protocol;
use embedded_hal::pwm::{ErrorType, SetDutyCycle};
use std::convert::Infallible;

/// Timer resolution: a 16-bit timer at 84 MHz / 4 counts 52 500 in 2500 µs.
const MAX_DUTY: u16 = 52_500;
const ARM_US: u64 = 1_000_000;
const LOSS_US: u64 = 2_000_000;
/// Share of throttle below which the pulse counts as minimum.
const IDLE: f64 = 0.005;

/// One ESC.
#[derive(Debug)]
pub struct FakeEsc {
    clock: FakeClock,
    /// Pulse that stops the motor, and what is added for full throttle, in counts of duty.
    stop: f64,
    span: f64,
    throttle: f64,
    written_at: u64,
    zero_since: Option<u64>,
    is_armed: bool,
}

impl FakeEsc {
    /// Just powered up, not armed.
    #[must_use]
    pub fn new(clock: FakeClock, protocol: Protocol) -> Self {
        let counts = |throttle: f32| {
            let share = protocol.pulse_us(throttle) / protocol.period_us();
            f64::from(share) * f64::from(MAX_DUTY)
        };
        let (stop, full) = (counts(0.0), counts(1.0));
        Self {
            clock,
            stop,
            span: full - stop,
            throttle: 0.0,
            written_at: 0,
            zero_since: None,
            is_armed: false,
        }
    }

    /// Throttle that reaches the motor, 0..1.
    #[must_use]
    pub fn throttle(&self) -> f64 {
        let has_signal = self.clock.now_us() <= self.written_at + LOSS_US;
        if self.is_armed && has_signal { self.throttle } else { 0.0 }
    }

    /// Whether it has seen its second of minimum.
    #[must_use]
    pub fn is_armed(&self) -> bool {
        self.is_armed
    }
}

impl ErrorType for FakeEsc {
    type Error = Infallible;
}

impl SetDutyCycle for FakeEsc {
    fn max_duty_cycle(&self) -> u16 {
        MAX_DUTY
    }

    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        let now = self.clock.now_us();
        if now > self.written_at + LOSS_US {
            self.is_armed = false;
            self.zero_since = None;
        }
        self.written_at = now;
        let pulse = f64::from(duty.min(MAX_DUTY));
        self.throttle = ((pulse - self.stop) / self.span).clamp(0.0, 1.0);
        if self.throttle < IDLE {
            self.throttle = 0.0;
            let since = *self.zero_since.get_or_insert(now);
            self.is_armed |= now > since + ARM_US;
        } else if !self.is_armed {
            self.zero_since = None;
        }
        Ok(())
    }
}
