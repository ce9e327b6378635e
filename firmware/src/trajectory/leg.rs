//! One smooth move, straight or along the sphere.

use super::smooth_step::{PEAK_SLOPE, smooth_step};
use crate::frames::{V3, World};
use crate::math::{so3, wrap_pi};
use crate::scalar::Scalar;
use crate::signal::SphericalPoint;

/// The way between two points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape<S: Scalar> {
    /// Straight, world axes, m.
    Line {
        /// From.
        from: World<V3<S>>,
        /// To.
        to: World<V3<S>>,
    },
    /// In elevation, azimuth and length, the azimuth by the shorter way.
    Sphere {
        /// From.
        from: SphericalPoint<S>,
        /// To.
        to: SphericalPoint<S>,
    },
    /// Straight on, neither starting nor ending at rest: until the next set-point of a stream.
    Stream {
        /// From.
        from: World<V3<S>>,
        /// m/s.
        velocity: World<V3<S>>,
    },
}

/// A shape flown in a given time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leg<S: Scalar> {
    shape: Shape<S>,
    duration: S,
}

impl<S: Scalar> Leg<S> {
    /// So that the speed nowhere exceeds `speed`, m/s, and the duration is at least `shortest`, s.
    #[must_use]
    pub fn within_speed(shape: Shape<S>, speed: S, shortest: S) -> Self {
        let distance = match &shape {
            Shape::Line { from, to } => so3::norm(&(to.0 - from.0)),
            // Flown in a given time.
            Shape::Stream { .. } => S::zero(),
            Shape::Sphere { from, to } => {
                let reach = from.length.max(to.length);
                let turn = (to.elevation - from.elevation).abs()
                    + wrap_pi(to.azimuth - from.azimuth).abs();
                reach * turn + (to.length - from.length).abs()
            }
        };
        let time = S::from_f32(PEAK_SLOPE) * distance / speed.max(S::lit(0.05));
        Self { shape, duration: time.max(shortest).max(S::lit(0.1)) }
    }

    /// In exactly this time, s (at least 0.1).
    #[must_use]
    pub fn timed(shape: Shape<S>, duration: S) -> Self {
        Self { shape, duration: duration.max(S::lit(0.1)) }
    }

    /// s.
    #[must_use]
    pub fn duration(&self) -> S {
        self.duration
    }

    /// Position, m, and velocity, m/s, at a time since the start, s; at rest before and after, but for a stream's.
    #[must_use]
    pub fn at(&self, time: S) -> (World<V3<S>>, World<V3<S>>) {
        let (s, slope) = smooth_step(time / self.duration);
        let rate = slope / self.duration;
        match &self.shape {
            Shape::Line { from, to } => {
                let way = to.0 - from.0;
                (World(from.0 + way * s), World(way * rate))
            }
            Shape::Stream { from, velocity } => {
                let runs = time < self.duration;
                let way = velocity.0 * time.min(self.duration);
                (World(from.0 + way), if runs { *velocity } else { World(V3::zeros()) })
            }
            Shape::Sphere { from, to } => {
                let turn = V3::new(
                    to.elevation - from.elevation,
                    wrap_pi(to.azimuth - from.azimuth),
                    to.length - from.length,
                );
                let point = SphericalPoint {
                    elevation: from.elevation + turn.x * s,
                    azimuth: from.azimuth + turn.y * s,
                    length: from.length + turn.z * s,
                };
                (point.to_world(), velocity(&point, &(turn * rate)))
            }
        }
    }

    /// Where it ends.
    #[must_use]
    pub fn end(&self) -> World<V3<S>> {
        match &self.shape {
            Shape::Line { to, .. } => *to,
            Shape::Stream { from, velocity } => World(from.0 + velocity.0 * self.duration),
            Shape::Sphere { to, .. } => to.to_world(),
        }
    }
}

/// Velocity of a point whose elevation, azimuth and length change at the given rates.
fn velocity<S: Scalar>(p: &SphericalPoint<S>, rate: &V3<S>) -> World<V3<S>> {
    let ((se, ce), (sa, ca)) = (p.elevation.sin_cos(), p.azimuth.sin_cos());
    let by_elevation = V3::new(-se * ca, -se * sa, -ce) * (p.length * rate.x);
    let by_azimuth = V3::new(-sa, ca, S::zero()) * (p.length * ce * rate.y);
    let by_length = V3::new(ce * ca, ce * sa, -se) * rate.z;
    World(by_elevation + by_azimuth + by_length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_velocity_is_the_derivative_of_the_position_and_stays_within_the_speed() {
        let from = SphericalPoint { elevation: 0.5_f64, azimuth: 3.0, length: 10.0 };
        let to = SphericalPoint { elevation: 0.9, azimuth: -3.0, length: 12.0 };
        let leg = Leg::within_speed(Shape::Sphere { from, to }, 1.0, 3.0);
        let h = 1e-5;
        for i in 0..=100 {
            let t = leg.duration() * f64::from(i) / 100.0;
            let (_, v) = leg.at(t);
            let numeric = (leg.at(t + h).0.0 - leg.at(t - h).0.0) / (2.0 * h);
            assert!((numeric - v.0).norm() < 1e-6);
            assert!(v.0.norm() <= 1.0 + 1e-9);
        }
        assert!((leg.at(leg.duration()).0.0 - to.to_world().0).norm() < 1e-9);
        assert!(leg.duration() < 25.0, "took the long way round");
    }
}
