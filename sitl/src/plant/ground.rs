//! Flat ground under the vehicle, which moves with the base that the station stands on: spring and damper upwards,
//! stick and slip sideways. It touches with its feet, its rotors and its top.

use super::{Anchor, Body, BodyModel, Deck, GRAVITY, V3};
use crate::scenario::VehicleSection;
use nalgebra::Rotation3;

/// Feet and soil.
#[derive(Clone, Debug)]
pub struct GroundModel {
    /// Feet below the centre of mass, m.
    pub leg_height: f64,
    /// What may touch, from the centre of mass, body axes, m: four feet, four rotors, the top.
    points: [V3; POINTS],
    /// The farthest of them, m: higher up, however it is turned, none touches.
    reach: f64,
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
        // As wide as high, but for the small ones, which stand wider.
        let spread = (0.85 * vehicle.arm).min(vehicle.leg_height.max(0.15));
        let [forward, right] = vehicle.centre;
        let middle = V3::new(forward, right, 0.0);
        // A rotor's tip is half an arm further out than its hub.
        let tip = 1.5 * vehicle.arm;
        let mut points = [V3::new(0.0, 0.0, -TOP * vehicle.arm) - middle; POINTS];
        let ring = |out: f64, down: f64| {
            CORNERS.into_iter().map(move |(x, y)| V3::new(x * out, y * out, down) - middle)
        };
        let round = ring(spread, vehicle.leg_height).chain(ring(tip, -ROTORS * vehicle.arm));
        points.iter_mut().zip(round).for_each(|(point, place)| *point = place);
        Self {
            leg_height: vehicle.leg_height,
            reach: points.iter().map(V3::norm).fold(0.0, f64::max),
            points,
            stiffness: 2_000.0 * light,
            damping: 60.0 * light,
            friction: 0.8,
        }
    }

    /// All that may touch is elsewhere, seen from the centre of mass, m.
    pub fn move_points(&mut self, by: &V3) {
        self.points.iter_mut().for_each(|point| *point += by);
        self.reach += by.norm();
    }

    /// Nothing touches a body that is higher over the middle of the deck, m.
    #[inline]
    pub(super) fn clearance(&self) -> f64 {
        self.reach + SLOPE
    }

    /// Height of the centre of mass at rest, m.
    #[must_use]
    pub fn rest_height(&self, body: &BodyModel) -> f64 {
        self.leg_height - body.mass * GRAVITY / (4.0 * self.stiffness)
    }
}

/// How much higher than its middle the deck may be under the vehicle, m.
const SLOPE: f64 = 1.0;

/// Where each point sticks, if it touches.
#[derive(Clone, Debug, Default)]
pub struct Ground {
    stuck: [Option<(f64, f64)>; POINTS],
    /// Sinking and sideways speed over the ground at the last first contact, m/s.
    pub touch_down: Option<(f64, f64)>,
}

const POINTS: usize = 9;
/// Rotors and top over the centre of mass, in arms.
const ROTORS: f64 = 0.15;
const TOP: f64 = 0.5;
const CORNERS: [(f64, f64); 4] = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];

impl Ground {
    /// Nothing touches: the body is higher than it reaches.
    #[inline]
    pub(super) fn leave(&mut self) {
        self.stuck = [None; POINTS];
    }

    /// Whether anything touches.
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
        if body.height() - base.deck_height() > model.clearance() {
            self.leave();
            return (V3::zeros(), V3::zeros());
        }
        self.touch(model, body, rotation, base.deck())
    }

    fn touch(
        &mut self,
        model: &GroundModel,
        body: &Body,
        rotation: &Rotation3<f64>,
        deck: Deck,
    ) -> (V3, V3) {
        let was_touching = self.is_touching();
        let (mut force, mut torque) = (V3::zeros(), V3::zeros());
        // Everything in the deck's axes: a small turn.
        let lies_flat = deck.tilt == V3::zeros();
        let flat = if lies_flat { Rotation3::identity() } else { Rotation3::new(-deck.tilt) };
        for (stuck, foot) in self.stuck.iter_mut().zip(&model.points) {
            let from_deck = body.position + rotation * foot - deck.place;
            let place = flat * from_deck;
            if place.z <= 0.0 {
                *stuck = None;
                continue;
            }
            let deck_speed = deck.velocity + deck.rate.cross(&from_deck);
            let speed = flat * (body.velocity + rotation * body.rate.cross(foot) - deck_speed);
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
            let push = flat.inverse() * (side - V3::new(0.0, 0.0, normal));
            force += push;
            torque += foot.cross(&rotation.inverse_transform_vector(&push));
        }
        if !was_touching && self.is_touching() {
            let over = body.velocity - deck.velocity;
            self.touch_down = Some((over.z, over.x.hypot(over.y)));
        }
        (force, torque)
    }
}
