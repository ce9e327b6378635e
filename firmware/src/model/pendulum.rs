//! A point mass on a rigid, massless rod on top of a multirotor. `pendulum` sections 1 and 2.
//!
//! `q` points from the vehicle to the load: straight down (0, 0, -1) when the load stands upright. Unknown
//! forces act on the vehicle's centre of mass. World axes.

use crate::fault::{Invalid, positive};
use crate::frames::V3;
use crate::math::{GRAVITY, so3};
use crate::scalar::Scalar;

/// Masses and rod.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PendulumModel<S> {
    /// kg.
    pub(crate) vehicle_mass: S,
    /// kg.
    pub(crate) load_mass: S,
    /// m.
    pub(crate) length: S,
    /// m/s².
    pub(crate) gravity: S,
}

impl<S: Scalar> PendulumModel<S> {
    /// Masses in kg, length of the rod in m.
    ///
    /// # Errors
    /// [`Invalid`] naming the one that is not finite and positive.
    pub fn try_new(vehicle_mass: S, load_mass: S, length: S) -> Result<Self, Invalid> {
        Ok(Self {
            vehicle_mass: positive("vehicle_mass", vehicle_mass)?,
            load_mass: positive("load_mass", load_mass)?,
            length: positive("length", length)?,
            gravity: S::lit(GRAVITY),
        })
    }

    /// With another gravity, m/s².
    ///
    /// # Errors
    /// [`Invalid`] if it is not finite and positive.
    pub fn with_gravity(self, gravity: S) -> Result<Self, Invalid> {
        Ok(Self { gravity: positive("gravity", gravity)?, ..self })
    }

    /// Vehicle and load, kg.
    #[must_use]
    pub fn total_mass(&self) -> S {
        self.vehicle_mass + self.load_mass
    }

    /// Vehicle mass times length, kg m: force over it turns the rod.
    #[must_use]
    pub fn lever(&self) -> S {
        self.vehicle_mass * self.length
    }

    /// Thrust that carries both, N.
    #[must_use]
    pub fn weight(&self) -> S {
        self.total_mass() * self.gravity
    }

    /// Acceleration of the load, m/s² (5a), for the rod's direction and rate, rad/s, and the force on the
    /// vehicle other than gravity and rod, N.
    #[must_use]
    pub fn load_accel(&self, rod: &V3<S>, rod_rate: &V3<S>, force: &V3<S>) -> V3<S> {
        let along = so3::dot(rod, force) - self.lever() * so3::dot(rod_rate, rod_rate);
        let mut accel = rod * (along / self.total_mass());
        accel.z += self.gravity;
        accel
    }

    /// Angular acceleration of the rod, rad/s² (5b).
    #[must_use]
    pub fn rod_accel(&self, rod: &V3<S>, force: &V3<S>) -> V3<S> {
        so3::cross(rod, force) * (-S::one() / self.lever())
    }
}
