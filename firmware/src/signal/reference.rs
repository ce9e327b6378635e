//! What is asked.

use crate::frames::{V3, World};
use crate::scalar::Scalar;

/// A place in tether coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SphericalPoint<S> {
    /// Above the horizontal, rad.
    pub elevation: S,
    /// From North, rad.
    pub azimuth: S,
    /// From the anchor, m.
    pub length: S,
}

impl<S: Scalar> SphericalPoint<S> {
    /// For what is computed seldom, in f32.
    #[must_use]
    pub fn to_f32(&self) -> SphericalPoint<f32> {
        SphericalPoint {
            elevation: self.elevation.to_f32(),
            azimuth: self.azimuth.to_f32(),
            length: self.length.to_f32(),
        }
    }

    /// In world axes.
    #[must_use]
    pub fn to_world(&self) -> World<V3<S>> {
        let ((se, ce), (sa, ca)) = (self.elevation.sin_cos(), self.azimuth.sin_cos());
        World(V3::new(ce * ca, ce * sa, -se) * self.length)
    }

    /// From world axes; straight above the anchor the azimuth is zero.
    #[must_use]
    pub fn from_world(p: &World<V3<S>>) -> Self {
        let horizontal = (p.0.x * p.0.x + p.0.y * p.0.y).sqrt();
        Self {
            elevation: (-p.0.z).atan2(horizontal),
            azimuth: p.0.y.atan2(p.0.x),
            length: crate::math::so3::norm(&p.0),
        }
    }
}

/// Where to be now, and how fast to be moving.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlightReference<S: Scalar = f32> {
    /// From the anchor, m.
    pub position: World<V3<S>>,
    /// m/s.
    pub velocity: World<V3<S>>,
    /// Heading of the nose, rad from North.
    pub yaw: S,
    /// Tension, N.
    pub tension: S,
}

/// What a taut-link mode controls beside the elevation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TautPurpose {
    /// Link force.
    #[default]
    Force,
    /// Pitch.
    Attitude,
}

/// Elevation and a second output in the plane of a taut link, with derivatives. What a law does not use
/// is ignored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarReference<S> {
    /// Elevation, rad, to its fourth derivative.
    pub elevation: [S; 5],
    /// Pitch, rad, or link force, N, to its second derivative.
    pub second: [S; 3],
}

/// Where the load of a flying inverted pendulum shall be: position from the origin and its first five
/// time derivatives, world axes, m to m/s⁵.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadReference<S: Scalar = f32>(pub [V3<S>; 6]);

impl<S: Scalar> LoadReference<S> {
    /// At rest.
    #[must_use]
    pub fn at_rest(position: World<V3<S>>) -> Self {
        let o = V3::zeros();
        Self([position.0, o, o, o, o, o])
    }
    /// From the origin, m.
    #[must_use]
    pub fn position(&self) -> World<V3<S>> {
        let [position, ..] = self.0;
        World(position)
    }
    /// m/s.
    #[must_use]
    pub fn velocity(&self) -> World<V3<S>> {
        let [_, velocity, ..] = self.0;
        World(velocity)
    }
}
