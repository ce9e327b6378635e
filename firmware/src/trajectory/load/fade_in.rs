//! From the straight motion of the moment into a moving reference, with five continuous derivatives.
//!
//! Departure from `pendulum` section 5, E2: that fades an offset of position and velocity, and the
//! reference's acceleration is there from the first moment; on a circle at 1 m/s it throws the rod 20° over.
//! Here the whole difference fades.

use super::SoftStart;
use crate::frames::{V3, World};
use crate::scalar::Scalar;
use crate::signal::LoadReference;

/// Pascal's triangle up to the fifth row.
const BINOMIALS: [[f64; 6]; 6] = [
    [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [1.0, 1.0, 0.0, 0.0, 0.0, 0.0],
    [1.0, 2.0, 1.0, 0.0, 0.0, 0.0],
    [1.0, 3.0, 3.0, 1.0, 0.0, 0.0],
    [1.0, 4.0, 6.0, 4.0, 1.0, 0.0],
    [1.0, 5.0, 10.0, 10.0, 5.0, 1.0],
];

/// A straight motion that fades out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FadeIn<S: Scalar> {
    position: V3<S>,
    velocity: V3<S>,
    fading: SoftStart<S>,
    duration: S,
}

impl<S: Scalar> FadeIn<S> {
    /// From the load's position, m, and velocity, m/s, within `duration` s.
    #[must_use]
    pub fn new(position: &World<V3<S>>, velocity: &World<V3<S>>, duration: S) -> Self {
        let nowhere = LoadReference::at_rest(World(V3::zeros()));
        let fading = SoftStart::new(position, velocity, &nowhere, duration);
        Self { position: position.0, velocity: velocity.0, fading, duration }
    }

    /// s.
    #[must_use]
    pub fn duration(&self) -> S {
        self.duration
    }

    /// `reference` with what is left of the first motion at a time since the start, s.
    #[must_use]
    pub fn apply(&self, reference: &LoadReference<S>, time: S) -> LoadReference<S> {
        let mut out = *reference;
        if time >= self.duration {
            return out;
        }
        let share = self.fading.share(time);
        let mut difference = reference.0.map(|d| -d);
        let motion = [self.position + self.velocity * time, self.velocity];
        for (difference, motion) in difference.iter_mut().zip(motion) {
            *difference += motion;
        }
        // Leibniz.
        for ((order, derivative), row) in (1_usize..).zip(&mut out.0).zip(&BINOMIALS) {
            let backwards = difference.iter().take(order).rev();
            for ((share, difference), binomial) in share.iter().zip(backwards).zip(row) {
                *derivative += difference * (*share * S::lit(*binomial));
            }
        }
        out
    }
}
