//! What the accelerometer says of the link. `planar` section 7.1.

use crate::model::{PlanarImu, PlanarModel};
use crate::scalar::Scalar;

/// What one tick reads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HighGainInput<S> {
    /// Inertial reading, in the plane.
    pub imu: PlanarImu<S>,
    /// Thrust that acted when the accelerometer sampled, N.
    pub thrust_measured: S,
    /// Thrust now, N.
    pub thrust_now: S,
    /// Mean rate of the thrust since the last tick, N/s.
    pub thrust_rate: S,
}

/// The link force over the mass as a vector in the plane's body axes, m/s².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceReading<S> {
    /// Along x.
    pub x: S,
    /// Along z.
    pub z: S,
    /// Length: |fL|/m.
    pub size: S,
}

impl<S: Scalar> ForceReading<S> {
    /// Takes the thrust out of the specific force.
    #[must_use]
    pub fn new(model: &PlanarModel<S>, imu: &PlanarImu<S>, thrust: S) -> Self {
        let (x, z) = (imu.x, imu.z + thrust / model.mass);
        Self { x, z, size: (x * x + z * z).sqrt() }
    }

    /// Candidate for fL/m, m/s², and for φ+θ, rad, if the link force has this sign (the journal's form).
    #[must_use]
    pub fn signed(&self, sign: S) -> (S, S) {
        (sign * self.size, (sign * self.z).atan2(sign * self.x))
    }

    /// The conference's form of the same: angle candidate `k` (0 or 1) of φ+θ, in [0, 2π), and fL/(m l)
    /// with it, 1/s². Here the label goes with the angle, not with the sign of the force.
    #[must_use]
    pub fn by_angle(&self, model: &PlanarModel<S>, is_second: bool) -> (S, S) {
        let (quarter, turn) = (core::f64::consts::FRAC_PI_4, core::f64::consts::TAU);
        // The first candidate lies in the half turn that begins at -pi/4, where the signs change.
        let angle = self.z.atan2(self.x);
        let is_first_half = angle >= S::lit(-quarter) && angle < S::lit(3.0 * quarter);
        let sign = if is_first_half == is_second { -S::one() } else { S::one() };
        let (force, angle) = self.signed(sign);
        let angle = if angle < S::zero() { angle + S::lit(turn) } else { angle };
        (angle, force / model.length)
    }

    /// Part along the direction φ+θ, m/s²: fL/m with its sign where the angle is right.
    #[must_use]
    pub fn along(&self, angle: S) -> S {
        let (s, c) = angle.sin_cos();
        self.x * c + self.z * s
    }
}
