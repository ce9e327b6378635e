//! The physical world, f64, world axes NED with the origin at the anchor, body axes FRD.
//!
//! Rigid body on SO(3), rotors with lag, a tether with slack, a winch, ground contact, wind and
//! drag. Semi-implicit Euler at 4 kHz.

mod anchor;
mod base;
mod batch;
mod battery;
mod body;
mod disturbance;
mod follow;
mod ground;
mod integrate;
mod lanes;
mod push;
mod rod;
mod rotor;
mod supply;
mod tether;
mod wind;

pub use anchor::{Anchor, Deck, Walk};
pub use base::Motion;
pub use batch::PlantBatch;
pub use battery::{Battery, BatteryModel};
pub use body::{Body, BodyModel};
pub use disturbance::Disturbance;
pub use follow::{Follow, Truth};
pub use ground::{Ground, GroundModel};
pub use integrate::runge_kutta;
pub use push::Push;
pub use rod::{Rod, RodModel, RodPhase};
pub use rotor::{Hub, Rotor, RotorModel, hubs};
pub use supply::{Supply, SupplyModel};
pub use tether::{Chain, Drum, End, Grip, Material, Tether, TetherModel, WinchModel};
pub use wind::{Gusts, Wind, WindModel};

use crate::scenario::Scenario;
use nalgebra::{Rotation3, Vector3};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

/// The random numbers of the simulator.
pub type Generator = Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;

/// A vector.
pub type V3 = Vector3<f64>;

/// Gravity, m/s².
pub const GRAVITY: f64 = 9.81;
/// Between two commands of the firmware, s.
pub const TICK: f64 = 1e-3;
/// Physics steps per tick.
pub const SUBSTEPS: u32 = 4;
/// Physics step, s.
pub const DT: f64 = TICK / SUBSTEPS as f64;

/// Ticks between two looks at how far the vehicle has turned on its line.
const TWIST_EVERY: u64 = 20;

/// A generator of its own for each part of the world, so that a part that draws more often does not
/// shift the others.
#[must_use]
pub fn generator(seed: u64, part: u64) -> Pcg64Mcg {
    Pcg64Mcg::seed_from_u64(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ part)
}

/// A standard normal sample.
#[inline]
pub fn normal(rng: &mut Pcg64Mcg) -> f64 {
    StandardNormal.sample(rng)
}

/// A sample uniform in [-1, 1].
pub fn uniform(rng: &mut Pcg64Mcg) -> f64 {
    rand_distr::Uniform::new_inclusive(-1.0, 1.0).map_or(0.0, |range| range.sample(rng))
}

/// Everything physical, as the scenario describes it.
#[derive(Clone, Debug)]
pub struct PlantModel {
    /// Mass, inertia, drag.
    pub body: BodyModel,
    /// All four alike but for their gain error.
    pub rotor: RotorModel,
    /// Tether.
    pub tether: TetherModel,
    /// A load on top.
    pub rod: Option<RodModel>,
    /// Wind.
    pub wind: WindModel,
    /// Ground.
    pub ground: GroundModel,
    /// Battery.
    pub battery: BatteryModel,
    /// Power up the line.
    pub supply: SupplyModel,
    /// How the station moves; `None`: it stands still.
    pub base: Option<Motion>,
}

impl PlantModel {
    /// As the scenario describes it; the wind blows from `wind_from`, rad from North, when the file
    /// leaves that open.
    #[must_use]
    pub fn new(scenario: &Scenario, wind_from: f64) -> Self {
        Self {
            body: BodyModel::new(&scenario.vehicle),
            rotor: RotorModel::new(&scenario.vehicle),
            tether: TetherModel::new(&scenario.tether, &scenario.vehicle),
            rod: RodModel::new(&scenario.rod),
            wind: WindModel::new(&scenario.wind, wind_from),
            ground: GroundModel::new(&scenario.vehicle),
            battery: BatteryModel::new(&scenario.battery),
            supply: SupplyModel::new(&scenario.station),
            base: Motion::new(&scenario.base),
        }
    }
}

