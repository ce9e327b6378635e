//! A push that nothing modelled explains: open the gusts' variance at once (`fullstate` section 18).
//!
//! Without it a push of 3 N for half a second loses most flights: the filter explains it by a wrong attitude.

use super::FullStateFilter;
use super::covariance::GUST;
use super::state::FullState;
use crate::frames::V3;
use crate::scalar::Scalar;

/// Smoothed squared innovation of the accelerometer; 1 in a healthy flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PushDetector<S> {
    /// Mean of the three rows.
    pub level: S,
}

impl<S: Scalar> Default for PushDetector<S> {
    fn default() -> Self {
        Self { level: S::one() }
    }
}

/// Share of a new sample at 250 Hz: 0.05 s.
const SHARE: f64 = 0.08;
/// A level that healthy flights do not reach.
const THRESHOLD: f64 = 2.5;
/// Of the excess over it.
const EXCESS_MAX: f64 = 10.0;

impl<S: Scalar> PushDetector<S> {
    /// Takes the accelerometer's squared innovation, the sum of its rows. Returns the variance to add to the gusts'
    /// components, (m/s²)².
    pub fn step(&mut self, nis: S, strength: S, dt: S) -> Option<V3<S>> {
        self.level += (nis / S::lit(3.0) - self.level) * S::lit(SHARE);
        let excess = (self.level - S::lit(THRESHOLD)).min(S::lit(EXCESS_MAX));
        (excess > S::zero()).then(|| {
            let level = strength * strength * dt * excess;
            V3::new(level, level, level * S::lit(0.25))
        })
    }
}

impl<S: Scalar> FullStateFilter<S> {
    /// Opens the gusts' variance after the accelerometer's rows, if they do not fit.
    pub fn boost(&self, state: &mut FullState<S>, detector: &mut PushDetector<S>, nis: S) {
        if self.noise.gust.is_none() {
            return;
        }
        if let Some(variance) = detector.step(nis, self.push_strength, self.noise.dt) {
            state.covariance.inflate(GUST, &variance);
        }
    }
}
