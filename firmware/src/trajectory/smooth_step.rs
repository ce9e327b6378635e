//! The C2 step `10τ³ - 15τ⁴ + 6τ⁵`: rest to rest with continuous acceleration.

use crate::scalar::Scalar;

/// Largest slope of the step: peak speed is this times distance over duration.
pub const PEAK_SLOPE: f32 = 1.875;

/// Value and slope at `tau`; clamped to rest outside [0, 1].
#[must_use]
pub fn smooth_step<S: Scalar>(tau: S) -> (S, S) {
    let t = tau.limit(S::zero(), S::one());
    let (t2, left) = (t * t, S::one() - t);
    let value = t2 * t * (S::lit(10.0) - t * (S::lit(15.0) - S::lit(6.0) * t));
    (value, S::lit(30.0) * t2 * left * left)
}
