//! Up to three legs in a row: take-off, move, landing.

use super::leg::{Leg, Shape};
use crate::frames::{V3, World};
use crate::math::so3;
use crate::model::TetherKind;
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::SphericalPoint;

/// Height over the ground where the slow part of a landing begins, m.
const FLARE_HEIGHT: f64 = 1.0;
/// The landing's last leg aims this far below the ground, so that touch-down comes at full sink rate.
const BELOW_GROUND: f64 = 0.7;
/// Elevation up to which a fixed-length take-off lifts first, rad (8°).
const LIFT_ELEVATION: f64 = 0.14;

/// How long a set-point of a stream holds, s.
pub const STREAM_TIME: f64 = 0.5;

/// Legs and the time spent in the present one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan<S: Scalar> {
    leg: Leg<S>,
    next: [Option<Leg<S>>; 2],
    time: S,
}

impl<S: Scalar> Plan<S> {
    /// Stay here.
    #[must_use]
    pub fn stay(at: World<V3<S>>) -> Self {
        Self::of(Leg::timed(Shape::Line { from: at, to: at }, S::zero()), [None, None])
    }

    /// A set-point of a stream: straight on, and at rest where the next one does not come in time.
    #[must_use]
    pub fn stream(from: World<V3<S>>, velocity: World<V3<S>>) -> Self {
        let leg = Leg::timed(Shape::Stream { from, velocity }, S::lit(STREAM_TIME));
        Self::of(leg, [None, None])
    }

    fn of(leg: Leg<S>, next: [Option<Leg<S>>; 2]) -> Self {
        Self { leg, next, time: S::zero() }
    }

    /// Advances by `dt` s and gives position and velocity.
    pub fn step(&mut self, dt: S) -> (World<V3<S>>, World<V3<S>>) {
        self.time += dt;
        if self.time > self.leg.duration() {
            let [first, second] = self.next;
            if let Some(leg) = first {
                self.time -= self.leg.duration();
                self.leg = leg;
                self.next = [second, None];
            } else {
                self.time = self.leg.duration();
            }
        }
        self.leg.at(self.time)
    }

    /// Whether the last leg has ended.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.next.iter().all(Option::is_none) && self.time >= self.leg.duration()
    }

    /// Whether the plan is in its last leg.
    #[must_use]
    pub fn is_last_leg(&self) -> bool {
        self.next.iter().all(Option::is_none)
    }

    /// Where it ends.
    #[must_use]
    pub fn end(&self) -> World<V3<S>> {
        self.next.iter().flatten().last().unwrap_or(&self.leg).end()
    }
}

/// Makes plans.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planner<S> {
    has_winch: bool,
    is_free: bool,
    near_distance: S,
    climb_height: S,
    ground_height: S,
    cruise: S,
    descend: S,
    land: S,
}

impl<S: Scalar> Planner<S> {
    /// From the parameters.
    #[must_use]
    #[inline(never)]
    pub fn new(p: &Params) -> Self {
        let f = S::from_f32;
        Self {
            has_winch: TetherKind::from_parameter(p.tether_kind).has_winch(),
            is_free: TetherKind::from_parameter(p.tether_kind).is_free(),
            near_distance: f(p.start_distance),
            climb_height: f(p.climb_altitude),
            ground_height: f(p.ground_height),
            cruise: f(p.cruise_speed),
            descend: f(p.descend_speed),
            land: f(p.land_speed),
        }
    }

    /// With a winch straight up near the anchor, then outwards; with a fixed length up along the sphere; free
    /// straight.
    #[must_use]
    pub fn takeoff(&self, from: World<V3<S>>, to: SphericalPoint<S>) -> Plan<S> {
        if self.is_free {
            return self.go(from, to);
        }
        let start = SphericalPoint::from_world(&from);
        if self.has_winch {
            let top = World(V3::new(from.0.x, from.0.y, -self.climb_height.max(-from.0.z)));
            let up = Leg::within_speed(Shape::Line { from, to: top }, S::lit(1.4), S::lit(4.0));
            let above =
                SphericalPoint { azimuth: start.azimuth, ..SphericalPoint::from_world(&top) };
            let out =
                Leg::within_speed(Shape::Sphere { from: above, to }, self.cruise, S::lit(6.0));
            return Plan::of(up, [Some(out), None]);
        }
        let start = SphericalPoint { length: to.length, ..start };
        let lifted =
            SphericalPoint { elevation: S::lit(LIFT_ELEVATION).min(to.elevation), ..start };
        let lift =
            Leg::within_speed(Shape::Sphere { from: start, to: lifted }, self.cruise, S::lit(3.0));
        let climb = Leg::within_speed(Shape::Sphere { from: lifted, to }, self.cruise, S::lit(6.0));
        Plan::of(lift, [Some(climb), None])
    }

