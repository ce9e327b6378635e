//! Body rates that turn the thrust towards the wanted force: (50) and (56), `pendulum` section 6, last
//! block.

use super::PendulumGains;
use super::guidance::Guidance;
use crate::estimate::pendulum::PendulumEstimate;
use crate::frames::{Attitude, Body, M3, V3};
use crate::math::so3;
use crate::model::PendulumModel;
use crate::scalar::Scalar;

fn outer<S: Scalar>(a: &V3<S>, b: &V3<S>) -> M3<S> {
    a * b.transpose()
}

/// Derivative of the wanted rod rate by the load's velocity, 1/m.
#[must_use]
pub fn rate_wanted_by_velocity<S: Scalar>(
    gains: &PendulumGains<S>,
    rod: &V3<S>,
    at: &Guidance<S>,
) -> M3<S> {
    let (kp, kv) = (M3::from_diagonal(&gains.position), M3::from_diagonal(&gains.velocity));
    let (u, w) = (&at.pull, &at.pull_rate);
    let (i, i2) = (S::one() / at.magnitude, S::one() / (at.magnitude * at.magnitude));
    let kappa = gains.rod / gains.rod_weight * i;
    let grown = gains.velocity.component_mul(u) * i2;
    let damped_rod = gains.velocity.component_mul(rod);
    let lean = so3::skew(rod) * kv - outer(&so3::cross(rod, u), &grown);
    let swing = so3::skew(u) * (kp - outer(&damped_rod, &damped_rod)) - so3::skew(w) * kv;
    lean * -kappa + swing * i2 - outer(&so3::cross(u, w), &grown) * (S::lit(2.0) * i2)
}

/// δ without the total mass (50), m/s.
#[must_use]
pub fn cross_term<S: Scalar>(gains: &PendulumGains<S>, rod: &V3<S>, at: &Guidance<S>) -> V3<S> {
    let by_velocity = rate_wanted_by_velocity(gains, rod, at);
    let wanted = &at.rod_wanted;
    let lean = so3::cross(wanted, &so3::cross(wanted, rod));
    at.position_error * gains.coupling + at.velocity_error
        - gains.velocity.component_mul(&lean) * (gains.rod_weight / at.magnitude)
        + so3::transpose_mul(&by_velocity, &so3::cross(rod, &at.rate_error)) * gains.rate_weight
}

/// Roll and pitch rate, rad/s; the yaw rate is free and stays zero. `down` and `down_rate`: wanted
/// direction of the body's down axis and its derivative, world axes; `thrust`: the wanted one, N.
#[must_use]
pub fn body_rate<S: Scalar>(
    gains: &PendulumGains<S>,
    model: &PendulumModel<S>,
    (x, attitude): (&PendulumEstimate<S>, &Attitude<S>),
    at: &Guidance<S>,
    (down, down_rate, thrust): (&V3<S>, &V3<S>, S),
) -> Body<V3<S>> {
    let q = &x.rod.0;
    let delta = cross_term(gains, q, at);
    let push = q * (so3::dot(q, &delta) / model.total_mass())
        + at.rate_error * (gains.rate_weight / model.lever());
    let to_body = |v: &V3<S>| so3::transpose_mul(&attitude.0, v);
    let turn = to_body(&so3::cross(down, down_rate));
    let lean = to_body(down) * gains.attitude + to_body(&push) * thrust;
    let lean = lean * (S::one() / gains.attitude_weight);
    Body(V3::new(turn.x - lean.y, turn.y + lean.x, S::zero()))
}
