//! Can the position estimate be believed? Its innovations say so, and what it claims.

use crate::estimate::Innovations;
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::FilterHealth;
use crate::time::OUTER_DT;

/// A tension that no cable has, N.
const PUSH: f64 = -3.0;
/// A distance that no fixed length allows, as a share of it.
const FAR: f64 = 1.5;
/// Low-passes of the innovations, per reading.
const ACCEL_SHARE: f64 = 0.004;
const ALTITUDE_SHARE: f64 = 0.02;
const LENGTH_SHARE: f64 = 0.008;

/// Configuration.
#[derive(Clone, Copy, Debug)]
pub(super) struct Divergence<S> {
    ratio: S,
    steps: u16,
    /// m; `None` with a winch.
    fixed_length: Option<S>,
    is_rigid: bool,
}

/// What moves.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct DivergenceState<S> {
    pub health: FilterHealth<S>,
    failed_steps: u16,
}

impl<S: Scalar> Divergence<S> {
    pub fn new(p: &Params, fixed_length: Option<S>, is_rigid: bool) -> Self {
        Self {
            ratio: S::from_f32(p.divergence_ratio),
            steps: (p.divergence_time / OUTER_DT as f32) as u16,
            fixed_length,
            is_rigid,
        }
    }

    /// One step with the innovations, the tension, N, and the distance from the anchor, m.
    pub fn step(
        &self,
        state: &mut DivergenceState<S>,
        nu: &Innovations<S>,
        tension: S,
        distance: S,
    ) {
        let follow = |mean: &mut S, k: f64, sample: S| *mean += (sample - *mean) * S::lit(k);
        let health = &mut state.health;
        if let Some(accel) = nu.accel {
            follow(&mut health.accel, ACCEL_SHARE, accel);
        }
        if let Some(altitude) = nu.altitude {
            follow(&mut health.altitude, ALTITUDE_SHARE, altitude);
        }
        if let Some(length) = nu.length {
            follow(&mut health.length, LENGTH_SHARE, length);
        }
        let failed = nu.accel.is_none()
            || health.accel > self.ratio
            || health.altitude > self.ratio
            || health.length > self.ratio
            || (tension < S::lit(PUSH) && !self.is_rigid)
            || self.fixed_length.is_some_and(|length| distance > length * S::lit(FAR));
        state.failed_steps = if failed { state.failed_steps.saturating_add(1) } else { 0 };
    }

    /// The filter refused a step.
    pub fn refused(&self, state: &mut DivergenceState<S>) {
        state.failed_steps = state.failed_steps.saturating_add(1);
    }

    pub fn has_diverged(&self, state: &DivergenceState<S>) -> bool {
        state.failed_steps > self.steps
    }
}
