//! Rigid body.

use super::{GRAVITY, V3};
use crate::scenario::VehicleSection;
use nalgebra::{Quaternion, Rotation3, UnitQuaternion};

/// Mass, inertia, drag.
#[derive(Clone, Debug)]
pub struct BodyModel {
    /// kg.
    pub mass: f64,
    /// Principal moments, kg m².
    pub inertia: V3,
    /// Linear drag, body axes, N s/m.
    pub drag_linear: V3,
    /// Quadratic drag, N s²/m².
    pub drag_quadratic: f64,
    /// N m s/rad.
    pub rate_damping: f64,
    /// Centre of mass from the middle of the rotors, m.
    pub centre: V3,
}

impl BodyModel {
    /// As the scenario describes it.
    #[must_use]
    pub fn new(vehicle: &VehicleSection) -> Self {
        Self {
            mass: vehicle.mass,
            inertia: V3::from(vehicle.inertia),
            drag_linear: V3::from(vehicle.drag_linear),
            drag_quadratic: vehicle.drag_quadratic,
            rate_damping: vehicle.rate_damping,
            centre: V3::new(vehicle.centre[0], vehicle.centre[1], 0.0),
        }
    }

    /// Drag, N, for a velocity relative to the air, m/s, both in body axes.
    #[must_use]
    pub fn drag(&self, air: &V3) -> V3 {
        -self.drag_linear.component_mul(air) - self.drag_quadratic * air.norm() * air
    }
}

/// Square of half the angle, rad², up to which a turn's series is exact to rounding.
pub(super) const SMALL: f64 = 1e-5;

/// Square of half the angle of a rotation vector, rad².
#[inline(always)]
pub(super) fn half_square(by: &V3) -> f64 {
    (by * 0.5).norm_squared()
}

/// State.
#[derive(Clone, Debug)]
pub struct Body {
    /// Centre of mass, NED, m.
    pub position: V3,
    /// NED, m/s.
    pub velocity: V3,
    /// Body to world.
    pub attitude: UnitQuaternion<f64>,
    /// Body axes, rad/s.
    pub rate: V3,
}

impl Body {
    /// At rest, level, nose at `heading` rad from North.
    #[must_use]
    pub fn at(position: V3, heading: f64) -> Self {
        Self {
            position,
            velocity: V3::zeros(),
            attitude: UnitQuaternion::from_euler_angles(0.0, 0.0, heading),
            rate: V3::zeros(),
        }
    }

    /// m over the anchor.
    #[must_use]
    pub fn height(&self) -> f64 {
        -self.position.z
    }

    /// Angle between the body's down axis and the world's, rad.
    #[must_use]
    pub fn tilt(&self) -> f64 {
        (self.attitude * V3::z()).z.clamp(-1.0, 1.0).acos()
    }

    /// Semi-implicit Euler under a force (without gravity), world axes, and a torque, body axes.
    #[inline]
    pub fn step(&mut self, model: &BodyModel, force: &V3, torque: &V3, dt: f64) {
        self.push(model, force, torque, dt);
        let by = self.rate * dt;
        if half_square(&by) > SMALL {
            self.attitude *= UnitQuaternion::from_scaled_axis(by);
        } else {
            self.turn_little(&by);
        }
    }

    /// All but the turn.
    #[inline(always)]
    pub(super) fn push(&mut self, model: &BodyModel, force: &V3, torque: &V3, dt: f64) {
        let accel = force / model.mass + V3::new(0.0, 0.0, GRAVITY);
        self.velocity += accel * dt;
        self.position += self.velocity * dt;
        let spin = model.inertia.component_mul(&self.rate);
        let turn = (torque - self.rate.cross(&spin)).component_div(&model.inertia);
        self.rate += turn * dt;
    }

    /// By a rotation vector in body axes, rad, of which [`half_square`] is at most [`SMALL`].
    #[inline(always)]
    pub(super) fn turn_little(&mut self, by: &V3) {
        let half = by * 0.5;
        let square = half.norm_squared();
        // Sine and cosine to the fourth power of the angle, and one step of Newton's towards unit length.
        let cos = 1.0 - square * (0.5 - square / 24.0);
        let vector = half * (1.0 - square * (1.0 / 6.0 - square / 120.0));
        let turned = self.attitude.quaternion() * Quaternion::from_parts(cos, vector);
        let unit = turned * (1.5 - 0.5 * turned.norm_squared());
        self.attitude = UnitQuaternion::new_unchecked(unit);
    }

    /// Body to world, for whoever turns more than one vector.
    #[must_use]
    pub fn rotation(&self) -> Rotation3<f64> {
        self.attitude.to_rotation_matrix()
    }
}
