//! A step of the line.
//!
//! Along the line it is implicit: with `g = k (dt + β)`, `T = k e + g ė` at the step's end is a tridiagonal system for the
//! tensions (coupled by the nodes' masses, the drum's and the vehicle's), so that stiffness asks for no tiny steps.
//! Across the line, where frequencies are low, it is symplectic Euler. A segment that would push has no tension.
//! Weight, air and flow are looked up every other step.

use super::{Chain, End, Material, Segment};
use crate::plant::tether::drag::drag;
use crate::plant::tether::station::Drum;
use crate::plant::{GRAVITY, V3};

/// Friction of a line that lies on the ground.
const GROUND_FRICTION: f64 = 0.5;
/// Passes over the tensions until no segment pushes.
const PASSES: usize = 3;
const DOWN: V3 = V3::new(0.0, 0.0, GRAVITY);

/// A segment as it is found, until the node at its upper end is dealt with.
struct Found {
    along: V3,
    half_drag: V3,
    /// Velocity of its upper end from the lower's, m/s.
    widening: V3,
    /// Rate at which it would have to shorten, m/s.
    pulled: f64,
    /// Of its lower end, predicted, m/s.
    low: V3,
}

impl Chain {
    /// `dt` s ahead. `drum`: none when the lower end is fixed. `wind`: air velocity at a height, m/s.
    pub fn step(
        &mut self,
        material: &Material,
        drum: Option<Drum>,
        base: (V3, V3),
        end: &End,
        wind: &impl Fn(f64) -> V3,
        dt: f64,
    ) {
        if self.segments.is_empty() {
            return;
        }
        let rest = self.segment_length();
        let drum = drum.filter(|_| !self.is_cut && self.caught.is_none());
        self.lead_lower_end(material, rest, drum, base, dt);
        self.lead_upper_end(material, rest, end, dt);
        if self.looks {
            self.look(material, rest, wind, dt);
        } else {
            self.go_on(material, rest, dt);
        }
        self.looks = !self.looks;
        for _ in 0..PASSES {
            if self.pull(material, rest, dt) {
                break;
            }
        }
        self.advance(drum, dt);
        self.weigh_at_station(material.density * rest * GRAVITY);
    }

    /// The station's end, and its velocity at the step's end if nothing pulled.
    fn lead_lower_end(
        &mut self,
        material: &Material,
        rest: f64,
        drum: Option<Drum>,
        base: (V3, V3),
        dt: f64,
    ) {
        let (Some(first), Some(lowest)) = (self.nodes.first_mut(), self.segments.first()) else {
            return;
        };
        if self.is_cut {
            first.gives = 2.0 * dt / (material.density * rest);
            first.velocity += DOWN * dt;
            return;
        }
        (first.position, first.gives) = (base.0, 0.0);
        match drum {
            None => self.pay_out = 0.0,
            Some(drum) => {
                // Beside the tension of the lowest segment, as it was.
                let held_back = self.station_tension - lowest.tension;
                self.trim = drum.trimmed(self.trim, self.station_tension, dt);
                let pull = drum.pull(self.trim);
                let own = drum.model.inertia;
                let inertia = own + dt * drum.friction_per_speed(self.pay_out);
                self.pay_out = (own * self.pay_out + dt * (held_back - pull)) / inertia;
                first.gives = dt / inertia;
            }
        }
        first.velocity = base.1 + lowest.along * self.pay_out;
    }

    /// The vehicle's end, and its velocity at the step's end if the line did not pull.
    fn lead_upper_end(&mut self, material: &Material, rest: f64, end: &End, dt: f64) {
        let (Some(last), Some(highest)) = (self.nodes.last_mut(), self.segments.last()) else {
            return;
        };
        let mobility = 1.0 / (end.mass + 0.5 * material.density * rest);
        (last.position, last.velocity) = (end.position, end.velocity);
        if mobility > 0.0 {
            last.velocity += (end.force * mobility + DOWN) * dt;
        }
        let across = 1.0 - highest.along.dot(&end.down).powi(2);
        last.gives = (mobility + end.turns * across) * dt;
    }

    /// Each segment as it is, and the velocities of the nodes between at the step's end if no segment pulled.
    fn look(&mut self, material: &Material, rest: f64, wind: &impl Fn(f64) -> V3, dt: f64) {
        let per_reach = 1.0 / (dt + material.relaxation);
        let weight = material.density * rest;
        // Where short segments pull hard, a step is too long for their swing: inertia, not weight, makes up.
        let mass = weight.max(2.0 * self.tension() * dt * dt / rest);
        let per_mass = 1.0 / mass;
        // Of what flows past a node, per length of line.
        let mut flow = self.pay_out * (0.5 / rest);
        let each = flow / self.segments.len() as f64;
        let caught = self.caught.unwrap_or(usize::MAX);

        let mut nodes = self.nodes.iter_mut();
        let Some(mut low) = nodes.next() else { return };
        let mut below: Option<(&mut Segment, Found)> = None;
        for (i, (segment, high)) in self.segments.iter_mut().zip(nodes).enumerate() {
            let span = segment.turn(&(high.position - low.position));
            let widening = high.velocity - low.velocity;
            let height = -0.5 * (low.position.z + high.position.z);
            let air = low.velocity + widening * 0.5 - wind(height);
            let half_drag = drag(material.diameter, 0.5 * rest, &segment.along, &air);
            match below {
                // The free end of a cut line; a drum or a fixed point does not mind.
                None if self.is_cut => low.velocity += half_drag * low.gives,
                None => {}
                Some((segment_below, found)) => {
                    flow -= each;
                    low.gives = per_mass * dt;
                    low.acceleration = (found.half_drag + half_drag + DOWN * weight) * per_mass
                        - (found.widening + widening) * flow;
                    low.velocity += low.acceleration * dt;
                    if i == caught {
                        (low.velocity, low.acceleration) = (V3::zeros(), V3::zeros());
                        low.gives = 0.0;
                    }
                    segment.bend = segment.along.dot(&found.along);
                    segment_below.want(found.pulled, &(low.velocity - found.low));
                }
            }
            let found = Found {
                along: segment.along,
                half_drag,
                widening,
                pulled: (span - rest) * per_reach,
                low: low.velocity,
            };
            below = Some((segment, found));
            low = high;
        }
        if let Some((highest, found)) = below {
            highest.want(found.pulled, &(low.velocity - found.low));
            self.end_drag = found.half_drag;
        }
    }

