//! The nine-state linear time-varying Kalman filter (6)–(12), (26) in discrete form.
//!
//! Exact for a rod that stands still over the period. The Riccati equation must not be integrated
//! explicitly: with the article's settings every explicit scheme diverges within a few steps.

use super::covariance::PendulumCovariance;
use crate::fault::{Fault, Invalid, all_finite, not_negative, positive};
use crate::frames::V3;
use crate::math::so3;
use crate::model::PendulumModel;
use crate::scalar::Scalar;

/// Continuous-time intensities and first variances, in the order direction, rate, disturbance over
/// vehicle mass times length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PendulumNoise<S: Scalar> {
    /// Of the process, per second.
    pub process: [V3<S>; 3],
    /// Of the measured direction, times seconds.
    pub rod: V3<S>,
    /// Of the virtual reading that the rod does not turn about itself, times seconds.
    pub spin: S,
    /// Variances at the start.
    pub start: [V3<S>; 3],
}

impl<S: Scalar> PendulumNoise<S> {
    fn with(process: [f64; 3], reading: f64) -> Self {
        let all = |x: f64| V3::repeat(S::lit(x));
        let [x, y, z] = process.map(S::lit);
        Self {
            process: [all(1e-7), all(1e-4), V3::new(x, y, z)],
            rod: all(reading),
            spin: S::lit(reading),
            start: [all(1e-4), all(1.0), all(1.0)],
        }
    }

    /// As printed for the article's simulation: slow.
    #[must_use]
    pub fn printed() -> Self {
        Self::with([10.0, 10.0, 0.1], 3e-5)
    }

    /// As printed for the article's experiment.
    #[must_use]
    pub fn printed_experiment() -> Self {
        Self::with([40.0, 40.0, 1e-5], 1e-5)
    }

    /// The printed process with a reading of 1e-6: the default.
    #[must_use]
    pub fn recommended() -> Self {
        Self::with([10.0, 10.0, 0.1], 1e-6)
    }

    /// Refuses what the filter cannot work with.
    ///
    /// # Errors
    /// [`Invalid`] naming the setting.
    pub fn validate(self) -> Result<Self, Invalid> {
        for x in self.process.iter().flatten() {
            not_negative("process", *x)?;
        }
        for x in self.start.iter().flatten() {
            positive("start", *x)?;
        }
        for x in self.rod.iter() {
            positive("rod", *x)?;
        }
        positive("spin", self.spin)?;
        Ok(self)
    }
}

/// What it believes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PendulumPosterior<S: Scalar> {
    /// Unit vector vehicle → load, world axes.
    pub rod: V3<S>,
    /// Angular rate of the rod, world axes, rad/s.
    pub rate: V3<S>,
    /// Disturbance over vehicle mass times length, world axes, rad/s².
    pub disturbance: V3<S>,
    /// Of these.
    pub covariance: PendulumCovariance<S>,
}

/// The filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PendulumFilter<S: Scalar> {
    /// Vehicle and rod.
    pub model: PendulumModel<S>,
    /// Intensities.
    pub noise: PendulumNoise<S>,
}

/// Smallest variance, and the largest of the vertical disturbance.
const VARIANCE_FLOOR: f64 = 1e-9;
const VERTICAL_CAP: f64 = 10.0;

impl<S: Scalar> PendulumFilter<S> {
    /// From the first measured direction, at rest and undisturbed, before any update.
    #[must_use]
    pub fn start(&self, rod: &V3<S>) -> PendulumPosterior<S> {
        let [direction, rate, disturbance] = &self.noise.start;
        PendulumPosterior {
            rod: *rod,
            rate: V3::zeros(),
            disturbance: V3::zeros(),
            covariance: PendulumCovariance::from_diagonal(direction, rate, disturbance),
        }
    }

    /// Carries the posterior over `dt` s, in which the rod stood at `rod` (any length near 1) and the force
    /// other than gravity, rod and disturbance was `force`, N, world axes.
    pub fn predict(&self, x: &mut PendulumPosterior<S>, rod: &V3<S>, force: &V3<S>, dt: S) {
        let n = rod * dt;
        let push = x.disturbance + force * (S::one() / self.model.lever());
        let kick = so3::cross(&n, &push);
        x.rod -= so3::cross(&n, &(x.rate - kick * S::lit(0.5)));
        x.rate -= kick;
        x.covariance = x.covariance.predicted(&n);
        let [direction, rate, disturbance] = self.noise.process;
        x.covariance.grow(&(direction * dt), &(rate * dt), &(disturbance * dt));
    }

    /// Corrects by a measured direction; `dt` s have passed since the one before.
    pub fn update(&self, x: &mut PendulumPosterior<S>, rod: &V3<S>, dt: S) {
        let per = S::one() / dt;
        let axes = [V3::x(), V3::y(), V3::z()];
        for (axis, intensity) in axes.into_iter().zip(self.noise.rod.iter()) {
            let column = x.covariance.times_rod(&axis);
            let [along, ..] = &column;
            let variance = so3::dot(&axis, along) + *intensity * per;
            x.take(&column, so3::dot(&axis, &(rod - x.rod)), variance);
        }
        // The rod does not turn about itself.
        let column = x.covariance.times_rate(rod);
        let [_, along, _] = &column;
        let variance = so3::dot(rod, along) + self.noise.spin * per;
        x.take(&column, -so3::dot(rod, &x.rate), variance);
        x.covariance.clean();
    }

    /// `dt` s ahead, and correction where a direction was measured so many s after the one before.
    ///
    /// # Errors
    /// [`Fault::NotFinite`] for an input or result that is not; the posterior is untouched.
    pub fn step(
        &self,
        x: &mut PendulumPosterior<S>,
        interval: (&V3<S>, &V3<S>),
        reading: Option<(&V3<S>, S)>,
        dt: S,
    ) -> Result<(), Fault> {
        let (rod, force) = interval;
        all_finite(&[rod.x, rod.y, rod.z, force.x, force.y, force.z, dt])?;
        let mut next = *x;
        self.predict(&mut next, rod, force, dt);
        if let Some((reading, period)) = reading {
            self.update(&mut next, reading, period);
        }
        next.covariance.bound(S::lit(VARIANCE_FLOOR), S::lit(VERTICAL_CAP));
        if !next.is_finite() {
            return Err(Fault::NotFinite);
        }
        *x = next;
        Ok(())
    }
}

impl<S: Scalar> PendulumPosterior<S> {
    fn take(&mut self, column: &[V3<S>; 3], innovation: S, variance: S) {
        let inverse = S::one() / variance;
        let gain = innovation * inverse;
        let [rod, rate, disturbance] = column;
        self.rod += rod * gain;
        self.rate += rate * gain;
        self.disturbance += disturbance * gain;
        self.covariance.shrink(column, inverse);
    }

    fn is_finite(&self) -> bool {
        [&self.rod, &self.rate, &self.disturbance].iter().all(|v| v.iter().all(|x| x.is_finite()))
            && self.covariance.is_finite()
    }
}
