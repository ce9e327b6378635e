//! The baseline: linear-quadratic feedback about the upright rod with flat feed-forward. `pendulum`
//! section 10.
//!
//! Five states on each horizontal axis: position and velocity error of the load, the rod's lean and its
//! rate, the lean of the thrust; the input is the rate of that lean. It knows nothing of disturbances.

use super::{PendulumCommand, PendulumLimits};
use crate::estimate::pendulum::PendulumEstimate;
use crate::frames::{Attitude, Body, V3};
use crate::math::so3;
use crate::model::PendulumModel;
use crate::scalar::Scalar;
use crate::signal::LoadReference;

/// Feedback gains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearGains<S> {
    /// Of position, velocity, lean of the rod, its rate, lean of the thrust.
    pub across: [S; 5],
    /// Of vertical position, 1/s², and velocity, 1/s.
    pub vertical: [S; 2],
    /// Whether the reference's accelerations feed forward.
    pub feeds_forward: bool,
}

/// The controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearPendulum<S> {
    /// Feedback.
    pub gains: LinearGains<S>,
    /// Vehicle and rod.
    pub model: PendulumModel<S>,
    /// Limits; E3 does not apply.
    pub limits: PendulumLimits<S>,
}

impl<S: Scalar> LinearPendulum<S> {
    /// One step. Nothing in it can fail; inputs that are not finite give a command that is not.
    #[must_use]
    pub fn step(
        &self,
        x: &PendulumEstimate<S>,
        attitude: &Attitude<S>,
        reference: &LoadReference<S>,
    ) -> PendulumCommand<S> {
        let [d0, d1, d2, d3, d4, d5] = &reference.0;
        let g = self.model.gravity;
        let forward = if self.gains.feeds_forward { S::one() } else { S::zero() };
        let rod_dot = so3::cross(&x.rod_rate.0, &x.rod.0);
        let down = so3::col_z(&attitude.0);
        // Linearised: load accel = g q, rod accel = stiffness (r + q).
        let stiffness = self.model.weight() / self.model.lever();
        let [kp, kv, kq, kw, kr] = self.gains.across;
        let axis = |i: fn(&V3<S>) -> S| {
            let rod = i(d2) / g * forward;
            let rod_rate = i(d3) / g * forward;
            let lean = i(d4) / (g * stiffness) * forward - rod;
            let lean_rate = i(d5) / (g * stiffness) * forward - rod_rate;
            lean_rate
                - kp * (i(&x.position.0) - i(d0))
                - kv * (i(&x.velocity.0) - i(d1))
                - kq * (i(&x.rod.0) - rod)
                - kw * (i(&rod_dot) - rod_rate)
                - kr * (i(&down) - lean)
        };
        let turn = V3::new(axis(|v| v.x), axis(|v| v.y), S::zero());
        let [kz, kd] = self.gains.vertical;
        let sink = kz * (x.position.0.z - d0.z) + kd * (x.velocity.0.z - d1.z) - d2.z * forward;
        let (least, most) = (self.limits.thrust_min, self.limits.thrust_max);
        let thrust = (self.model.total_mass() * (g + sink)).limit(least, most);
        let body = so3::transpose_mul(&attitude.0, &turn);
        let rate = V3::new(-body.y, body.x, S::zero());
        PendulumCommand {
            thrust,
            rate: Body(so3::limit_norm(rate, self.limits.rate_max)),
            down,
            force: down * -thrust,
        }
    }
}
