//! Inertial samples to filter steps: means over as many as a step has.

use crate::frames::{Body, V3};
use crate::scalar::Scalar;
use crate::signal::Imu;
use crate::time::DECIMATION;

/// Sums over the samples of one step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Decimator<S: Scalar> {
    count: u8,
    gyro: V3<S>,
    accel: V3<S>,
    thrust: S,
}

impl<S: Scalar> Default for Decimator<S> {
    fn default() -> Self {
        Self { count: 0, gyro: V3::zeros(), accel: V3::zeros(), thrust: S::zero() }
    }
}

impl<S: Scalar> Decimator<S> {
    /// Adds a sample and the thrust then, N; both averaged when the step is full.
    pub fn add(&mut self, imu: &Imu<S>, thrust: S) -> Option<(Imu<S>, S)> {
        self.count += 1;
        self.gyro += imu.gyro.0;
        self.accel += imu.accel.0;
        self.thrust += thrust;
        if self.count < DECIMATION {
            return None;
        }
        let mean = S::lit(1.0 / DECIMATION as f64);
        let imu = Imu { gyro: Body(self.gyro * mean), accel: Body(self.accel * mean) };
        let thrust = self.thrust * mean;
        *self = Self::default();
        Some((imu, thrust))
    }
}
