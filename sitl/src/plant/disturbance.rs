//! The pendulum article's three disturbances: none, constant, and (71).

use super::{Generator, generator, normal};
use crate::scenario::DisturbanceKind;
use nalgebra::Vector3;

/// Hold time of the white noise, s, and its deviation.
const HOLD: f64 = 0.1;
const DEVIATION: f64 = 0.1;

/// Force on the vehicle over time, world axes, N.
#[derive(Clone, Debug)]
pub struct Disturbance {
    kind: DisturbanceKind,
    force: Vector3<f64>,
    white: Vector3<f64>,
    /// Until the next sample, s.
    left: f64,
    rng: Generator,
}

impl Disturbance {
    /// At the start.
    #[must_use]
    pub fn new(kind: DisturbanceKind, seed: u64) -> Self {
        let force = match kind {
            DisturbanceKind::None => Vector3::zeros(),
            DisturbanceKind::Constant => Vector3::new(-0.5, 0.5, -0.8),
            DisturbanceKind::Stochastic => Vector3::new(0.2, -0.2, -0.3),
        };
        Self { kind, force, white: Vector3::zeros(), left: 0.0, rng: generator(seed, 40) }
    }

    /// As given, for good.
    #[must_use]
    pub fn constant(force: Vector3<f64>) -> Self {
        Self { force, ..Self::new(DisturbanceKind::Constant, 0) }
    }

    /// N.
    #[must_use]
    pub fn force(&self) -> Vector3<f64> {
        self.force
    }

    /// `dt` s ahead.
    pub fn step(&mut self, dt: f64) {
        if self.kind != DisturbanceKind::Stochastic {
            return;
        }
        if self.left <= 0.5 * dt {
            self.white = Vector3::from_fn(|_, _| DEVIATION * normal(&mut self.rng));
            self.left += HOLD;
        }
        self.left -= dt;
        let times = Vector3::new(13.0, 15.0, 22.0) / 1.5;
        let gains = Vector3::new(6.5, 5.0, 4.0) * 5.0;
        let keep = times.map(|time| (-dt / time).exp());
        let share = keep.map(|keep| 1.0 - keep);
        self.force = keep.component_mul(&self.force)
            + share.component_mul(&gains).component_mul(&self.white);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stochastic_force_has_the_deviations_of_the_specification() {
        let mut d = Disturbance::new(DisturbanceKind::Stochastic, 3);
        let (mut sum, mut count) = (Vector3::zeros(), 0.0);
        for k in 0..4_000_000 {
            d.step(0.01);
            if k > 10_000 {
                sum += d.force().component_mul(&d.force());
                count += 1.0;
            }
        }
        let sd = (sum / count).map(f64::sqrt);
        assert!((sd - Vector3::new(0.25, 0.18, 0.12)).abs().max() < 0.02, "{sd}");
    }
}
