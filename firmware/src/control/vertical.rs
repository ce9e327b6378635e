//! Which thrust keeps that climb rate? For Altitude and Descent, which do not know their position.

use crate::math::GRAVITY;
use crate::scalar::Scalar;

/// Gains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClimbLoop<S> {
    /// kg.
    pub mass: S,
    /// 1/s.
    pub kp: S,
    /// 1/s².
    pub ki: S,
    /// Largest integral, m/s². It must hold the tether's pull and a wrong thrust scale.
    pub integral_max: S,
    /// N.
    pub thrust_min: S,
    /// N.
    pub thrust_max: S,
}

/// The integral, m/s².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ClimbState<S> {
    /// Upwards.
    pub integral: S,
}

impl<S: Scalar> ClimbLoop<S> {
    /// The state in which this upward force, N, is what keeps the climb rate.
    #[must_use]
    pub fn holding(&self, force: S) -> ClimbState<S> {
        ClimbState { integral: (force / self.mass - S::lit(GRAVITY)).limit_abs(self.integral_max) }
    }

    /// Upward force, N, over `dt` s. Rates in m/s, up.
    pub fn step(&self, state: &mut ClimbState<S>, wanted: S, climb: S, dt: S) -> S {
        let error = (wanted - climb).limit_abs(S::one());
        let base = self.mass * (S::lit(GRAVITY) + self.kp * error + state.integral);
        let force = base.limit(self.thrust_min, self.thrust_max);
        let is_outward = (base > self.thrust_max && error > S::zero())
            || (base < self.thrust_min && error < S::zero());
        if !is_outward {
            state.integral = (state.integral + self.ki * error * dt).limit_abs(self.integral_max);
        }
        force
    }
}
