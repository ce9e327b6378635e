//! Takes a reference up from where the load is. `pendulum` section 5, E2.
//!
//! Without it the article's initial error of 1.5 m asks for three times the hover thrust and 28 rad/s.

use crate::frames::{V3, World};
use crate::scalar::Scalar;
use crate::signal::LoadReference;
use crate::trajectory::Smoothness;

/// Initial offset from the reference, faded out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoftStart<S: Scalar> {
    position: V3<S>,
    velocity: V3<S>,
    duration: S,
}

impl<S: Scalar> SoftStart<S> {
    /// From the load's position, m, and velocity, m/s, to `reference` within `duration` s; a duration that
    /// is not positive means none.
    #[must_use]
    pub fn new(
        position: &World<V3<S>>,
        velocity: &World<V3<S>>,
        reference: &LoadReference<S>,
        duration: S,
    ) -> Self {
        Self {
            position: position.0 - reference.position().0,
            velocity: velocity.0 - reference.velocity().0,
            duration,
        }
    }

    /// What is left of the offset at a time since the start, s: a share and its first five derivatives.
    #[must_use]
    pub fn share(&self, time: S) -> [S; 6] {
        let per = S::one() / self.duration;
        let mut share: [S; 6] = Smoothness::C5.at(time * per);
        let mut factor = -S::one();
        for derivative in &mut share {
            *derivative *= factor;
            factor *= per;
        }
        if let Some(value) = share.first_mut() {
            *value += S::one();
        }
        share
    }

    /// `reference` with what is left of the offset at a time since the start, s.
    #[must_use]
    pub fn apply(&self, reference: &LoadReference<S>, time: S) -> LoadReference<S> {
        let mut out = *reference;
        if time >= self.duration {
            return out;
        }
        let offset = self.position + self.velocity * time;
        let (mut order, mut below) = (S::zero(), S::zero());
        for (derivative, share) in out.0.iter_mut().zip(self.share(time)) {
            *derivative += offset * share + self.velocity * (order * below);
            below = share;
            order += S::one();
        }
        out
    }
}
