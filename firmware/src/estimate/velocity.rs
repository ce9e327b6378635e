//! Velocity: integrated specific force, pulled towards the position estimate (`fullstate` section 10).

use crate::frames::{V3, World};
use crate::math::GRAVITY;
use crate::scalar::Scalar;

/// Gain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VelocityFilter<S> {
    /// 1/s.
    pub gain: S,
}

/// Velocity and the position it implies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VelocityState<S: Scalar> {
    /// m/s.
    pub velocity: World<V3<S>>,
    position: World<V3<S>>,
}

impl<S: Scalar> VelocityState<S> {
    /// At rest at a place.
    #[must_use]
    pub fn at(position: World<V3<S>>) -> Self {
        Self { velocity: World(V3::zeros()), position }
    }
}

impl<S: Scalar> VelocityFilter<S> {
    /// One step over `dt` s. `specific_force` in world axes, m/s².
    pub fn step(
        &self,
        state: &mut VelocityState<S>,
        specific_force: &World<V3<S>>,
        position: &World<V3<S>>,
        dt: S,
    ) {
        let pull = (position.0 - state.position.0) * self.gain;
        let mut accel = specific_force.0;
        accel.z += S::lit(GRAVITY);
        state.velocity.0 += (accel + pull) * dt;
        state.position.0 += (state.velocity.0 + pull) * dt;
    }
}
