//! Where the error-state filter begins: the static solution of a quarter of a second's mean.
//! `localization` section 7.

use super::error_state::{ErrorState, ErrorStateMeasurement, STATES};
use super::static_solution::{cable_pull, solve_static};
use crate::frames::{Body, V3, World};
use crate::math::{GRAVITY, so3};
use crate::scalar::Scalar;
use heapless::Deque;
use nalgebra::{SMatrix, SVector};

/// Samples in the mean.
const SAMPLES: usize = 50;
/// Least height, m, pull, N, and sine of the elevation.
const HEIGHT: f64 = 0.6;
const TENSION: f64 = 0.2;
const SINE: f64 = 0.2;
/// 1 degree, rad.
const DEGREE: f64 = core::f64::consts::PI / 180.0;

/// Pull and altitude of the last samples, where both were finite.
#[derive(Clone, Debug, Default)]
pub struct ErrorStateStart<S: Scalar> {
    samples: Deque<Option<(V3<S>, S)>, SAMPLES>,
}

impl<S: Scalar> ErrorStateStart<S> {
    /// Takes one sample; the start once there are enough and they show a taut cable. `accel_noise` in m/s².
    pub fn step(
        &mut self,
        mass: S,
        accel_noise: S,
        z: &ErrorStateMeasurement<S>,
    ) -> Option<ErrorState<S>> {
        let before = self.samples.is_full().then(|| self.mean()).flatten();
        if self.samples.is_full() {
            self.samples.pop_front();
        }
        let pull = cable_pull(mass, &z.cable).0;
        let altitude = z.cable.altitude.filter(|h| h.is_finite());
        let altitude = altitude.filter(|_| pull.iter().all(|x| x.is_finite()));
        let _ = self.samples.push_back(altitude.map(|h| (pull, h)));
        let (pull, altitude) = before?;
        let at = solve_static(&World(pull), Some(altitude)).ok()?;
        let position = at.position.0;
        let length = so3::norm(&position);
        let is_clear = altitude >= S::lit(HEIGHT)
            && at.tension > S::lit(TENSION)
            && -position.z > S::lit(SINE) * length;
        if !is_clear || !z.cable.attitude.0.iter().all(|x| x.is_finite()) {
            return None;
        }
        let mean_noise = mass * accel_noise / S::lit(SAMPLES as f64).sqrt();
        let ratio = mean_noise / at.tension;
        let direction = (ratio * ratio + S::lit(0.05 * 0.05)).sqrt();
        let across = (length * direction * S::lit(1.5)).max(S::lit(0.3));
        let tension = mean_noise * S::lit(2.0) + mass * S::lit(0.025 * GRAVITY);
        let deviations = [
            (0, 2, across),
            (2, 1, S::lit(0.3)),
            (3, 3, S::one()),
            (6, 3, S::lit(DEGREE)),
            (9, 1, tension),
            (10, 1, S::lit(0.05)),
            (11, 3, S::lit(0.1)),
            (14, 3, S::lit(0.01)),
        ];
        let mut diagonal = SVector::<S, STATES>::zeros();
        for (from, count, deviation) in deviations {
            diagonal.iter_mut().skip(from).take(count).for_each(|x| *x = deviation * deviation);
        }
        Some(ErrorState {
            position: at.position,
            velocity: World(V3::zeros()),
            attitude: z.cable.attitude,
            tension: at.tension,
            thrust_scale: S::one(),
            accel_bias: Body(V3::zeros()),
            gyro_bias: Body(V3::zeros()),
            covariance: SMatrix::from_diagonal(&diagonal),
        })
    }

    /// Over what is there.
    fn mean(&self) -> Option<(V3<S>, S)> {
        let (mut pull, mut altitude, mut count) = (V3::zeros(), S::zero(), S::zero());
        for (s, h) in self.samples.iter().flatten() {
            pull += s;
            altitude += *h;
            count += S::one();
        }
        (count > S::zero()).then(|| (pull / count, altitude / count))
    }
}