    /// The same under the forces found by the last look.
    fn go_on(&mut self, material: &Material, rest: f64, dt: f64) {
        let per_reach = 1.0 / (dt + material.relaxation);
        let inner = self.segments.len().saturating_sub(1);
        for node in self.nodes.iter_mut().skip(1).take(inner) {
            node.velocity += node.acceleration * dt;
        }
        let mut below = V3::zeros();
        for (segment, [low, high]) in self.segments.iter_mut().zip(self.nodes.array_windows()) {
            let span = segment.turn(&(high.position - low.position));
            segment.bend = segment.along.dot(&below);
            below = segment.along;
            segment.want((span - rest) * per_reach, &(high.velocity - low.velocity));
        }
    }

    /// Tensions at the step's end; whether none of them pushes.
    fn pull(&mut self, material: &Material, rest: f64, dt: f64) -> bool {
        let give = rest / (material.stiffness * (dt + material.relaxation));
        // Nothing below the lowest one.
        let (mut carried_on, mut right) = (0.0, 0.0);
        for (segment, [low, high]) in self.segments.iter_mut().zip(self.nodes.array_windows()) {
            if !segment.is_taut {
                (segment.carry, segment.right, carried_on, right) = (0.0, 0.0, 0.0, 0.0);
                continue;
            }
            // `carried_on`: one over the row below's own share; zero without such a row.
            let coupling = -low.gives * segment.bend;
            segment.carry = coupling * carried_on;
            let own = give + low.gives + high.gives - coupling * segment.carry;
            carried_on = 1.0 / own;
            right = (segment.wanted - coupling * right) * carried_on;
            segment.right = right;
        }
        let (mut above, mut pushes) = (0.0, false);
        for segment in self.segments.iter_mut().rev() {
            segment.tension = segment.right - above;
            if segment.tension < 0.0 {
                (segment.tension, segment.is_taut, pushes) = (0.0, false, true);
            }
            above = segment.carry * segment.tension;
        }
        !pushes
    }

    fn advance(&mut self, drum: Option<Drum>, dt: f64) {
        let share = 1.0 / self.segments.len() as f64;
        if let (Some(first), Some(segment)) = (self.nodes.first_mut(), self.segments.first()) {
            if self.is_cut {
                first.velocity += segment.along * (segment.tension * first.gives);
                first.position += first.velocity * dt;
                if first.position.z >= 0.0 {
                    rest_on_ground(&mut first.velocity);
                    first.position.z = 0.0;
                }
            } else if let Some(drum) = drum {
                let speed = self.pay_out + segment.tension * first.gives;
                self.pay_out = drum.limited(speed, self.length);
                self.length += self.pay_out * dt;
            }
        }
        // Half of what flows past a node.
        let mut flow = 0.5 * self.pay_out;
        let each = flow * share;
        let inner = self.nodes.iter_mut().skip(1).zip(self.segments.array_windows());
        for (node, [below, above]) in inner {
            flow -= each;
            let pull = above.along * above.tension - below.along * below.tension;
            node.velocity += pull * node.gives;
            node.position += (node.velocity - (below.along + above.along) * flow) * dt;
            if node.position.z >= 0.0 {
                rest_on_ground(&mut node.velocity);
                node.position.z = 0.0;
            }
        }
    }

    /// What the station holds: the lowest segment with half of its weight.
    fn weigh_at_station(&mut self, weight: f64) {
        let held = self
            .segments
            .first()
            .filter(|lowest| lowest.tension > 0.0)
            .map_or(V3::zeros(), |lowest| {
                lowest.along * lowest.tension + V3::new(0.0, 0.0, 0.5 * weight)
            });
        self.station_tension = held.norm();
        if self.station_tension > 0.0 {
            self.leaves = held / self.station_tension;
        }
    }
}

impl Segment {
    /// Into the direction of the way between its ends, m; its length.
    #[inline(always)]
    fn turn(&mut self, way: &V3) -> f64 {
        let span = way.norm().max(1e-9);
        self.along = way * (1.0 / span);
        span
    }

    /// What its tension has to bring about: it is `pulled` m/s, and its ends will part by `widening` m/s.
    #[inline(always)]
    fn want(&mut self, pulled: f64, widening: &V3) {
        self.wanted = pulled + self.along.dot(widening);
        // Until it is found to push: a slack one may be what its neighbours are about to pull taut.
        self.is_taut = true;
    }
}

/// The ground takes what sinks, and its friction what slides.
fn rest_on_ground(velocity: &mut V3) {
    if velocity.z <= 0.0 {
        return;
    }
    let sliding = (velocity.x * velocity.x + velocity.y * velocity.y).sqrt();
    let left =
        if sliding > 0.0 { (1.0 - GROUND_FRICTION * velocity.z / sliding).max(0.0) } else { 0.0 };
    *velocity = V3::new(velocity.x * left, velocity.y * left, 0.0);
}
