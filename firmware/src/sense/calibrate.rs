//! Counts to SI units, minus offset, times scale.

use super::ImuScale;
use crate::frames::V3;
use crate::param::Params;
use crate::scalar::Scalar;

/// Scale and offset in body axes.
#[derive(Clone, Copy, Debug)]
pub struct Calibration<S: Scalar> {
    accel_scale: V3<S>,
    accel_bias: V3<S>,
    gyro_scale: S,
}

impl<S: Scalar> Calibration<S> {
    pub fn new(p: &Params, scale: ImuScale) -> Self {
        let v = |x: f32, y: f32, z: f32| V3::new(S::from_f32(x), S::from_f32(y), S::from_f32(z));
        let k = scale.accel;
        Self {
            accel_scale: v(k * p.accel_scale_x, k * p.accel_scale_y, k * p.accel_scale_z),
            accel_bias: v(p.accel_bias_x, p.accel_bias_y, p.accel_bias_z),
            gyro_scale: S::from_f32(scale.gyro),
        }
    }

    /// m/s².
    pub fn accel(&self, [x, y, z]: [i32; 3]) -> V3<S> {
        V3::new(
            count::<S>(x) * self.accel_scale.x,
            count::<S>(y) * self.accel_scale.y,
            count::<S>(z) * self.accel_scale.z,
        ) - self.accel_bias
    }

    /// rad/s; its bias belongs to the estimator.
    pub fn gyro(&self, [x, y, z]: [i32; 3]) -> V3<S> {
        V3::new(count::<S>(x), count::<S>(y), count::<S>(z)) * self.gyro_scale
    }
}

fn count<S: Scalar>(n: i32) -> S {
    S::from_f32(n as f32)
}
