//! A force from nowhere on the vehicle, as in the article on the flying pendulum; it comes up softly once
//! the vehicle flies.

use super::{Disturbance, V3};

/// Height at which it begins, m, and time until it is whole, s.
const HEIGHT: f64 = 0.5;
const RAMP: f64 = 3.0;

/// The force over time.
#[derive(Clone, Debug)]
pub struct Push {
    disturbance: Disturbance,
    share: f64,
}

impl Push {
    /// Not yet there.
    #[must_use]
    pub fn new(disturbance: Disturbance) -> Self {
        Self { disturbance, share: 0.0 }
    }

    /// N, world axes.
    #[must_use]
    pub fn force(&self) -> V3 {
        self.disturbance.force() * self.share
    }

    /// `dt` s with the vehicle at a height, m.
    pub fn step(&mut self, height: f64, dt: f64) {
        if self.share > 0.0 || height > HEIGHT {
            self.share = (self.share + dt / RAMP).min(1.0);
            self.disturbance.step(dt);
        }
    }
}
