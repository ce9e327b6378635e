//! How much do the rotors shake the accelerometer?

use crate::frames::V3;
use crate::math::so3;
use crate::scalar::Scalar;

/// Share of a step at 250 Hz: what is slower than about 20 Hz is movement, and the mean is over half a second.
const SLOW: f64 = 0.4;
const MEAN: f64 = 0.008;

/// What shakes, on the mean.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shake<S: Scalar> {
    slow: V3<S>,
    /// Of each axis, m²/s⁴.
    pub variance: S,
}

impl<S: Scalar> Default for Shake<S> {
    fn default() -> Self {
        Self { slow: V3::zeros(), variance: S::zero() }
    }
}

impl<S: Scalar> Shake<S> {
    /// A step's mean of the accelerometer, m/s².
    pub fn step(&mut self, accel: &V3<S>) {
        self.slow += (accel - self.slow) * S::lit(SLOW);
        let fast = accel - self.slow;
        let size = so3::dot(&fast, &fast) * S::lit(1.0 / 3.0);
        self.variance += (size.min(S::lit(2000.0)) - self.variance) * S::lit(MEAN);
    }
}
