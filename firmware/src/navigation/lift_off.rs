//! Has the vehicle left the ground? Contact is in no filter's model: they start when it has ended.

use crate::math::GRAVITY;
use crate::param::Params;
use crate::scalar::Scalar;

/// Height over the ground, m.
const HEIGHT: f64 = 0.12;
/// Or this long after thrust exceeded weight and half the tether's pull, in filter steps (0.25 s).
const STEPS: u16 = 62;

/// Configuration.
#[derive(Clone, Copy, Debug)]
pub(super) struct LiftOff<S> {
    ground_height: S,
    /// N.
    thrust: S,
}

/// How long the thrust would have carried it, steps.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LiftOffState {
    steps: u16,
}

impl<S: Scalar> LiftOff<S> {
    pub fn new(p: &Params) -> Self {
        let tension = S::from_f32(p.tension_low);
        Self {
            ground_height: S::from_f32(p.ground_height),
            thrust: S::from_f32(p.mass) * S::lit(GRAVITY) + tension * S::lit(0.5),
        }
    }

    /// One step with the height over the anchor, m, and the thrust, N.
    pub fn step(&self, state: &mut LiftOffState, height: S, thrust: S) -> bool {
        if thrust > self.thrust {
            state.steps += 1;
        }
        height > self.ground_height + S::lit(HEIGHT) || state.steps > STEPS
    }
}
