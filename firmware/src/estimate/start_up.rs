//! Level and gyro bias at rest, `fullstate` section 6 step 1: motors off, a few seconds still.

use super::MahonyState;
use crate::frames::{Attitude, Body, V3};
use crate::math::remainder::{FINE, Remainder};
use crate::scalar::Scalar;
use crate::signal::Imu;

/// Largest deviation of the gyro, low-passed over some 50 samples, from its running mean that still
/// counts as rest, rad/s. The low-pass lets a noisy sensor level too.
const REST_RATE: f64 = 0.02;
const RECENT_SHARE: f64 = 0.02;

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
    recent: V3<S>,
    gyro: V3<S>,
    accel: V3<S>,
    /// Of both.
    rest: [Remainder<S>; 2],
}

impl<S: Scalar> Default for LevelState<S> {
    fn default() -> Self {
        let o = V3::zeros();
        Self { count: 0, recent: o, gyro: o, accel: o, rest: Default::default() }
    }
}

impl<S: Scalar> Leveller<S> {
    /// Takes one sample; the attitude once there are enough. A movement starts the average anew.
    pub fn step(&self, state: &mut LevelState<S>, imu: &Imu<S>) -> Option<MahonyState<S>> {
        if state.count == 0 {
            state.recent = imu.gyro.0;
        }
        state.recent += (imu.gyro.0 - state.recent) * S::lit(RECENT_SHARE);
        let deviation = state.recent - state.gyro;
        let limit = S::lit(REST_RATE);
        let moved =
            deviation.x.abs() > limit || deviation.y.abs() > limit || deviation.z.abs() > limit;
        if state.count > 50 && moved {
            *state = LevelState::default();
        }
        state.count += 1;
        // A running mean keeps fixed point within its range.
        let k = S::lit(FINE) / S::from_f32(state.count as f32);
        let [gyro, accel] = &mut state.rest;
        state.gyro += gyro.take((imu.gyro.0 - state.gyro) * k);
        state.accel += accel.take((imu.accel.0 - state.accel) * k);
        (state.count >= self.samples).then(|| {
            let f = &state.accel;
            let roll = (-f.y).atan2(-f.z);
            let pitch = f.x.atan2((f.y * f.y + f.z * f.z).sqrt());
            MahonyState::new(Attitude::from_euler(roll, pitch, self.heading), Body(state.gyro))
        })
    }
}
