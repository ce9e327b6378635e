//! Everything at once: place, velocity, attitude, tension, thrust scale, biases and wind, from the IMU, the altimeter
//! and the line (`fullstate` sections 1 to 4, 18, 21 and 22).
//!
//! The filter does not integrate the accelerometer: it propagates with the model of the forces and takes the
//! accelerometer as a measurement of their sum. The tension is a fast random walk, so that what happens along the line
//! comes from the accelerometer through it; what happens across the line tells the line's direction, because the pull
//! is the largest force that is not along the thrust.
//!
//! The error state has 27 components in nine blocks of three (`covariance.rs`); a filter without a sensor offset uses
//! the first eight, one without gusts the first seven.

mod blocks;
mod covariance;
mod line_rows;
mod model;
mod noise;
mod predict;
mod push;
mod rows;
mod state;
mod update;

pub use covariance::{
    ACCEL_BIAS, BLOCKS, Blocks, Covariance, GUST, GYRO_BIAS, OFFSET, POSITION, SCALARS, TILT,
    VELOCITY, WIND,
};
pub use line_rows::DirectionEnd;
pub use model::{Chord, FullStateModel, GroundEnd, Load, Sag};
pub use noise::{Densities, GustNoise};
pub use push::PushDetector;
pub use state::{FullState, StartDeviation};

use crate::scalar::Scalar;
use noise::StepNoise;

/// Configuration; what moves is in [`FullState`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FullStateFilter<S: Scalar> {
    /// Vehicle and line.
    pub model: FullStateModel<S>,
    /// Of an innovation, in standard deviations.
    pub gate: S,
    /// Of the accelerometer's axes, (m/s²)².
    pub accel_variance: S,
    /// Of the push detector, m/s²/√s.
    pub push_strength: S,
    noise: StepNoise<S>,
    /// Blocks in use.
    used: usize,
}

impl<S: Scalar> FullStateFilter<S> {
    /// Of the given noise, stepping every `dt` s; with room for a sensor's offset if wanted.
    #[must_use]
    pub fn new(
        model: FullStateModel<S>,
        densities: &Densities,
        accel_sd: f64,
        has_offset: bool,
        dt: f64,
    ) -> Self {
        let used = if has_offset {
            BLOCKS
        } else if densities.gust.is_some() {
            OFFSET
        } else {
            GUST
        };
        Self {
            model,
            gate: S::lit(5.0),
            accel_variance: S::lit(accel_sd * accel_sd),
            push_strength: S::lit(3.0),
            noise: StepNoise::new(densities, dt),
            used,
        }
    }

    /// Blocks of the error state in use.
    #[must_use]
    pub fn used(&self) -> usize {
        self.used
    }
}
