//! What the error-state filter believes of its sensors and of the world.

use crate::math::GRAVITY;
use crate::scalar::Scalar;

/// Standard deviations: of readings, and of random walks per square root of a second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorStateNoise<S> {
    /// Specific force, m/s².
    pub accel: S,
    /// rad/s.
    pub gyro: S,
    /// m.
    pub altitude: S,
    /// Each axis, rad.
    pub attitude: S,
    /// Cable length, m.
    pub length: S,
    /// N/√s.
    pub tension_walk: S,
    /// 1/√s.
    pub thrust_walk: S,
    /// m/s²/√s.
    pub accel_bias_walk: S,
    /// rad/s/√s.
    pub gyro_bias_walk: S,
}

impl<S: Scalar> ErrorStateNoise<S> {
    /// Of the specification's simulation: 0.1 g, 0.1 °/s, 0.1 m, 0.1°, 0.02 m.
    #[must_use]
    pub fn simulated() -> Self {
        const TENTH_DEGREE: f64 = 0.1 * core::f64::consts::PI / 180.0;
        Self {
            accel: S::lit(0.1 * GRAVITY),
            gyro: S::lit(TENTH_DEGREE),
            altitude: S::lit(0.1),
            attitude: S::lit(TENTH_DEGREE),
            length: S::lit(0.02),
            tension_walk: S::lit(0.02),
            thrust_walk: S::lit(1e-4),
            accel_bias_walk: S::lit(1e-4),
            gyro_bias_walk: S::lit(1e-5),
        }
    }
}
