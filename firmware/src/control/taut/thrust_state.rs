//! The thrust as a state of the controller, integrated and held. `planar` section 6.5.

use crate::fault::{Invalid, not_negative, require};
use crate::scalar::Scalar;

/// Thrust and its rate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ThrustState<S> {
    /// u1, N.
    pub thrust: S,
    /// u1', N/s.
    pub rate: S,
}

/// What the actuators give.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThrustLimits<S> {
    /// Lowest thrust, N; rotors that only push want it positive.
    pub min: S,
    /// Highest thrust, N.
    pub max: S,
    /// Largest thrust rate, N/s.
    pub rate: S,
    /// Largest thrust acceleration, N/s².
    pub accel: S,
    /// Largest torque, N m.
    pub torque: S,
}

/// What an interval gets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Applied<S> {
    /// Held during the interval, N: the thrust of its middle, which removes the hold's half-sample lag.
    pub thrust: S,
    /// Mean rate over the interval, N/s.
    pub mean_rate: S,
}

impl<S: Scalar> ThrustLimits<S> {
    /// # Errors
    /// [`Invalid`] naming the limit.
    pub(crate) fn check(&self) -> Result<(), Invalid> {
        require("thrust_min", "finite", self.min, |_| true)?;
        require("thrust_max", "finite and above thrust_min", self.max, |x| x > self.min)?;
        not_negative("thrust_rate_max", self.rate)?;
        not_negative("thrust_accel_max", self.accel)?;
        not_negative("torque_max", self.torque)?;
        Ok(())
    }
}

impl<S: Scalar> ThrustState<S> {
    /// One interval under a thrust acceleration (Γb).
    pub fn advance_accel(
        &mut self,
        accel: S,
        dt: S,
        limits: Option<&ThrustLimits<S>>,
    ) -> Applied<S> {
        let accel = limits.map_or(accel, |l| accel.limit_abs(l.accel));
        let half = S::lit(0.5) * dt;
        let before = *self;
        self.thrust += dt * (self.rate + half * accel);
        self.rate += dt * accel;
        self.finish(&before, before.rate, dt, limits)
    }

    /// One interval under a thrust rate (Γa').
    pub fn advance_rate(&mut self, rate: S, dt: S, limits: Option<&ThrustLimits<S>>) -> Applied<S> {
        let rate = limits.map_or(rate, |l| rate.limit_abs(l.rate));
        let before = *self;
        self.thrust += dt * rate;
        self.rate = rate;
        self.finish(&before, rate, dt, limits)
    }

    /// Limits; at a limit the rate does not push outwards.
    fn finish(
        &mut self,
        before: &Self,
        slope: S,
        dt: S,
        limits: Option<&ThrustLimits<S>>,
    ) -> Applied<S> {
        let mut thrust = before.thrust + S::lit(0.5) * dt * slope;
        if let Some(l) = limits {
            thrust = thrust.limit(l.min, l.max);
            self.thrust = self.thrust.limit(l.min, l.max);
            self.rate = self.rate.limit_abs(l.rate);
            let is_outward = self.thrust >= l.max && self.rate > S::zero()
                || self.thrust <= l.min && self.rate < S::zero();
            if is_outward {
                self.rate = S::zero();
            }
        }
        Applied { thrust, mean_rate: (self.thrust - before.thrust) / dt }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: ThrustLimits<f64> =
        ThrustLimits { min: 3.0, max: 20.0, rate: 50.0, accel: 1e3, torque: 1.0 };

    #[test]
    fn the_held_thrust_is_that_of_the_middle_of_the_interval() {
        let mut state = ThrustState { thrust: 10.0, rate: 4.0 };
        let applied = state.advance_accel(0.0, 0.01, None);
        assert!((applied.thrust - 10.02).abs() < 1e-12 && (state.thrust - 10.04).abs() < 1e-12);
        assert!((applied.mean_rate - 4.0).abs() < 1e-9);
    }

    #[test]
    fn a_limit_stops_the_rate_that_pushes_against_it_and_no_other() {
        let mut state = ThrustState { thrust: 19.9, rate: 40.0 };
        state.advance_accel(0.0, 0.01, Some(&LIMITS));
        assert_eq!(state, ThrustState { thrust: 20.0, rate: 0.0 });
        state.advance_accel(-100.0, 0.01, Some(&LIMITS));
        assert!(state.rate < 0.0 && state.thrust < 20.0);
    }
}