/// The state of everything physical.
#[derive(Clone, Debug)]
pub struct Plant {
    model: PlantModel,
    rng: Pcg64Mcg,
    /// Vehicle.
    pub body: Body,
    /// In the order of [`RotorModel::hubs`].
    pub rotors: Vec<Rotor>,
    /// Tether.
    pub tether: Tether,
    /// The tether's ground end.
    pub anchor: Anchor,
    /// Wind.
    pub wind: Wind,
    /// A load on top.
    pub rod: Option<Rod>,
    /// A force from nowhere.
    pub push: Option<Push>,
    /// Another one, world axes, N: a fault.
    pub force: V3,
    /// Wind on top of the model's, NED, m/s: a fault.
    pub gust: V3,
    /// Feet.
    pub ground: Ground,
    /// Battery.
    pub battery: Battery,
    /// Power up the line.
    pub supply: Supply,
    /// Specific force at the centre of mass, body axes, m/s², mean over the last millisecond.
    pub specific_force: V3,
    ticks: u64,
}

impl Plant {
    /// At rest on the ground, `distance` from the anchor along the `heading`, the nose pointing away.
    #[must_use]
    pub fn new(model: PlantModel, distance: f64, heading: f64, seed: u64) -> Self {
        let mut rng = generator(seed, 1);
        let height = model.ground.rest_height(&model.body);
        let anchor = Anchor::on(model.base.clone());
        let out = V3::new(distance * heading.cos(), distance * heading.sin(), -height);
        let place = anchor.position + out;
        let common = uniform(&mut rng) * model.rotor.common_gain_error;
        let draw = |_: &Hub| Rotor::new(1.0 + common + uniform(&mut rng) * model.rotor.gain_error);
        let rotors = model.rotor.hubs.iter().map(draw).collect();
        let turned = Rotation3::from_axis_angle(&V3::z_axis(), heading);
        let end = out + turned * model.tether.attachment;
        Self {
            body: Body::at(place, heading),
            rotors,
            tether: Tether::new(&model.tether, &anchor.position, &end, &mut rng),
            anchor,
            supply: Supply::default(),
            wind: Wind::default(),
            rod: model.rod.clone().map(Rod::held),
            push: None,
            force: V3::zeros(),
            gust: V3::zeros(),
            ground: Ground::default(),
            battery: Battery::new(&model.battery),
            specific_force: V3::zeros(),
            ticks: 0,
            model,
            rng,
        }
    }

    /// Hangs it at rest in the air, its line straight.
    pub fn hang(&mut self, position: V3) {
        self.body.position = position;
        let end = self.end();
        self.tether.lay(&self.model.tether, &self.anchor.position, &end);
    }

    /// One millisecond with these throttles and this tension set-point for the winch.
    pub fn step(&mut self, throttle: &[f64], winch_tension: f64) {
        let wind = self.begin_tick(throttle, winch_tension);
        let force = self.substeps(wind);
        self.end_tick(force);
    }

    /// What happens once in a millisecond, before its physics; the velocity of the air.
    #[inline]
    fn begin_tick(&mut self, throttle: &[f64], winch_tension: f64) -> V3 {
        let time = self.ticks as f64 * TICK;
        let at = (time, self.body.height());
        let wind = self.wind.step(&self.model.wind, at, TICK, &mut self.rng) + self.gust;
        self.wind.velocity = wind;
        let voltage = self.battery.voltage();
        for (rotor, &u) in self.rotors.iter_mut().zip(throttle) {
            rotor.command(&self.model.rotor, u, voltage);
        }
        self.tether.drive(&self.model.tether, winch_tension, time);
        wind
    }

    /// The millisecond's physics; the sum of the forces of its steps.
    #[inline]
    fn substeps(&mut self, wind: V3) -> V3 {
        let mut force_sum = V3::zeros();
        for _ in 0..SUBSTEPS {
            force_sum += self.substep(wind);
        }
        force_sum
    }

    /// What happens once in a millisecond, after its physics.
    #[inline]
    fn end_tick(&mut self, force_sum: V3) {
        if self.ticks.is_multiple_of(TWIST_EVERY) {
            let (nose, way) = (self.body.attitude * V3::x(), self.from_anchor());
            self.tether.turn(nose.y.atan2(nose.x) - way.y.atan2(way.x));
        }
        self.ticks += 1;
        self.specific_force = force_sum / (f64::from(SUBSTEPS) * self.model.body.mass);
        let rotors: f64 = self.rotors.iter().map(|r| r.power(&self.model.rotor)).sum();
        let power = rotors + self.model.battery.base_power;
        let given = self.supply.step(&self.model.supply, self.tether.length(), power);
        self.battery.step(&self.model.battery, power - given, TICK);
    }

