//! The observer's coordinates: `z = [φ+θ, φ', φ'']`. `planar` sections 7.2 and 7.3.

use crate::math::wrap_pi;
use crate::model::{PlanarModel, PlanarState};
use crate::scalar::Scalar;

/// State of one branch; what the non-linear term is bounded by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Canonical<S> {
    /// The model.
    pub model: PlanarModel<S>,
    /// Bound of |φ'|, rad/s.
    pub rate_max: S,
    /// Bound of |φ''|, rad/s².
    pub accel_max: S,
}

/// What drives the coordinates besides themselves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive<S> {
    /// Thrust, N.
    pub thrust: S,
    /// Thrust rate, N/s.
    pub thrust_rate: S,
    /// θ', rad/s.
    pub pitch_rate: S,
    /// Candidate for fL/m, m/s².
    pub force: S,
}

impl<S: Scalar> Canonical<S> {
    /// Wraps the angle and bounds the rest: the non-linear term is cubic in the rate.
    #[must_use]
    pub fn bounded(&self, [angle, rate, accel]: [S; 3]) -> [S; 3] {
        [wrap_pi(angle), rate.limit_abs(self.rate_max), accel.limit_abs(self.accel_max)]
    }

    /// φ''': `φ'³ - φ' fL/(m l) - a2 sin(φ+θ) θ' u1 + a2 cos(φ+θ) u1'`, rad/s³.
    #[must_use]
    pub fn jerk(&self, &[angle, rate, _]: &[S; 3], drive: &Drive<S>) -> S {
        let rate = rate.limit_abs(self.rate_max);
        let (s, c) = angle.sin_cos();
        let thrust = c * drive.thrust_rate - s * drive.pitch_rate * drive.thrust;
        rate * (rate * rate - drive.force / self.model.length) + self.model.a2 * thrust
    }

    /// The vehicle's state, and how far the cosine and sine of its elevation are from a unit vector
    /// (signed, relative): zero where a right branch has converged.
    #[must_use]
    pub fn to_state(
        &self,
        &[angle, rate, accel]: &[S; 3],
        force: S,
        thrust_now: S,
        thrust_measured: S,
        pitch_rate: S,
    ) -> (PlanarState<S>, S) {
        let m = &self.model;
        let (s, c) = angle.sin_cos();
        // a1 is negative, and its sign matters to the arc tangent.
        let cos = (accel - m.a2 * c * thrust_now) / m.a1;
        let sin = (force / m.length - rate * rate - m.a2 * s * thrust_measured) / m.a1;
        let elevation = sin.atan2(cos);
        let state =
            PlanarState { elevation, elevation_rate: rate, pitch: angle - elevation, pitch_rate };
        (state.wrapped(), (cos * cos + sin * sin).sqrt() - S::one())
    }
}
