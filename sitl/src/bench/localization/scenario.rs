//! The simulated flight of the article's section 6; `--set` paths are these keys.

use serde::{Deserialize, Serialize};

/// A circle about the station, rising and sinking, and what the sensors do.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LocalizationScenario {
    /// Cable tension, N.
    pub tension: f64,
    /// Mean height, m.
    pub altitude: f64,
    /// Amplitude about it, m, with a period of 25 s.
    pub swing: f64,
    /// Of the circle, m.
    pub radius: f64,
    /// Along it, m/s.
    pub speed: f64,
    /// s.
    pub duration: f64,
    /// kg.
    pub mass: f64,
    /// White noise of the specific force, over g.
    pub accel_noise: f64,
    /// m.
    pub altitude_noise: f64,
    /// Each Euler angle, deg.
    pub attitude_noise: f64,
    /// deg/s.
    pub gyro_noise: f64,
    /// m.
    pub length_noise: f64,
    /// True over reported thrust, minus one.
    pub thrust_error: f64,
    /// On each axis, over g.
    pub accel_bias: f64,
}

impl Default for LocalizationScenario {
    fn default() -> Self {
        Self {
            tension: 2.0,
            altitude: 5.0,
            swing: 1.0,
            radius: 2.5,
            speed: 1.0,
            duration: 50.0,
            mass: 0.45,
            accel_noise: 0.1,
            altitude_noise: 0.1,
            attitude_noise: 0.1,
            gyro_noise: 0.1,
            length_noise: 0.02,
            thrust_error: 0.0,
            accel_bias: 0.0,
        }
    }
}

impl LocalizationScenario {
    /// At another mean height, the swing in proportion: what the reference's sweep over altitude does.
    #[must_use]
    pub fn at_altitude(&self, altitude: f64) -> Self {
        Self { altitude, swing: self.swing * altitude / self.altitude, ..self.clone() }
    }

    pub(super) fn check(&self) -> Result<(), String> {
        let ranges = [
            ("tension", self.tension, 0.01, 1e3),
            ("altitude", self.altitude, 0.1, 1e3),
            ("swing", self.swing, 0.0, 1e3),
            ("radius", self.radius, 0.1, 1e3),
            ("speed", self.speed, 0.0, 50.0),
            ("duration", self.duration, 6.0, 3600.0),
            ("mass", self.mass, 0.01, 1e3),
            ("accel_noise", self.accel_noise, 0.0, 10.0),
            ("altitude_noise", self.altitude_noise, 0.0, 100.0),
            ("attitude_noise", self.attitude_noise, 0.0, 90.0),
            ("gyro_noise", self.gyro_noise, 0.0, 1e3),
            ("length_noise", self.length_noise, 0.0, 100.0),
            ("thrust_error", self.thrust_error, -0.9, 10.0),
            ("accel_bias", self.accel_bias, -1.0, 1.0),
        ];
        for (key, value, min, max) in ranges {
            crate::scenario::within(key, value, min, max)?;
        }
        Ok(())
    }
}
