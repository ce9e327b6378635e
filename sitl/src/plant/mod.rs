//! The physical world, f64, world axes NED with the origin at the anchor, body axes FRD.
//!
//! Rigid body on SO(3), rotors with lag, a tether with slack, a winch, ground contact, wind and
//! drag. Semi-implicit Euler at 4 kHz.

mod anchor;
mod battery;
mod body;
mod disturbance;
mod ground;
mod integrate;
mod push;
mod rod;
mod rotor;
mod tether;
mod wind;

pub use anchor::{Anchor, Walk};
pub use battery::{Battery, BatteryModel};
pub use body::{Body, BodyModel};
pub use disturbance::Disturbance;
pub use ground::{Ground, GroundModel};
pub use integrate::runge_kutta;
pub use push::Push;
pub use rod::{Rod, RodModel, RodPhase};
pub use rotor::{Hub, Rotor, RotorModel};
pub use tether::{Tether, TetherModel, WinchModel};
pub use wind::{Gusts, Wind, WindModel};

use crate::scenario::Scenario;
use nalgebra::Vector3;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

/// The random numbers of the simulator.
pub type Generator = Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;

/// A vector.
pub type V3 = Vector3<f64>;

/// Gravity, m/s².
pub const GRAVITY: f64 = 9.81;
/// Physics steps per millisecond.
pub const SUBSTEPS: u32 = 4;
/// Physics step, s.
pub const DT: f64 = 1e-3 / SUBSTEPS as f64;

/// A generator of its own for each part of the world, so that a part that draws more often does not
/// shift the others.
#[must_use]
pub fn generator(seed: u64, part: u64) -> Pcg64Mcg {
    Pcg64Mcg::seed_from_u64(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ part)
}

/// A standard normal sample.
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
}

impl PlantModel {
    /// As the scenario describes it; the wind blows from `wind_from`, rad from North, when the file
    /// leaves that open.
    #[must_use]
    pub fn new(scenario: &Scenario, wind_from: f64) -> Self {
        Self {
            body: BodyModel::new(&scenario.vehicle),
            rotor: RotorModel::new(&scenario.vehicle),
            tether: TetherModel::new(&scenario.tether, scenario.vehicle.mass),
            rod: RodModel::new(&scenario.rod),
            wind: WindModel::new(&scenario.wind, wind_from),
            ground: GroundModel::new(&scenario.vehicle),
            battery: BatteryModel::new(&scenario.battery),
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
    /// Feet.
    pub ground: Ground,
    /// Battery.
    pub battery: Battery,
    /// Specific force at the centre of mass, body axes, m/s², mean over the last millisecond.
    pub specific_force: V3,
    time: f64,
}

impl Plant {
    /// At rest on the ground, `distance` from the anchor along the `heading`, the nose pointing away.
    #[must_use]
    pub fn new(model: PlantModel, distance: f64, heading: f64, seed: u64) -> Self {
        let mut rng = generator(seed, 1);
        let height = model.ground.rest_height(&model.body);
        let place = V3::new(distance * heading.cos(), distance * heading.sin(), -height);
        let common = uniform(&mut rng) * model.rotor.common_gain_error;
        let draw = |_: &Hub| Rotor::new(1.0 + common + uniform(&mut rng) * model.rotor.gain_error);
        let rotors = model.rotor.hubs.iter().map(draw).collect();
        Self {
            body: Body::at(place, heading),
            rotors,
            tether: Tether::new(&model.tether, &mut rng),
            anchor: Anchor::default(),
            wind: Wind::default(),
            rod: model.rod.clone().map(Rod::held),
            push: None,
            ground: Ground::default(),
            battery: Battery::new(&model.battery),
            specific_force: V3::zeros(),
            time: 0.0,
            model,
            rng,
        }
    }

    /// One millisecond with these throttles and this tension set-point for the winch.
    pub fn step(&mut self, throttle: &[f64], winch_tension: f64) {
        let mut force_sum = V3::zeros();
        let wind = self.wind.step(&self.model.wind, self.body.height(), 1e-3, &mut self.rng);
        let voltage = self.battery.voltage();
        for (rotor, &u) in self.rotors.iter_mut().zip(throttle) {
            rotor.command(&self.model.rotor, u, voltage);
        }
        for _ in 0..SUBSTEPS {
            force_sum += self.substep(winch_tension, wind);
            self.time += DT;
        }
        self.specific_force = force_sum / f64::from(SUBSTEPS);
        let power: f64 = self.rotors.iter().map(|r| r.power(&self.model.rotor)).sum();
        self.battery.step(&self.model.battery, power, 1e-3);
    }

    fn substep(&mut self, winch_tension: f64, wind: V3) -> V3 {
        let m = &self.model;
        let mut thrust = 0.0;
        let mut torque = V3::zeros();
        for (rotor, &Hub { x, y, spin }) in self.rotors.iter_mut().zip(&m.rotor.hubs) {
            let t = rotor.step(&m.rotor, DT);
            thrust += t;
            let hub = V3::new(x * m.rotor.arm, y * m.rotor.arm, 0.0);
            torque += hub.cross(&V3::new(0.0, 0.0, -t));
            torque.z += spin * m.rotor.torque_ratio * t;
        }
        let r = self.body.attitude;
        let air = r.inverse() * (self.body.velocity - wind);
        let mut force_body = V3::new(0.0, 0.0, -thrust) + m.body.drag(&air);
        torque -= m.body.rate_damping * self.body.rate;

        let arm = V3::new(0.0, 0.0, m.tether.attachment);
        self.anchor.step(DT);
        let end = self.end();
        let end_velocity =
            self.body.velocity + r * self.body.rate.cross(&arm) - self.anchor.velocity;
        let pull =
            self.tether.step(&m.tether, &end, &end_velocity, &wind, winch_tension, self.time, DT);
        let pull_body = r.inverse() * pull;
        force_body += pull_body;
        torque += arm.cross(&pull_body);

        let (support, support_torque) = self.ground.step(&m.ground, &self.body);
        force_body += r.inverse() * support;
        torque += support_torque;

        if let Some(push) = &mut self.push {
            push.step(self.body.height(), DT);
            force_body += r.inverse() * push.force();
        }
        if let Some(rod) = &mut self.rod {
            let reaction = rod.step(&(r * force_body), m.body.mass, DT);
            force_body += r.inverse() * reaction;
        }
        self.body.step(&m.body, &force_body, &torque, DT);
        force_body / m.body.mass
    }

    /// Attachment of the tether from its anchor, m.
    #[must_use]
    pub fn end(&self) -> V3 {
        let arm = V3::new(0.0, 0.0, self.model.tether.attachment);
        self.body.position + self.body.attitude * arm - self.anchor.position
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
