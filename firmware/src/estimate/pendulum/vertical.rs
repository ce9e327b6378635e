//! The vertical disturbance from the load's vertical velocity. `pendulum` section 4, E1.

use crate::frames::V3;
use crate::model::PendulumModel;
use crate::scalar::Scalar;

/// The observer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VerticalDisturbance<S> {
    /// Bandwidth, rad/s.
    pub bandwidth: S,
}

/// What moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VerticalDisturbanceState<S> {
    /// Vertical velocity of the load, down, m/s.
    pub velocity: S,
    /// Vertical disturbance, down, N.
    pub force: S,
}

/// Least square of the rod's vertical share in the division.
const UPRIGHT_FLOOR: f64 = 0.25;

impl<S: Scalar> VerticalDisturbance<S> {
    /// `dt` s after the last: measured vertical velocity of the load, m/s, the rod and its rate, the known
    /// force on the vehicle, N, and the disturbance, N, whose vertical part is replaced by this observer's.
    pub fn step(
        &self,
        model: &PendulumModel<S>,
        state: &mut VerticalDisturbanceState<S>,
        velocity: S,
        (rod, rod_rate): (&V3<S>, &V3<S>),
        (force, disturbance): (&V3<S>, &V3<S>),
        dt: S,
    ) {
        let push = force + V3::new(disturbance.x, disturbance.y, state.force);
        let predicted = state.velocity + model.load_accel(rod, rod_rate, &push).z * dt;
        let error = velocity - predicted;
        let w = self.bandwidth;
        let share = (rod.z * rod.z).max(S::lit(UPRIGHT_FLOOR));
        state.velocity = predicted + w * dt * error * S::lit(2.0);
        state.force += w * w * dt * model.total_mass() / share * error;
    }
}
