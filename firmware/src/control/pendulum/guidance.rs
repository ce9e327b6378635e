//! The force that the load's error asks for: `pendulum` section 6, first block.
//!
//! A dot in these comments is the derivative along the flow with the force along the rod as wanted and
//! the rod's acceleration left out; the disturbance and the rod's rate cancel in it.

use super::PendulumGains;
use crate::estimate::pendulum::PendulumEstimate;
use crate::frames::V3;
use crate::math::so3;
use crate::model::PendulumModel;
use crate::scalar::Scalar;
use crate::signal::LoadReference;

/// |ξ|/mT is not taken smaller than this, m/s²: it vanishes with the load far above its reference.
const PULL_FLOOR: f64 = 0.5;

/// Every quantity on the way to the wanted force, world axes. The article's letter in brackets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guidance<S: Scalar> {
    /// Position error (z_p), m.
    pub position_error: V3<S>,
    /// Velocity error (z_v), m/s.
    pub velocity_error: V3<S>,
    /// ξ/mT (34), m/s².
    pub pull: V3<S>,
    /// Its length (n), m/s².
    pub magnitude: S,
    /// Wanted direction of the rod (q_d) (40).
    pub rod_wanted: V3<S>,
    /// q·pull, m/s².
    pub along: S,
    /// Acceleration of the load, m/s².
    pub accel: V3<S>,
    /// Dot of `pull`, m/s³.
    pub pull_rate: V3<S>,
    /// Relative growth of the magnitude (ν), 1/s.
    pub growth: S,
    /// Wanted rate of the rod (ω_d) (47), rad/s.
    pub rate_wanted: V3<S>,
    /// Derivative of the rod's direction, 1/s.
    pub rod_dot: V3<S>,
    /// Dot of `pull_rate`, m/s⁴.
    pub pull_accel: V3<S>,
    /// Dot of `rate_wanted`, rad/s².
    pub rate_wanted_dot: V3<S>,
    /// Rate error across the rod (z_ω) (46), rad/s.
    pub rate_error: V3<S>,
    /// Dot of `rate_error`, without the disturbance, rad/s².
    pub rate_error_dot: V3<S>,
    /// Bracket of (51), rad/s².
    pub turn: V3<S>,
    /// Wanted force along the rod over the rod (33), N.
    pub force_along: S,
    /// Wanted force across the rod (51), N.
    pub force_across: V3<S>,
    /// Wanted force, N.
    pub force: V3<S>,
}

impl<S: Scalar> Guidance<S> {
    /// At an estimate, for a reference.
    #[must_use]
    pub fn at(
        gains: &PendulumGains<S>,
        model: &PendulumModel<S>,
        x: &PendulumEstimate<S>,
        reference: &LoadReference<S>,
    ) -> Self {
        let [d0, d1, d2, d3, d4, _] = &reference.0;
        let kp = |v: V3<S>| gains.position.component_mul(&v);
        let kv = |v: V3<S>| gains.velocity.component_mul(&v);
        let (q, om, b) = (&x.rod.0, &x.rod_rate.0, &x.disturbance.0);
        let (dot, cross) = (so3::dot::<S>, so3::cross::<S>);
        let gravity = V3::new(S::zero(), S::zero(), model.gravity);
        let two = S::lit(2.0);
        let lever = model.lever();

        let position_error = x.position.0 - d0;
        let velocity_error = x.velocity.0 - d1;
        let pull = kp(position_error) + kv(velocity_error) + gravity - d2;
        let magnitude = so3::norm(&pull).max(S::lit(PULL_FLOOR));
        let (i, i2) = (S::one() / magnitude, S::one() / (magnitude * magnitude));
        let kappa = gains.rod / gains.rod_weight * i;
        let rod_wanted = pull * -i;
        let along = dot(q, &pull);
        let accel = gravity - q * along;
        let pull_rate = kp(velocity_error) + kv(accel - d2) - d3;
        let growth = dot(&pull, &pull_rate) * i2;
        let swing = cross(&pull, &pull_rate);
        let lean = cross(q, &pull);
        let rate_wanted = lean * -kappa + swing * i2;
        let rod_dot = cross(om, q);
        let along_rate = dot(&rod_dot, &pull) + dot(q, &pull_rate);
        let pull_accel = kp(accel - d2) + kv(rod_dot * -along - q * along_rate - d3) - d4;
        let lean_rate = cross(&rod_dot, &pull) + cross(q, &pull_rate) - lean * growth;
        let swing_rate = cross(&pull, &pull_accel) - swing * (two * growth);
        let rate_wanted_dot = lean_rate * -kappa + swing_rate * i2;
        let off = om - rate_wanted;
        let rate_error = cross(q, &off);
        let rate_error_dot = cross(&rod_dot, &off) - cross(q, &rate_wanted_dot);
        let turn = rate_error_dot
            + rod_wanted * (gains.rod_weight / gains.rate_weight)
            + rate_error * (gains.rate / gains.rate_weight)
            + b * (S::one() / lever);
        let force_along = lever * dot(om, om) - model.total_mass() * along - dot(q, b);
        let force_across = so3::reject(&turn, q) * -lever;
        Self {
            position_error,
            velocity_error,
            pull,
            magnitude,
            rod_wanted,
            along,
            accel,
            pull_rate,
            growth,
            rate_wanted,
            rod_dot,
            pull_accel,
            rate_wanted_dot,
            rate_error,
            rate_error_dot,
            turn,
            force_along,
            force_across,
            force: q * force_along + force_across,
        }
    }
}
