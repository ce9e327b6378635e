//! A load on a rigid, massless rod that stands in a cup on top of the vehicle, at its centre of mass.
//!
//! A hand holds it until it is released; it falls out of the cup when it leans too far.

use super::{GRAVITY, V3};
use crate::scenario::RodSection;

/// What does not move.
#[derive(Clone, Debug)]
pub struct RodModel {
    /// kg.
    pub load_mass: f64,
    /// m.
    pub length: f64,
    /// Direction in which the hand holds it: vehicle → load.
    pub held: V3,
}

impl RodModel {
    /// As the scenario describes it; `None`: without a load there is no rod.
    #[must_use]
    pub fn new(rod: &RodSection) -> Option<Self> {
        let ((sin, cos), (east, north)) = (rod.tilt.sin_cos(), rod.azimuth.sin_cos());
        let held = V3::new(sin * north, sin * east, -cos);
        (rod.load_mass > 0.0).then_some(Self { load_mass: rod.load_mass, length: rod.length, held })
    }
}

/// How it stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RodPhase {
    /// In somebody's hand, who follows the vehicle.
    Held,
    /// On its own.
    Balanced,
    /// On the floor.
    Fallen,
}

/// State.
#[derive(Clone, Debug)]
pub struct Rod {
    model: RodModel,
    /// Unit vector vehicle → load, world axes.
    pub direction: V3,
    /// rad/s, world axes, across the rod.
    pub rate: V3,
    /// How it stands.
    pub phase: RodPhase,
}

/// Leaning farther than this it falls out of its cup: cosine of the tilt (95°).
const CUP: f64 = -0.087;

impl Rod {
    /// In a hand.
    #[must_use]
    pub fn held(model: RodModel) -> Self {
        let direction = model.held.normalize();
        Self { model, direction, rate: V3::zeros(), phase: RodPhase::Held }
    }

    /// The hand lets go.
    pub fn release(&mut self) {
        if self.phase == RodPhase::Held {
            self.phase = RodPhase::Balanced;
        }
    }

    /// A hand takes it as it leans.
    pub fn catch(&mut self) {
        if self.phase == RodPhase::Balanced {
            self.phase = RodPhase::Held;
            self.rate = V3::zeros();
        }
    }

    /// Description.
    #[must_use]
    pub fn model(&self) -> &RodModel {
        &self.model
    }

    /// Of the load from a vehicle at a place, m.
    #[must_use]
    pub fn load(&self, vehicle: &V3) -> V3 {
        vehicle + self.direction * self.model.length
    }

    /// Angle from upright, rad.
    #[must_use]
    pub fn tilt(&self) -> f64 {
        (-self.direction.z).clamp(-1.0, 1.0).acos()
    }

    /// `dt` s under a force on the vehicle (all but gravity and rod), N; gives the rod's force on the
    /// vehicle, N. World axes.
    pub fn step(&mut self, force: &V3, vehicle_mass: f64, dt: f64) -> V3 {
        if self.phase != RodPhase::Balanced {
            return V3::zeros();
        }
        let m = &self.model;
        let q = self.direction;
        // Both ends keep their distance.
        let turning = m.length * self.rate.norm_squared();
        let pull =
            (q.dot(force) / vehicle_mass - turning) / (1.0 / vehicle_mass + 1.0 / m.load_mass);
        let gravity = V3::z() * GRAVITY;
        let load = q * (pull / m.load_mass) + gravity;
        let vehicle = (force - q * pull) / vehicle_mass + gravity;
        self.rate += q.cross(&(load - vehicle)) * (dt / m.length);
        self.direction = (q + self.rate.cross(&q) * dt).normalize();
        self.rate -= self.direction * self.direction.dot(&self.rate);
        if -self.direction.z < CUP {
            self.phase = RodPhase::Fallen;
        }
        q * -pull
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::runge_kutta;

    #[test]
    fn it_falls_as_the_pendulum_of_the_article_does() {
        let model = RodModel { load_mass: 0.03, length: 0.7, held: V3::new(0.1, 0.0, -1.0) };
        let mut rod = Rod::held(model);
        rod.release();
        let start = rod.direction.x.asin();
        let thrust = V3::new(0.0, 0.0, -0.29 * GRAVITY);
        let dt = 2.5e-4;
        for _ in 0..2000 {
            rod.step(&thrust, 0.26, dt);
        }
        // In a plane the lean obeys lean'' = T/(mQ l) sin(lean).
        let stiffness = 0.29 * GRAVITY / (0.26 * 0.7);
        let [lean, _] = (0..500)
            .fold([start, 0.0], |x, _| runge_kutta(x, 1e-3, |[a, w]| [*w, stiffness * a.sin()]));
        assert!((rod.direction.x.asin() - lean).abs() < 0.01 * lean, "{} {lean}", rod.tilt());
    }
}
