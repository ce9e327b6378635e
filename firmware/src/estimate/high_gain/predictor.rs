//! Predict with the gyro's trapezium, correct with the fresh sample: the discrete form that the
//! controllers need. `planar` section 7.7.

use super::{Canonical, CorrectorGain, Drive};
use crate::math::wrap_pi;
use crate::scalar::Scalar;

/// Configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Predictor<S> {
    /// Coordinates.
    pub canonical: Canonical<S>,
    /// Period, s.
    pub period: S,
}

impl<S: Scalar> Predictor<S> {
    /// One period ahead. `drive`: thrust at mid-interval, mean thrust rate and pitch rate, mean force.
    #[must_use]
    pub fn predict(&self, z: &[S; 3], drive: &Drive<S>) -> [S; 3] {
        let h = self.period;
        let (half, eighth, sixth) = (S::lit(0.5), S::lit(0.125), S::lit(1.0 / 6.0));
        let [angle, rate, accel] = *z;
        let turn = rate + drive.pitch_rate;
        let middle = [
            angle + h * (half * turn + eighth * h * accel),
            (rate + half * h * accel).limit_abs(self.canonical.rate_max),
            accel,
        ];
        let jerk = self.canonical.jerk(&middle, drive);
        self.canonical.bounded([
            angle + h * (turn + h * (half * accel + h * sixth * jerk)),
            rate + h * (accel + h * half * jerk),
            accel + h * jerk,
        ])
    }

    /// Towards a measured φ+θ, rad.
    #[must_use]
    pub fn correct(&self, z: &[S; 3], angle: S, gain: &CorrectorGain<S>) -> [S; 3] {
        let [z1, z2, z3] = *z;
        let [l1, l2, l3] = gain.0;
        let innovation = wrap_pi(angle - z1);
        self.canonical.bounded([z1 + l1 * innovation, z2 + l2 * innovation, z3 + l3 * innovation])
    }
}
