//! What arrived this tick: as read from the registers, and in SI units.

use super::LineSensors;
use crate::frames::{Body, V3, World};
use crate::scalar::Scalar;
use crate::time::Sample;

/// Inertial sensor, counts in the sensor's own axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RawImu {
    /// Accelerometer x, y, z.
    pub accel: [i16; 3],
    /// Gyro x, y, z.
    pub gyro: [i16; 3],
    /// Die temperature, °C.
    pub temperature: f32,
}

/// Barometer, compensated by its driver.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RawBarometer {
    /// Pressure in 1/100 Pa.
    pub pressure_centipascal: i32,
    /// Temperature, °C.
    pub temperature: f32,
}

/// Rangefinder, along the body's down axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RawRange {
    /// Distance in cm; `None` where the part says that its reading is invalid.
    pub distance_cm: Option<u16>,
}

/// Battery monitor: voltages at the two ADC pins, mV.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RawBattery {
    /// At the voltage divider.
    pub voltage_mv: u16,
    /// At the current sensor.
    pub current_mv: u16,
}

/// Ground end of the tether: length paid out, mm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RawTether {
    /// Winch encoder.
    pub length_mm: i32,
}

/// Motion capture of the vehicle, as its sender says, in its own frame taken as NED.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RawCapture {
    /// North, East, Down, m.
    pub position: [f32; 3],
    /// Of the nose, from North, rad; `None` where the sender has none.
    pub heading: Option<f32>,
}

/// Motion capture of the vehicle; when it arrived, not when it was taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capture<S: Scalar = f32> {
    /// m.
    pub position: World<V3<S>>,
    /// Of the nose, from North, rad.
    pub heading: Option<S>,
}

/// Calibrated and filtered inertial reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Imu<S: Scalar = f32> {
    /// Angular rate, rad/s. Bias not removed.
    pub gyro: Body<V3<S>>,
    /// Specific force, m/s²: (0, 0, -g) when level at rest.
    pub accel: Body<V3<S>>,
}

/// State of the inertial sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ImuHealth {
    /// Nothing arrived since boot.
    #[default]
    Missing,
    /// Readings are fresh and plausible.
    Good,
    /// The last reading is too old.
    Stale,
    /// Readings repeat to the last bit, which noise forbids.
    Frozen,
    /// Readings sit at the end of the range, or the part says that they are invalid.
    OutOfRange,
    /// They come too seldom or too often.
    Irregular,
}

/// Which altimeter the other one and inertia contradict.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AltimeterReport {
    /// The rangefinder is not used.
    pub range_is_rejected: bool,
    /// The barometer is not used.
    pub baro_is_rejected: bool,
}

/// Battery in SI units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Battery<S> {
    /// Pack voltage, V.
    pub voltage: S,
    /// Current, A.
    pub current: S,
    /// Charge drawn since boot, A s.
    pub drawn: S,
    /// Low-passed voltage per cell, V.
    pub cell: S,
    /// Remaining share by voltage, 0..1.
    pub remaining: S,
}

/// Everything the later stages see of the sensors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensors<S: Scalar = f32> {
    /// `None`: nothing new this tick.
    pub imu: Option<Sample<Imu<S>>>,
    /// Height of the centre of mass over the anchor, m. `None`: nothing new this tick.
    pub altitude: Option<Sample<S>>,
    /// Length paid out, m. `None`: nothing new this tick.
    pub tether_length: Option<Sample<S>>,
    /// `None`: nothing new this tick.
    pub capture: Option<Sample<Capture<S>>>,
    /// Against the ground, m/s. `None`: nothing new this tick.
    pub velocity: Option<Sample<Body<V3<S>>>>,
    /// Direction of the rod on top, vehicle → load, any length. `None`: nothing new this tick.
    pub rod: Option<Sample<World<V3<S>>>>,
    /// Of the line's own sensors.
    pub line: LineSensors<S>,
    /// `None` until the first reading.
    pub battery: Option<Battery<S>>,
    /// State of the inertial sensor.
    pub imu_health: ImuHealth,
    /// The accelerometer says how the vehicle is accelerated: no axis sits at the end of its range.
    pub accel_is_believed: bool,
    /// No new reading came: the inertial values are the last ones.
    pub imu_is_held: bool,
    /// Whether an altitude arrived within its time-out.
    pub altitude_is_fresh: bool,
    /// Whether the altitude comes from the rangefinder (else from the barometer).
    pub altitude_is_ranged: bool,
    /// How far inertia is from what the altimeters show, m.
    pub altitude_error: S,
    /// Which altimeter is not believed.
    pub altimeters: AltimeterReport,
    /// Whether a tether length arrived within its time-out.
    pub tether_is_fresh: bool,
    /// Die temperature of the inertial sensor, °C.
    pub imu_temperature: f32,
}
