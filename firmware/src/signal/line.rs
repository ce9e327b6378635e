//! What a line's own sensors say, at the vehicle and at the station: as read, and in SI units. Each may be absent.

use super::{Imu, RawImu};
use crate::frames::{Body, V3, World};
use crate::scalar::Scalar;

/// Two magnetic encoders where the line leaves the vehicle, counts of 4096 per turn.
///
/// The outer one turns about the nose axis, the inner one about the right-hand axis that the outer carries along.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RawAngles {
    /// Outer, inner; `None`: it sees no magnet, or one that is too weak or too strong.
    pub counts: [Option<u16>; 2],
}

/// Load cell where the line leaves the vehicle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RawTension {
    /// Of the bridge's converter.
    pub counts: i32,
}

/// Magnetometer, right-handed axes of the part.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RawMagnetometer {
    /// x, y, z, 0.3 µT each.
    pub counts: [i16; 3],
}

/// Direction in which the line leaves the station, as its encoders say.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RawFairlead {
    /// From North, rad.
    pub azimuth: f32,
    /// Over the horizon, rad.
    pub elevation: f32,
}

/// Everything that drivers and the link may hand over of these at one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RawLineSensors {
    /// At the vehicle.
    pub angles: Option<RawAngles>,
    /// At the vehicle.
    pub tension: Option<RawTension>,
    /// On the vehicle.
    pub magnetometer: Option<RawMagnetometer>,
    /// On the vehicle, counts in the axes of the first one and with its scale.
    pub second_imu: Option<RawImu>,
    /// Tension at the station, N.
    pub station_tension: Option<f32>,
    /// At the station.
    pub fairlead: Option<RawFairlead>,
}

impl RawLineSensors {
    /// Takes what is newer. Every field by name: one that is forgotten here does not compile.
    pub fn merge(&mut self, newer: Self) {
        let Self { angles, tension, magnetometer, second_imu, station_tension, fairlead } = newer;
        take(&mut self.angles, angles);
        take(&mut self.tension, tension);
        take(&mut self.magnetometer, magnetometer);
        take(&mut self.second_imu, second_imu);
        take(&mut self.station_tension, station_tension);
        take(&mut self.fairlead, fairlead);
    }

    /// Nothing is there.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        let Self { angles, tension, magnetometer, second_imu, station_tension, fairlead } = self;
        angles.is_none()
            && tension.is_none()
            && magnetometer.is_none()
            && second_imu.is_none()
            && station_tension.is_none()
            && fairlead.is_none()
    }
}

/// What is newer, if there is anything.
#[inline]
pub(crate) fn take<T>(known: &mut Option<T>, newer: Option<T>) {
    if newer.is_some() {
        *known = newer;
    }
}

/// The same calibrated and checked. `None`: never heard, or silent for too long.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LineSensors<S: Scalar = f32> {
    /// From the vehicle down the line, unit vector.
    pub direction: Option<Body<V3<S>>>,
    /// At the vehicle, N.
    pub tension: Option<S>,
    /// At the station, N.
    pub station_tension: Option<S>,
    /// From the station up the line, unit vector.
    pub station_direction: Option<World<V3<S>>>,
    /// Earth's field, µT.
    pub magnetic: Option<Body<V3<S>>>,
    /// Of the second inertial sensor, not filtered.
    pub second_imu: Option<Imu<S>>,
}
