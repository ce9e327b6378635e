//! Height and climb rate alone, from altimeter and accelerometer. It knows nothing of the tether, so
//! it still stands when the position filter has diverged; Altitude and Descent fly on it.

use crate::scalar::Scalar;

/// Second-order fixed-gain observer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VerticalFilter<S> {
    /// Bandwidth, rad/s.
    pub bandwidth: S,
    /// Without altimeter the climb rate fades with this time constant, s.
    pub fade: S,
}

/// Height over the anchor, m, and climb rate, m/s, both up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VerticalState<S> {
    /// m.
    pub height: S,
    /// m/s.
    pub climb: S,
}

impl<S: Scalar> VerticalFilter<S> {
    /// Integrates the upward acceleration over `dt` s.
    pub fn predict(&self, state: &mut VerticalState<S>, accel_up: S, dt: S, has_altimeter: bool) {
        if !has_altimeter {
            state.climb -= state.climb * dt / self.fade;
        }
        state.height += state.climb * dt + accel_up * dt * dt * S::lit(0.5);
        state.climb += accel_up * dt;
    }

    /// Takes an altitude, `dt` s after the previous one.
    pub fn correct(&self, state: &mut VerticalState<S>, altitude: S, dt: S) {
        let w = (self.bandwidth * dt).min(S::lit(0.5));
        let error = altitude - state.height;
        state.height += error * w * S::lit(1.6);
        state.climb += error * w * self.bandwidth;
    }
}