    /// Along the sphere to another point, or straight without a link.
    #[must_use]
    pub fn go(&self, from: World<V3<S>>, to: SphericalPoint<S>) -> Plan<S> {
        let shape = if self.is_free {
            Shape::Line { from, to: to.to_world() }
        } else {
            Shape::Sphere { from: SphericalPoint::from_world(&from), to }
        };
        Plan::of(Leg::within_speed(shape, self.cruise, S::lit(3.0)), [None, None])
    }

    /// With a winch back to near the anchor and down; with a fixed length down along the sphere; free
    /// straight down.
    #[must_use]
    pub fn land(&self, from: World<V3<S>>) -> Plan<S> {
        let place = SphericalPoint::from_world(&from);
        let flare = self.ground_height + S::lit(FLARE_HEIGHT);
        let below = self.ground_height - S::lit(BELOW_GROUND);
        let none = S::lit(0.1);
        if self.is_free {
            let at = |height: S| World(V3::new(from.0.x, from.0.y, -height));
            let way = |from: World<V3<S>>, height: S, speed: S| {
                Leg::within_speed(Shape::Line { from, to: at(height) }, speed, none)
            };
            if -from.0.z <= flare {
                return Plan::of(way(from, below, self.land), [None, None]);
            }
            let slow = way(at(flare), below, self.land);
            return Plan::of(way(from, flare, self.descend), [Some(slow), None]);
        }
        if !self.has_winch {
            let at_height = |height: S| SphericalPoint {
                elevation: elevation_of(height, place.length),
                ..place
            };
            let slow = |from: SphericalPoint<S>| {
                Leg::within_speed(Shape::Sphere { from, to: at_height(below) }, self.land, none)
            };
            let height = -from.0.z;
            if height <= flare {
                return Plan::of(slow(place), [None, None]);
            }
            let down = Shape::Sphere { from: place, to: at_height(flare) };
            return Plan::of(
                Leg::within_speed(down, self.descend, none),
                [Some(slow(at_height(flare))), None],
            );
        }
        let (sin, cos) = place.azimuth.sin_cos();
        let near =
            |height: S| World(V3::new(cos * self.near_distance, sin * self.near_distance, -height));
        let touch = |from: World<V3<S>>| {
            let to = World(V3::new(from.0.x, from.0.y, -below));
            Leg::within_speed(Shape::Line { from, to }, self.land, none)
        };
        let side = (from.0.x * from.0.x + from.0.y * from.0.y).sqrt();
        let height = -from.0.z;
        if side < self.near_distance * S::lit(1.5) && height <= flare {
            return Plan::of(touch(from), [None, None]);
        }
        // Never dive on the way in: come in at the height of the vertical climb, or where it is.
        let top = near(self.climb_height.min(height).max(flare));
        let back = Shape::Sphere {
            from: place,
            to: SphericalPoint { azimuth: place.azimuth, ..SphericalPoint::from_world(&top) },
        };
        let down = Shape::Line { from: top, to: near(flare) };
        Plan::of(
            Leg::within_speed(back, self.cruise, S::lit(3.0)),
            [Some(Leg::within_speed(down, self.descend, none)), Some(touch(near(flare)))],
        )
    }
}

/// Elevation of a point at a height on a sphere around the anchor.
fn elevation_of<S: Scalar>(height: S, length: S) -> S {
    (height / length.max(S::lit(0.1))).asin()
}

/// Unit vector and length of a reference position; straight up where it is at the anchor itself.
pub(crate) fn direction_of<S: Scalar>(p: &World<V3<S>>) -> (World<V3<S>>, S) {
    let up = V3::new(S::zero(), S::zero(), -S::one());
    let (u, length) = so3::direction(&p.0, S::lit(0.05)).unwrap_or((up, S::lit(0.05)));
    (World(u), length)
}