    /// Force on the body but for its weight, body axes, N.
    #[inline]
    fn substep(&mut self, wind: V3) -> V3 {
        let m = &self.model;
        let mut thrust = 0.0;
        let mut moment = V3::zeros();
        let share = m.rotor.share(DT);
        for (rotor, hub) in self.rotors.iter_mut().zip(&m.rotor.hubs) {
            let t = rotor.step(&m.rotor, share);
            thrust += t;
            moment.x -= hub.y * t;
            moment.y += hub.x * t;
            moment.z += hub.spin * t;
        }
        let lever = V3::new(m.rotor.arm, m.rotor.arm, m.rotor.torque_ratio);
        let mut torque = moment.component_mul(&lever) - m.body.rate_damping * self.body.rate;
        torque.x += m.body.centre.y * thrust;
        torque.y -= m.body.centre.x * thrust;
        let rotation = self.body.rotation();
        let air = rotation.inverse_transform_vector(&(self.body.velocity - wind));
        let mut force_body = m.body.drag(&air);
        force_body.z -= thrust;

        let (support, support_torque) =
            self.ground.step(&m.ground, &self.body, &rotation, &self.anchor);
        torque += support_torque;
        let mut force = support + rotation * force_body + self.force;
        if let Some(push) = &mut self.push {
            push.step(self.body.height(), DT);
            force += push.force();
        }

        let lever = m.tether.attachment;
        self.anchor.step(DT);
        let end = End {
            position: self.body.position + rotation * lever,
            velocity: self.body.velocity + rotation * self.body.rate.cross(&lever),
            force,
            mass: m.body.mass,
            turns: lever.norm_squared() / m.body.inertia.x,
            down: rotation.matrix().column(2).into(),
        };
        let base = (self.anchor.position, self.anchor.velocity);
        let (shear, top) = (m.wind.shear, self.body.height().max(1.0));
        let wind_at = |height: f64| match shear {
            0.0 => wind,
            _ => wind * (height.max(0.1) / top).powf(shear),
        };
        let grip = self.tether.step(&m.tether, base, &end, &wind_at);
        let mut pull_world = grip.force;
        if grip.mass > 0.0 {
            // Line that moves with the vehicle hangs on its attachment with its weight and its inertia.
            pull_world -= (force + grip.force) * (grip.mass / (m.body.mass + grip.mass));
        }
        let pull = rotation.inverse_transform_vector(&pull_world);
        torque += lever.cross(&pull);
        force += pull_world;
        if let Some(rod) = &mut self.rod {
            force += rod.step(&force, m.body.mass, DT);
        }
        self.body.step(&m.body, &force, &torque, DT);
        rotation.inverse_transform_vector(&force)
    }

    fn end_in(&self, rotation: &Rotation3<f64>) -> V3 {
        self.body.position + rotation * self.model.tether.attachment - self.anchor.position
    }

    /// The line catches on something, at a `share` of its length from the station.
    pub fn catch_line(&mut self, share: f64) {
        self.tether.catch(&self.anchor.position, share);
    }

    /// The centre of mass moves in the body, which stays where it is, m in body axes.
    pub fn move_centre(&mut self, by: &V3) {
        self.body.position += self.body.attitude * by;
        self.model.body.centre += by;
        self.model.tether.attachment -= by;
        self.model.ground.move_points(&-by);
    }

    /// Of the centre of mass over the ground or the deck, m.
    #[must_use]
    pub fn height_over_ground(&self) -> f64 {
        self.body.height() - self.anchor.deck_height()
    }

    /// Attachment of the tether from its anchor, m.
    #[must_use]
    pub fn end(&self) -> V3 {
        self.end_in(&self.body.rotation())
    }

    /// Centre of mass from the anchor, m: what the firmware calls its position.
    #[must_use]
    pub fn from_anchor(&self) -> V3 {
        self.body.position - self.anchor.position
    }

    /// Total thrust now, N.
    #[must_use]
    pub fn thrust(&self) -> f64 {
        self.rotors.iter().map(|r| r.thrust(&self.model.rotor)).sum()
    }

    /// The description.
    #[must_use]
    pub fn model(&self) -> &PlantModel {
        &self.model
    }

    /// The description, for faults that change the world.
    pub fn model_mut(&mut self) -> &mut PlantModel {
        &mut self.model
    }
}

#[cfg(test)]
mod tests;
