//! Without a tether: position, velocity and heading from motion capture.

use super::{TetherEstimator, TetherEstimatorState};
use crate::estimate::MahonyState;
use crate::estimate::capture::CaptureFilter;
use crate::frames::{Attitude, V3};
use crate::math::{so3, wrap_pi};
use crate::scalar::Scalar;
use crate::signal::Estimate;

/// Share of a heading error that a motion-capture sample takes away in the air: 0.5 s at 100 Hz.
const HEADING_SHARE: f64 = 0.02;

impl<S: Scalar> TetherEstimator<S> {
    pub(super) fn free_estimate(
        &self,
        capture: &CaptureFilter<S>,
        state: &TetherEstimatorState<S>,
        attitude: MahonyState<S>,
    ) -> Estimate<S> {
        let levelled = state.attitude.is_some();
        let known = state.capture.filter(|c| levelled && capture.is_fresh(c, state.now));
        Estimate {
            position: known.map(|c| c.position),
            velocity: known.map(|c| c.velocity),
            ..self.without_place(state, attitude)
        }
    }

    /// Turns the attitude about the vertical towards a measured heading: at once on the ground, slowly in
    /// the air.
    pub(super) fn turn(&self, state: &mut TetherEstimatorState<S>, heading: S) {
        let share = if state.filter.is_some() { S::lit(HEADING_SHARE) } else { S::one() };
        if let Some(attitude) = &mut state.attitude {
            let (.., yaw) = attitude.attitude.euler();
            let (sin, cos) = (wrap_pi(heading - yaw) * share).sin_cos();
            let down = V3::new(S::zero(), S::zero(), S::one());
            let turned = so3::axis_angle(&down, sin, cos) * attitude.attitude.0;
            attitude.attitude = Attitude(turned);
        }
    }
}
