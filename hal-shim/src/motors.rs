//! Motor outputs over `SetDutyCycle`: 400 Hz PWM or OneShot125.

use embedded_hal::pwm::SetDutyCycle;

/// What the ESCs are told in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Protocol {
    /// 1000–2000 µs every 2500 µs.
    Pwm400,
    /// 125–250 µs every 1000 µs.
    OneShot125,
}

impl Protocol {
    /// Set the timer to this period, µs.
    #[must_use]
    pub const fn period_us(self) -> f32 {
        match self {
            Self::Pwm400 => 2_500.0,
            Self::OneShot125 => 1_000.0,
        }
    }

    /// Pulse of a throttle, µs; 0 for anything that is not a number.
    #[must_use]
    pub fn pulse_us(self, throttle: f32) -> f32 {
        let share = if throttle > 0.0 { throttle.min(1.0) } else { 0.0 };
        let pwm = 1_000.0 + 1_000.0 * share;
        match self {
            Self::Pwm400 => pwm,
            Self::OneShot125 => pwm / 8.0,
        }
    }
}

/// Outputs of the same protocol, as many as a board has pads for.
#[derive(Debug)]
pub struct MotorOutputs<P, const N: usize = 4> {
    channels: [P; N],
    protocol: Protocol,
}

impl<P: SetDutyCycle, const N: usize> MotorOutputs<P, N> {
    /// The timers must already run at [`Protocol::period_us`]. Sends the stop pulse.
    ///
    /// # Errors
    /// The channel's.
    pub fn try_new(channels: [P; N], protocol: Protocol) -> Result<Self, P::Error> {
        let mut outputs = Self { channels, protocol };
        outputs.stop()?;
        Ok(outputs)
    }

    /// Throttle of each motor, 0..1. A channel without a motor is left at its stop pulse.
    ///
    /// # Errors
    /// The channel's; the other channels are still written.
    pub fn write(&mut self, throttle: &[f32]) -> Result<(), P::Error> {
        let mut result = Ok(());
        for (channel, &throttle) in self.channels.iter_mut().zip(throttle) {
            let share = self.protocol.pulse_us(throttle) / self.protocol.period_us();
            let duty = (share * f32::from(channel.max_duty_cycle()) + 0.5) as u16;
            result = channel.set_duty_cycle(duty).and(result);
        }
        result
    }

    /// The stop pulse on every channel; send it for 3 s after power-up to arm the ESCs.
    ///
    /// # Errors
    /// The channel's.
    pub fn stop(&mut self) -> Result<(), P::Error> {
        self.write(&[0.0; N])
    }

    /// How many motors there may be.
    pub const fn outputs(&self) -> usize {
        N
    }

    /// The channels, for their owner.
    pub fn channels_mut(&mut self) -> &mut [P; N] {
        &mut self.channels
    }
}
