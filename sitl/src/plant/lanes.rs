//! One millisecond of physics of many vehicles in free flight side by side, number by number, so that the processor
//! takes several at once: the same operations in the same order as [`super::Plant`]'s, and the same results to the bit.
//!
//! Free flight: high over the ground, on a straight line that a drum of a station at rest holds, slower than what the
//! body's series for a turn is exact for. What leaves that within the millisecond is told, and is to be done again by
//! the whole plant.

#![expect(clippy::indexing_slicing, reason = "every counter ends where its arrays do")]

use super::body::{SMALL, half_square};
use super::tether::{DRAG_SHARE, SHORTEST, drag};
use super::{Body, DT, GRAVITY, Plant, PlantModel, SUBSTEPS, V3};
use nalgebra::{Quaternion, UnitQuaternion};

/// Vehicles side by side.
pub const LANES: usize = 16;

type Lane = [f64; LANES];

const NONE: Lane = [0.0; LANES];

#[inline(always)]
fn get(of: &[Lane; 3], i: usize) -> V3 {
    V3::new(of[0][i], of[1][i], of[2][i])
}

#[inline(always)]
fn put(of: &mut [Lane; 3], i: usize, v: &V3) {
    of[0][i] = v.x;
    of[1][i] = v.y;
    of[2][i] = v.z;
}

/// Vehicles of `R` rotors.
#[derive(Clone)]
pub struct Lanes<const R: usize> {
    position: [Lane; 3],
    velocity: [Lane; 3],
    attitude: [Lane; 4],
    rate: [Lane; 3],
    speed: [Lane; R],
    target: [Lane; R],
    per_square: [Lane; R],
    wind: [Lane; 3],
    /// Of a fault, N.
    force: [Lane; 3],
    anchor: [Lane; 3],
    /// By the drum, N.
    wanted: Lane,
    /// Of the line, N.
    drag: [Lane; 3],
    /// Sum of the forces of the steps, body axes, N.
    sum: [Lane; 3],
    along: [Lane; 3],
    tension: Lane,
    half_weight: Lane,
    length: Lane,
    /// Over the steps: least height, m, shortest and longest line, m, and greatest turn, rad².
    lowest: Lane,
    nearest: Lane,
    farthest: Lane,
    turn: Lane,
}

impl<const R: usize> Default for Lanes<R> {
    fn default() -> Self {
        Self {
            position: [NONE; 3],
            velocity: [NONE; 3],
            attitude: [NONE; 4],
            rate: [NONE; 3],
            speed: [NONE; R],
            target: [NONE; R],
            per_square: [NONE; R],
            wind: [NONE; 3],
            force: [NONE; 3],
            anchor: [NONE; 3],
            wanted: NONE,
            drag: [NONE; 3],
            sum: [NONE; 3],
            along: [NONE; 3],
            tension: NONE,
            half_weight: NONE,
            length: NONE,
            lowest: NONE,
            nearest: NONE,
            farthest: NONE,
            turn: NONE,
        }
    }
}

impl<const R: usize> Lanes<R> {
    /// Takes a vehicle that has begun its millisecond in this wind; false: it does not fly freely.
    pub fn load(&mut self, i: usize, plant: &Plant, wind: &V3) -> bool {
        let m = &plant.model;
        let Some(wanted) = plant.tether.on_drum(&m.tether) else { return false };
        let is_alone = plant.rod.is_none() && plant.push.is_none();
        let has_shear = m.wind.shear != 0.0;
        if !is_alone || has_shear || !plant.anchor.is_still() || plant.rotors.len() != R {
            return false;
        }
        if plant.height_over_ground() <= m.ground.clearance() {
            return false;
        }
        let body = &plant.body;
        put(&mut self.position, i, &body.position);
        put(&mut self.velocity, i, &body.velocity);
        put(&mut self.rate, i, &body.rate);
        let q = body.attitude.quaternion();
        for (lane, x) in self.attitude.iter_mut().zip([q.w, q.i, q.j, q.k]) {
            lane[i] = x;
        }
        for (r, rotor) in plant.rotors.iter().enumerate() {
            self.speed[r][i] = rotor.speed;
            (self.target[r][i], self.per_square[r][i]) = rotor.drive(&m.rotor);
        }
        put(&mut self.wind, i, wind);
        put(&mut self.force, i, &plant.force);
        put(&mut self.anchor, i, &plant.anchor.position);
        self.wanted[i] = wanted;
        true
    }

