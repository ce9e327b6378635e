//! How fast does it drift sideways when no filter of the position is believed? By inertia alone, for the few seconds
//! that a descent takes.

use crate::frames::{V3, World};
use crate::scalar::Scalar;

/// What a tilt error adds up to fades in this time, s.
const FADE: f64 = 4.0;
/// A velocity that is believed is followed in this time, s.
const FOLLOW: f64 = 0.3;

/// Level velocity, world axes, m/s.
#[derive(Clone, Copy, Debug)]
pub(super) struct Drift<S: Scalar> {
    pub velocity: World<V3<S>>,
}

impl<S: Scalar> Default for Drift<S> {
    fn default() -> Self {
        Self { velocity: World(V3::zeros()) }
    }
}

impl<S: Scalar> Drift<S> {
    /// Over `dt` s under a specific force, m/s².
    pub fn step(&mut self, force: &World<V3<S>>, dt: S) {
        let level = V3::new(force.0.x, force.0.y, S::zero());
        self.velocity.0 += level * dt - self.velocity.0 * (dt * S::lit(1.0 / FADE));
    }

    /// Somebody knows it, for a step of `dt` s.
    pub fn follow(&mut self, known: &World<V3<S>>, dt: S) {
        let level = V3::new(known.0.x, known.0.y, S::zero());
        self.velocity.0 += (level - self.velocity.0) * (dt * S::lit(1.0 / FOLLOW));
    }
}
