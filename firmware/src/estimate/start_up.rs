//! Level and gyro bias at rest, `fullstate` section 6 step 1: motors off, a few seconds still.

use super::MahonyState;
use crate::frames::{Attitude, Body, V3};
use crate::scalar::Scalar;
use crate::signal::Imu;

/// Largest deviation of the gyro from its running mean that still counts as rest, rad/s (1 °/s, plus
/// the noise of one filtered sample).
const REST_RATE: f64 = 0.03;

/// Configuration.
#[derive(Clone, Copy, Debug)]
pub struct Leveller<S> {
    /// Samples to average.
    pub samples: u32,
    /// Heading of the nose from North, rad.
    pub heading: S,
}

/// Running means.
#[derive(Clone, Copy, Debug)]
pub struct LevelState<S: Scalar> {
    count: u32,
    gyro: V3<S>,
    accel: V3<S>,
}

impl<S: Scalar> Default for LevelState<S> {
    fn default() -> Self {
        Self { count: 0, gyro: V3::zeros(), accel: V3::zeros() }
    }
}

impl<S: Scalar> Leveller<S> {
    /// Takes one sample; the attitude once there are enough. A movement starts the average anew.
    pub fn step(&self, state: &mut LevelState<S>, imu: &Imu<S>) -> Option<MahonyState<S>> {
        let deviation = imu.gyro.0 - state.gyro;
        let limit = S::lit(REST_RATE);
        let moved =
            deviation.x.abs() > limit || deviation.y.abs() > limit || deviation.z.abs() > limit;
        if state.count > 50 && moved {
            *state = LevelState::default();
        }
        state.count += 1;
        // A running mean keeps fixed point within its range.
        let k = S::one() / S::from_f32(state.count as f32);
        state.gyro += (imu.gyro.0 - state.gyro) * k;
        state.accel += (imu.accel.0 - state.accel) * k;
        (state.count >= self.samples).then(|| {
            let f = &state.accel;
            let roll = (-f.y).atan2(-f.z);
            let pitch = f.x.atan2((f.y * f.y + f.z * f.z).sqrt());
            MahonyState {
                attitude: Attitude::from_euler(roll, pitch, self.heading),
                gyro_bias: Body(state.gyro),
            }
        })
    }
}