    /// Gives back a vehicle after its millisecond, and the sum of its forces; `None`: it is to be done again.
    pub fn store(&self, i: usize, plant: &mut Plant) -> Option<V3> {
        let m = &plant.model;
        let longest = m.tether.winch.as_ref().map_or(0.0, |winch| winch.length_max);
        let is_high = self.lowest[i] - plant.anchor.deck_height() > m.ground.clearance();
        let is_within = self.nearest[i] >= SHORTEST && self.farthest[i] <= longest;
        if !(is_high && is_within && self.turn[i] <= SMALL) {
            return None;
        }
        let body = &mut plant.body;
        (body.position, body.velocity) = (get(&self.position, i), get(&self.velocity, i));
        body.rate = get(&self.rate, i);
        let [w, x, y, z] = self.attitude.each_ref().map(|lane| lane[i]);
        body.attitude = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
        for (r, rotor) in plant.rotors.iter_mut().enumerate() {
            rotor.speed = self.speed[r][i];
        }
        plant.ground.leave();
        let link = super::tether::Straight {
            along: get(&self.along, i),
            tension: self.tension[i],
            half_weight: self.half_weight[i],
            length: self.length[i],
        };
        plant.tether.take(link, get(&self.drag, i));
        Some(get(&self.sum, i))
    }

    /// A millisecond.
    #[inline(always)]
    pub fn step(&mut self, model: &PlantModel) {
        self.sum = [NONE; 3];
        self.lowest = [f64::INFINITY; LANES];
        self.nearest = [f64::INFINITY; LANES];
        self.farthest = NONE;
        self.turn = NONE;
        self.substep::<true>(model);
        for _ in 1..SUBSTEPS {
            self.substep::<false>(model);
        }
    }

    /// `FIRST`: the line feels the air.
    #[inline(always)]
    fn substep<const FIRST: bool>(&mut self, m: &PlantModel) {
        // Copies on the stack: nothing that is written in the loop can be what is read in it.
        let Some(winch) = m.tether.winch.clone() else { return };
        let (airframe, diameter) = (m.body.clone(), m.tether.diameter);
        let share = m.rotor.share(DT);
        let hubs: [_; R] = std::array::from_fn(|r| m.rotor.hubs[r]);
        let lever = V3::new(m.rotor.arm, m.rotor.arm, m.rotor.torque_ratio);
        let hung = m.tether.attachment;
        let weight = m.tether.line_density * GRAVITY;
        let was = self.clone();
        for i in 0..LANES {
            let mut thrust = 0.0;
            let mut moment = V3::zeros();
            for (r, hub) in hubs.iter().enumerate() {
                let speed = was.speed[r][i] + (was.target[r][i] - was.speed[r][i]) * share;
                self.speed[r][i] = speed;
                let t = was.per_square[r][i] * speed * speed;
                thrust += t;
                moment.x -= hub.y * t;
                moment.y += hub.x * t;
                moment.z += hub.spin * t;
            }
            let [w, x, y, z] = was.attitude.each_ref().map(|lane| lane[i]);
            let mut body = Body {
                position: get(&was.position, i),
                velocity: get(&was.velocity, i),
                attitude: UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z)),
                rate: get(&was.rate, i),
            };
            self.lowest[i] = was.lowest[i].min(body.height());
            let mut torque = moment.component_mul(&lever) - airframe.rate_damping * body.rate;
            torque.x += airframe.centre.y * thrust;
            torque.y -= airframe.centre.x * thrust;
            let rotation = body.rotation();
            let wind = get(&was.wind, i);
            let air = rotation.inverse_transform_vector(&(body.velocity - wind));
            let mut force_body = airframe.drag(&air);
            force_body.z -= thrust;
            let mut force = rotation * force_body + get(&was.force, i);

            let way = body.position + rotation * hung - get(&was.anchor, i);
            let velocity = body.velocity + rotation * body.rate.cross(&hung);
            let distance = way.norm();
            self.nearest[i] = was.nearest[i].min(distance);
            self.farthest[i] = was.farthest[i].max(distance);
            let along = way / distance;
            let half_weight = -0.5 * weight * way.z;
            let held = (was.wanted[i] + winch.friction(velocity.dot(&along))).max(0.0);
            let tension = held + half_weight;
            let felt = if FIRST {
                drag(diameter, distance * DRAG_SHARE, &along, &(velocity - wind))
            } else {
                get(&was.drag, i)
            };
            put(&mut self.drag, i, &felt);
            let mut pull_world = felt - along * tension;
            pull_world.z += 0.5 * weight * distance;
            put(&mut self.along, i, &along);
            (self.tension[i], self.half_weight[i]) = (tension, half_weight);
            self.length[i] = distance;

            let pull = rotation.inverse_transform_vector(&pull_world);
            torque += hung.cross(&pull);
            force += pull_world;
            body.push(&airframe, &force, &torque, DT);
            let by = body.rate * DT;
            self.turn[i] = was.turn[i].max(half_square(&by));
            body.turn_little(&by);
            put(&mut self.position, i, &body.position);
            put(&mut self.velocity, i, &body.velocity);
            put(&mut self.rate, i, &body.rate);
            let q = body.attitude.quaternion();
            self.attitude[0][i] = q.w;
            self.attitude[1][i] = q.i;
            self.attitude[2][i] = q.j;
            self.attitude[3][i] = q.k;
            let sum = get(&was.sum, i) + rotation.inverse_transform_vector(&force);
            put(&mut self.sum, i, &sum);
        }
    }
}
