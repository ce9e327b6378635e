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
    /// What the upward acceleration is off by, m/s².
    pub bias: S,
}

/// How fast the bias follows, in bandwidths cubed: 2 s at 3 rad/s.
const BIAS_GAIN: f64 = 0.15;
/// Largest bias, m/s².
const BIAS_MAX: f64 = 3.0;

impl<S: Scalar> VerticalFilter<S> {
    /// Integrates the upward acceleration over `dt` s.
    pub fn predict(&self, state: &mut VerticalState<S>, accel_up: S, dt: S, has_altimeter: bool) {
        if !has_altimeter {
            state.climb -= state.climb * dt / self.fade;
        }
        let accel = accel_up + state.bias;
        state.height += state.climb * dt + accel * dt * dt * S::lit(0.5);
        state.climb += accel * dt;
    }

    /// Takes an altitude, `dt` s after the previous one.
    pub fn correct(&self, state: &mut VerticalState<S>, altitude: S, dt: S) {
        let w = (self.bandwidth * dt).min(S::lit(0.5));
        let error = altitude - state.height;
        state.height += error * w * S::lit(1.6);
        state.climb += error * w * self.bandwidth;
        let bias = state.bias + error * w * self.bandwidth * self.bandwidth * S::lit(BIAS_GAIN);
        state.bias = bias.limit_abs(S::lit(BIAS_MAX));
    }
}
