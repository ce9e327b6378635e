//! How fast what the filter does not model moves (`fullstate` sections 3, 5 and 18).

use crate::frames::V3;
use crate::math::filter::decay;
use crate::scalar::Scalar;

/// Random walks as densities (per square root of a second) and correlation times, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Densities {
    /// rad/√s, body axes.
    pub gyro: [f64; 3],
    /// m/s/√s; 0.15 over a moving anchor.
    pub velocity: f64,
    /// N/√s.
    pub tension: f64,
    /// 1/√s.
    pub thrust_scale: f64,
    /// m/s²/√s.
    pub accel_bias: f64,
    /// rad/s/√s, body axes.
    pub gyro_bias: [f64; 3],
    /// m/√s.
    pub altimeter_bias: f64,
    /// Mean wind force over mass: North, East, Down, m/s²/√s.
    pub wind: [f64; 3],
    /// s.
    pub wind_time: f64,
    /// Gusts; `None` for the small filter that goes without.
    pub gust: Option<GustNoise>,
    /// rad/√s or m/√s.
    pub offset: f64,
    /// s; zero for a constant.
    pub offset_time: f64,
}

/// Gusts grow with the wind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GustNoise {
    /// Level, s.
    pub time_level: f64,
    /// Down, s.
    pub time_down: f64,
    /// In still air, m/s².
    pub floor: f64,
    /// Share of the wind's force.
    pub share: f64,
    /// Vertical over level.
    pub down: f64,
    /// Variances of the wind's estimate that do not count as wind.
    pub significance: f64,
}

impl GustNoise {
    /// `fullstate` section 18.
    pub const STANDARD: Self = Self {
        time_level: 10.0,
        time_down: 2.0,
        floor: 0.02,
        share: 0.25,
        down: 0.5,
        significance: 4.0,
    };
}

impl Densities {
    /// `fullstate` sections 5 and 18.
    pub const STANDARD: Self = Self {
        gyro: [0.03 * DEGREE; 3],
        velocity: 0.02,
        tension: 4.0,
        thrust_scale: 5e-4,
        accel_bias: 2e-4,
        gyro_bias: [0.002 * DEGREE; 3],
        altimeter_bias: 1e-3,
        wind: [0.005; 3],
        wind_time: 300.0,
        gust: Some(GustNoise::STANDARD),
        offset: 0.0,
        offset_time: 0.0,
    };
}

const DEGREE: f64 = core::f64::consts::PI / 180.0;

/// The same for one step: variances and what is left of a decaying state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct StepNoise<S: Scalar> {
    pub dt: S,
    pub velocity: S,
    pub tilt: V3<S>,
    pub scalars: V3<S>,
    pub accel_bias: S,
    pub gyro_bias: V3<S>,
    pub wind: V3<S>,
    pub wind_left: S,
    pub gust: Option<StepGust<S>>,
    pub offset: S,
    pub offset_left: S,
}

/// Gusts in one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct StepGust<S: Scalar> {
    pub left: V3<S>,
    /// Variance that a step brings in, by the squared scale of the gusts.
    pub refreshed: V3<S>,
    pub floor_squared: S,
    pub share_squared: S,
    pub significance: S,
}

impl<S: Scalar> StepNoise<S> {
    pub fn new(density: &Densities, dt: f64) -> Self {
        let walk = |density: f64| S::lit(density * density * dt);
        let each = |densities: [f64; 3]| V3::from(densities.map(walk));
        let remains = |time: f64| if time > 0.0 { decay(time, dt) } else { S::one() };
        let gust = density.gust.map(|gust| {
            let left = |time: f64| libm::exp(-dt / time);
            let (level, vertical) = (left(gust.time_level), left(gust.time_down));
            let refreshed = S::lit(1.0 - level * level);
            StepGust {
                left: V3::new(S::lit(level), S::lit(level), S::lit(vertical)),
                refreshed: V3::new(
                    refreshed,
                    refreshed,
                    S::lit(gust.down * gust.down * (1.0 - vertical * vertical)),
                ),
                floor_squared: S::lit(gust.floor * gust.floor),
                share_squared: S::lit(gust.share * gust.share),
                significance: S::lit(gust.significance),
            }
        });
        Self {
            dt: S::lit(dt),
            velocity: walk(density.velocity),
            tilt: each(density.gyro),
            scalars: V3::new(
                walk(density.tension),
                walk(density.thrust_scale),
                walk(density.altimeter_bias),
            ),
            accel_bias: walk(density.accel_bias),
            gyro_bias: each(density.gyro_bias),
            wind: each(density.wind),
            wind_left: remains(density.wind_time),
            gust,
            offset: walk(density.offset),
            offset_left: remains(density.offset_time),
        }
    }
}
