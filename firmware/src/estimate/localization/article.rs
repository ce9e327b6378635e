//! The published tuning of the position filters. `localization` section 4.

use crate::estimate::{Ekf4, Ekf4State};
use crate::frames::V3;
use crate::model::Line;
use crate::scalar::Scalar;
use nalgebra::{Matrix4, Vector4};

const PROCESS: f64 = 5e-3;
const ACCEL: f64 = 0.01;
const ALTITUDE: f64 = 0.1;
const START: [f64; 3] = [1.5, 2.5, 1.5];
const START_TENSION: f64 = 1.0;

/// How the printed process noise is meant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum NoiseReading<S> {
    /// Added at each step (31).
    #[default]
    PerStep,
    /// Times the period, s, as in the article's algorithm; four times the error.
    TimesPeriod(S),
}

/// The filter with the published covariances; with `known_tension` its three-state form.
#[must_use]
pub fn article_ekf<S: Scalar>(mass: S, reading: NoiseReading<S>, known_tension: bool) -> Ekf4<S> {
    let share = match reading {
        NoiseReading::PerStep => S::one(),
        NoiseReading::TimesPeriod(dt) => dt,
    };
    let q = S::lit(PROCESS) * share;
    Ekf4 {
        mass,
        line: Line(S::zero()),
        q_position: q,
        q_tension: if known_tension { S::zero() } else { q },
        r_accel: S::lit(ACCEL),
        r_altitude: S::lit(ALTITUDE),
        // The article measures no length.
        r_length: S::one(),
    }
}

/// Its published start, below the ground; `Some` tension starts the three-state form.
#[must_use]
pub fn article_start<S: Scalar>(known_tension: Option<S>) -> Ekf4State<S> {
    let [n, e, d] = START.map(S::lit);
    let place = V3::new(n, e, d);
    match known_tension {
        Some(tension) => Ekf4State::with_known_tension(place, S::one(), tension),
        None => Ekf4State {
            x: Vector4::new(n, e, d, S::lit(START_TENSION)),
            covariance: Matrix4::identity(),
        },
    }
}
