//! Flat ground under four feet, which moves with the base that the station stands on: spring and damper upwards, stick
//! and slip sideways.

use super::{Anchor, Body, BodyModel, GRAVITY, V3};
use crate::scenario::VehicleSection;
use nalgebra::Rotation3;

/// Feet and soil.
#[derive(Clone, Debug)]
pub struct GroundModel {
    /// Feet below the centre of mass, m.
    pub leg_height: f64,
    /// Feet forward and sideways of the centre of mass, m.
    pub leg_spread: f64,
    /// Per foot, N/m.
    pub stiffness: f64,
    /// Per foot, N s/m.
    pub damping: f64,
    /// Friction coefficient.
    pub friction: f64,
}

impl GroundModel {
    /// Under the vehicle that the scenario describes.
    #[must_use]
    pub fn new(vehicle: &VehicleSection) -> Self {
        // Feet that carry a kilogram would throw a hundred grams about.
        let light = vehicle.mass.min(1.0);
        Self {
            leg_height: vehicle.leg_height,
            // As wide as high, but for the small ones, which stand wider.
            leg_spread: (0.85 * vehicle.arm).min(vehicle.leg_height.max(0.15)),
            stiffness: 2_000.0 * light,
            damping: 60.0 * light,
            friction: 0.8,
        }
    }

    /// From the centre of mass to each foot, m: higher up, however it is turned, none touches.
    fn reach(&self) -> f64 {
        (2.0 * self.leg_spread * self.leg_spread + self.leg_height * self.leg_height).sqrt()
    }

    /// Height of the centre of mass at rest, m.
    #[must_use]
    pub fn rest_height(&self, body: &BodyModel) -> f64 {
        self.leg_height - body.mass * GRAVITY / (4.0 * self.stiffness)
    }
}

/// Where each foot sticks, if it touches.
#[derive(Clone, Debug, Default)]
pub struct Ground {
    stuck: [Option<(f64, f64)>; 4],
    /// Sinking speed at the last first contact, m/s.
    pub touch_down_speed: Option<f64>,
}

const FEET: [(f64, f64); 4] = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];

impl Ground {
    /// Whether a foot touches.
    #[must_use]
    pub fn is_touching(&self) -> bool {
        self.stuck.iter().any(Option::is_some)
    }

    /// Force in world axes, N, and torque in body axes, N m, on a body that is turned by `rotation`.
    #[inline]
    pub fn step(
        &mut self,
        model: &GroundModel,
        body: &Body,
        rotation: &Rotation3<f64>,
        base: &Anchor,
    ) -> (V3, V3) {
        if body.height() - base.deck_height() > model.reach() {
            self.stuck = [None; 4];
            return (V3::zeros(), V3::zeros());
        }
        self.touch(model, body, rotation, base.deck())
    }

    fn touch(
        &mut self,
        model: &GroundModel,
        body: &Body,
        rotation: &Rotation3<f64>,
        deck: (V3, V3),
    ) -> (V3, V3) {
        let was_touching = self.is_touching();
        let (mut force, mut torque) = (V3::zeros(), V3::zeros());
        for (stuck, (x, y)) in self.stuck.iter_mut().zip(FEET) {
            let foot = V3::new(x * model.leg_spread, y * model.leg_spread, model.leg_height);
            let place = body.position + rotation * foot - deck.0;
            if place.z <= 0.0 {
                *stuck = None;
                continue;
            }
            let speed = body.velocity + rotation * body.rate.cross(&foot) - deck.1;
            let normal = (model.stiffness * place.z + model.damping * speed.z).max(0.0);
            let (sx, sy) = *stuck.get_or_insert((place.x, place.y));
            let mut side = V3::new(
                -model.stiffness * (place.x - sx) - model.damping * speed.x,
                -model.stiffness * (place.y - sy) - model.damping * speed.y,
                0.0,
            );
            let friction_limit = model.friction * normal;
            if side.norm() > friction_limit {
                side *= friction_limit / side.norm();
                // Slipping: the foot drags its anchor along.
                *stuck =
                    Some((place.x + side.x / model.stiffness, place.y + side.y / model.stiffness));
            }
            let push = side - V3::new(0.0, 0.0, normal);
            force += push;
            torque += foot.cross(&rotation.inverse_transform_vector(&push));
        }
        if !was_touching && self.is_touching() {
            self.touch_down_speed = Some(body.velocity.z - deck.1.z);
        }
        (force, torque)
    }
}
