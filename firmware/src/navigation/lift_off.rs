//! Has the vehicle left the ground? Contact is in no filter's model: they start when it has ended.

use crate::frames::{V3, World};
use crate::math::GRAVITY;
use crate::param::Params;
use crate::scalar::Scalar;
use crate::time::OUTER_DT;

/// Height over the ground, m.
const HEIGHT: f64 = 0.12;
/// Or this long after thrust exceeded weight and half the tether's pull, in filter steps (0.25 s).
const STEPS: u16 = 62;

/// Share of the weight.
const LIGHT: f64 = 0.3;

/// Configuration.
#[derive(Clone, Copy, Debug)]
pub(super) struct LiftOff<S> {
    ground_height: S,
    /// N.
    thrust: S,
    /// N: with less it stands firmly.
    light: S,
}

/// How long the thrust would have carried it, steps, and how it slid meanwhile.
#[derive(Clone, Copy, Debug)]
pub(super) struct LiftOffState<S: Scalar> {
    steps: u16,
    /// From the place where it stood, level, m.
    pub slid: V3<S>,
    /// Level, m/s.
    pub velocity: V3<S>,
}

impl<S: Scalar> Default for LiftOffState<S> {
    fn default() -> Self {
        Self { steps: 0, slid: V3::zeros(), velocity: V3::zeros() }
    }
}

impl<S: Scalar> LiftOff<S> {
    pub fn new(p: &Params) -> Self {
        let (tension, weight) = (S::from_f32(p.tension_low), S::from_f32(p.mass) * S::lit(GRAVITY));
        Self {
            ground_height: S::from_f32(p.ground_height),
            thrust: weight + tension * S::lit(0.5),
            light: weight * S::lit(LIGHT),
        }
    }

    /// Whether it does not stand firmly, with this thrust, N.
    pub fn is_light(&self, thrust: S) -> bool {
        thrust > self.light
    }

    /// One step with the height over the anchor, m, the thrust, N, and the specific force, world axes.
    ///
    /// A vehicle that is light on its feet slides in the wind. No force model holds then, but what the accelerometer
    /// shows is all there is, and for a second it can be integrated.
    pub fn step(
        &self,
        state: &mut LiftOffState<S>,
        height: S,
        thrust: S,
        force: &World<V3<S>>,
    ) -> bool {
        if self.is_light(thrust) {
            let dt = S::lit(OUTER_DT);
            state.velocity += V3::new(force.0.x, force.0.y, S::zero()) * dt;
            state.slid += state.velocity * dt;
        }
        if thrust > self.thrust {
            state.steps += 1;
        }
        height > self.ground_height + S::lit(HEIGHT) || state.steps > STEPS
    }
}
