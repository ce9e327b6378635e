//! How the wanted force changes under the thrust really applied: `pendulum` section 6, second block.
//!
//! A backward difference instead of this needs thirty times the body rates under noise; leaving it out
//! ends in a limit cycle.

use super::PendulumGains;
use super::guidance::Guidance;
use crate::estimate::pendulum::PendulumEstimate;
use crate::frames::V3;
use crate::math::so3;
use crate::model::PendulumModel;
use crate::scalar::Scalar;
use crate::signal::LoadReference;

/// Derivatives along the estimated flow with a constant disturbance, world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceRate<S: Scalar> {
    /// Acceleration of the load, m/s².
    pub load_accel: V3<S>,
    /// Angular acceleration of the rod, rad/s².
    pub rod_accel: V3<S>,
    /// Derivative of the wanted force, N/s.
    pub force: V3<S>,
}

impl<S: Scalar> ForceRate<S> {
    /// `applied`: force of the thrust on the vehicle, N.
    #[must_use]
    pub fn at(
        gains: &PendulumGains<S>,
        model: &PendulumModel<S>,
        x: &PendulumEstimate<S>,
        reference: &LoadReference<S>,
        at: &Guidance<S>,
        applied: &V3<S>,
    ) -> Self {
        let [_, _, d2, d3, d4, d5] = &reference.0;
        let kp = |v: V3<S>| gains.position.component_mul(&v);
        let kv = |v: V3<S>| gains.velocity.component_mul(&v);
        let (q, om, b) = (&x.rod.0, &x.rod_rate.0, &x.disturbance.0);
        let (dot, cross) = (so3::dot::<S>, so3::cross::<S>);
        let (u, w, wp, qp) = (&at.pull, &at.pull_rate, &at.pull_accel, &at.rod_dot);
        let (qu, nu) = (at.along, at.growth);
        let two = S::lit(2.0);
        let lever = model.lever();
        let (i, i2) = (S::one() / at.magnitude, S::one() / (at.magnitude * at.magnitude));
        let kappa = gains.rod / gains.rod_weight * i;

        let push = applied + b;
        let a = model.load_accel(q, om, &push);
        let od = model.rod_accel(q, &push);
        let qpp = cross(&od, q) + cross(om, qp);
        let u1 = kp(at.velocity_error) + kv(a - d2) - d3;
        let c1 = dot(qp, u) + dot(q, &u1);
        let as1 = qp * -qu - q * c1;
        let w1 = kp(a - d2) + kv(as1 - d3) - d4;
        let c2 = dot(qp, u) + dot(q, w);
        let c3 = dot(&qpp, u) + dot(qp, &u1) + dot(qp, w) + dot(q, &w1);
        let wp1 = kp(as1 - d3) + kv(qpp * -qu - qp * (c1 + c2) - q * c3 - d4) - d5;
        let mu = dot(u, &u1) * i2;
        let nu1 = (dot(&u1, w) + dot(u, &w1)) * i2 - two * nu * mu;

        let (lean, swing) = (cross(q, u), cross(u, w));
        let lean1 = cross(qp, u) + cross(q, &u1);
        let a1 = cross(qp, u) + cross(q, w) - lean * nu;
        let a1d = cross(&qpp, u) + cross(qp, &u1) + cross(qp, w) + cross(q, &w1)
            - lean * nu1
            - lean1 * nu;
        let a2 = cross(u, wp) - swing * (two * nu);
        let g1 = cross(&u1, w) + cross(u, &w1);
        let a2d = cross(&u1, wp) + cross(u, &wp1) - swing * (two * nu1) - g1 * (two * nu);
        let rate_wanted_dot = (a1d - a1 * mu) * -kappa + (a2d - a2 * (two * mu)) * i2;
        let rate_wanted = (lean1 - lean * mu) * -kappa + (g1 - swing * (two * mu)) * i2;

        let off = om - at.rate_wanted;
        let off1 = od - rate_wanted;
        let rate_error = cross(qp, &off) + cross(q, &off1);
        let rate_error_dot = cross(&qpp, &off) + cross(qp, &off1)
            - cross(qp, &at.rate_wanted_dot)
            - cross(q, &rate_wanted_dot);
        let rod_wanted = (u1 - u * mu) * -i;
        let turn = rate_error_dot
            + rod_wanted * (gains.rod_weight / gains.rate_weight)
            + rate_error * (gains.rate / gains.rate_weight);
        let along = two * lever * dot(om, &od) - model.total_mass() * c1 - dot(qp, b);
        let across = turn - q * (dot(qp, &at.turn) + dot(q, &turn)) - qp * dot(q, &at.turn);
        let force = q * along + qp * at.force_along - across * lever;
        Self { load_accel: a, rod_accel: od, force }
    }

    /// Derivative of the direction in which the vehicle's down axis is wanted, 1/s, for that direction and
    /// the wanted thrust, N.
    #[must_use]
    pub fn down_wanted(&self, down: &V3<S>, thrust: S) -> V3<S> {
        so3::reject(&self.force, down) * (-S::one() / thrust)
    }
}
