//! What the inertial sensor feels on the whole, vibration averaged out: for the detector of the ground.

use crate::frames::{Body, V3};
use crate::math::so3;
use crate::scalar::Scalar;
use crate::signal::Imu;

/// Share of a sample at 1 kHz: 2 Hz.
const SHARE: f64 = 0.0125;

/// Low-passed vectors, so that what shakes to and fro adds up to nothing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Felt<S: Scalar> {
    accel: Body<V3<S>>,
    gyro: Body<V3<S>>,
}

impl<S: Scalar> Default for Felt<S> {
    fn default() -> Self {
        Self { accel: Body(V3::zeros()), gyro: Body(V3::zeros()) }
    }
}

impl<S: Scalar> Felt<S> {
    /// One inertial sample.
    pub fn step(&mut self, imu: &Imu<S>) {
        let share = S::lit(SHARE);
        self.accel.0 += (imu.accel.0 - self.accel.0) * share;
        self.gyro.0 += (imu.gyro.0 - self.gyro.0) * share;
    }

    /// Size of the specific force, m/s².
    pub fn force(&self) -> S {
        so3::norm(&self.accel.0)
    }

    /// Size of the body rate beside a bias, rad/s.
    pub fn turning(&self, bias: &Body<V3<S>>) -> S {
        so3::norm(&(self.gyro.0 - bias.0))
    }
}
