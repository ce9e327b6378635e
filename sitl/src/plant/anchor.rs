//! Whoever holds the tether walks: a straight line with a smooth start and end.

use super::V3;
use super::base::Motion;

/// A walk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Walk {
    /// Whole way, NED, m.
    pub way: V3,
    /// m/s.
    pub speed: f64,
    /// Up to that speed, and down again, s.
    pub ramp: f64,
}

/// Where the anchor is.
#[derive(Clone, Debug, Default)]
pub struct Anchor {
    /// NED, m.
    pub position: V3,
    /// m/s.
    pub velocity: V3,
    /// The ground under the vehicle is so much higher than that: a fault, m.
    pub raised: f64,
    /// Speed at which the station drives, and the ground with it: a fault, NED, m/s.
    pub drive: V3,
    /// Roll of the ground under the vehicle about North, rad, and its rate, rad/s: a fault.
    pub rock: (f64, f64),
    /// How far it has driven, NED, m.
    driven: V3,
    /// Place and velocity but for that.
    own: (V3, V3),
    walk: Option<(Walk, V3, f64)>,
    motion: Option<Motion>,
    /// Of the deck about North and East, rad, and its rate, rad/s; both small.
    tilt: V3,
    tilt_rate: V3,
    time: f64,
}

/// The ground under the vehicle.
#[derive(Clone, Copy, Debug)]
pub struct Deck {
    /// Where it turns about, NED, m.
    pub place: V3,
    /// m/s.
    pub velocity: V3,
    /// A small turn, world axes, rad.
    pub tilt: V3,
    /// rad/s.
    pub rate: V3,
}

impl Anchor {
    /// On a base that moves.
    #[must_use]
    pub fn on(motion: Option<Motion>) -> Self {
        let (position, velocity) =
            motion.as_ref().map_or((V3::zeros(), V3::zeros()), |motion| motion.at(0.0));
        Self { position, velocity, own: (position, velocity), motion, ..Self::default() }
    }

    /// Place and velocity of the ground under the vehicle: of a deck, not of whoever walks with the line.
    #[must_use]
    pub fn deck(&self) -> Deck {
        let (mut place, mut velocity) = match self.motion {
            Some(_) => self.own,
            None => (V3::zeros(), V3::zeros()),
        };
        place += self.driven;
        velocity += self.drive;
        place.z -= self.raised;
        let (rolled, rolls) = (V3::x() * self.rock.0, V3::x() * self.rock.1);
        Deck { place, velocity, tilt: self.tilt + rolled, rate: self.tilt_rate + rolls }
    }

    /// Height of that ground, m.
    #[must_use]
    #[inline]
    pub fn deck_height(&self) -> f64 {
        self.raised + if self.motion.is_some() { -self.position.z } else { 0.0 }
    }

    /// Starts a walk from where it is.
    pub fn go(&mut self, walk: Walk) {
        self.walk = Some((walk, self.own.0, 0.0));
    }

    /// Nothing moves it.
    #[inline]
    pub(super) fn is_still(&self) -> bool {
        let drives = self.drive != V3::zeros() || self.driven != V3::zeros();
        self.motion.is_none() && self.walk.is_none() && !drives
    }

    /// `dt` s ahead.
    #[inline]
    pub fn step(&mut self, dt: f64) {
        if !self.is_still() {
            self.go_on(dt);
            self.driven += self.drive * dt;
            self.position = self.own.0 + self.driven;
            self.velocity = self.own.1 + self.drive;
        }
    }

    fn go_on(&mut self, dt: f64) {
        if let Some(motion) = &self.motion {
            self.time += dt;
            self.own = motion.at(self.time);
            (self.tilt, self.tilt_rate) = motion.tilt(self.time);
            return;
        }
        let Some((walk, from, time)) = &mut self.walk else { return };
        *time += dt;
        let length = walk.way.norm();
        if length <= 0.0 || walk.speed <= 0.0 {
            self.walk = None;
            return;
        }
        // A short way never gets to full speed.
        let ramp = walk.ramp.max(1e-3).min(length / walk.speed);
        let cruise = length / walk.speed - ramp;
        let (t, end) = (*time, 2.0 * ramp + cruise);
        let rate = walk.speed / ramp;
        let (way, speed) = if t >= end {
            (length, 0.0)
        } else if t < ramp {
            (0.5 * rate * t * t, rate * t)
        } else if t < ramp + cruise {
            (walk.speed * (t - 0.5 * ramp), walk.speed)
        } else {
            let left = end - t;
            (length - 0.5 * rate * left * left, rate * left)
        };
        let along = walk.way / length;
        self.own = (*from + along * way, along * speed);
        if t >= end {
            self.walk = None;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_walk_arrives_at_rest_and_never_jumps() {
        for (length, ramp) in [(1.0, 1.0), (0.1, 1.0), (2.0, 0.0)] {
            let mut anchor = Anchor::default();
            anchor.go(Walk { way: V3::new(length, 0.0, 0.0), speed: 0.3, ramp });
            let mut last = 0.0;
            for _ in 0..20_000 {
                anchor.step(1e-3);
                assert!((anchor.position.x - last).abs() <= 0.3 * 1e-3 + 1e-9);
                assert!(anchor.velocity.x <= 0.3 + 1e-9);
                last = anchor.position.x;
            }
            assert!((anchor.position.x - length).abs() < 1e-9 && anchor.velocity.norm() < 1e-12);
        }
    }
}
