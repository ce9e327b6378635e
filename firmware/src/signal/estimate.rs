//! What is known of the vehicle. What an estimator cannot observe is `None`.

use super::AidReport;
use crate::frames::{Attitude, Body, V3, World};
use crate::scalar::Scalar;

/// Position in tether coordinates and the link's force.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TetherState<S> {
    /// Angle of anchor→vehicle above the horizontal, rad.
    pub elevation: S,
    /// Direction of anchor→vehicle from North, rad.
    pub azimuth: S,
    /// Distance from the anchor, m.
    pub length: S,
    /// Pull towards the anchor, N. Negative values are estimation error, not compression.
    pub tension: S,
    /// Whether the tether counts as taut.
    pub is_taut: bool,
}

/// How well measurements and model agree: innovation² over its variance, low-passed over 1 s; 1 is
/// what noise alone gives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FilterHealth<S> {
    /// Accelerometer, mean of three axes.
    pub accel: S,
    /// Altitude.
    pub altitude: S,
    /// Tether length.
    pub length: S,
}

impl FilterHealth<f32> {
    /// What no healthy flight of the full-state filter reaches (`fullstate` section 8): beyond it the filter begins anew.
    pub const FULL_STATE_MOST: Self = Self { accel: 1.5, altitude: 2.5, length: 2.0 };
}

/// Who says where the vehicle is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PositionSource {
    /// Nobody.
    #[default]
    None,
    /// The four-state filter behind the attitude filter.
    FourState,
    /// The full-state filter.
    FullState,
    /// Motion capture.
    Capture,
}

/// Output of the estimate stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate<S: Scalar = f32> {
    /// Body to world.
    pub attitude: Attitude<S>,
    /// Angular rate with the gyro bias removed, rad/s.
    pub rate: Body<V3<S>>,
    /// Gyro bias, rad/s.
    pub gyro_bias: Body<V3<S>>,
    /// Height over the anchor and climb rate (up), m and m/s.
    pub height: S,
    /// Climb rate, m/s, up.
    pub climb: S,
    /// The same by the altimeter alone, m/s, up.
    pub altitude_rate: S,
    /// What shakes the accelerometer behind its filters, rms of each axis, m/s².
    pub vibration: S,
    /// From the anchor, m. `None` before the filter starts and after it diverged.
    pub position: Option<World<V3<S>>>,
    /// m/s; with [`Self::position`].
    pub velocity: Option<World<V3<S>>>,
    /// With [`Self::position`].
    pub tether: Option<TetherState<S>>,
    /// One standard deviation of each coordinate, m.
    pub position_sd: V3<S>,
    /// What may have turned the heading, and the place about the anchor, unseen: one standard deviation, rad.
    pub heading_sd: S,
    /// Force of the air over mass, m/s²; zero where nobody estimates it.
    pub air_force: World<V3<S>>,
    /// Real over modelled thrust; one where nobody estimates it.
    pub thrust_scale: S,
    /// Along the line by accelerometer and thrust alone, N, where somebody looks.
    pub pull: Option<S>,
    /// The line that should hold the vehicle does not.
    pub tether_is_gone: bool,
    /// Sensors that should help the position filter and do not.
    pub aids: AidReport,
    /// How often the line's length jumped, which was taken out.
    pub length_jumps: u16,
    /// The winch shows the same length though the vehicle moves along the line.
    pub length_is_stuck: bool,
    /// How often the position filter began anew in this flight.
    pub restarts: u16,
    /// How often the gyro's bias changed in this flight and was learnt anew.
    pub gyro_changes: u16,
    /// Who says where the vehicle is.
    pub source: PositionSource,
    /// Total thrust by the motor model, N, filtered as the accelerometer is.
    pub thrust: S,
    /// Innovation tests.
    pub health: FilterHealth<S>,
    /// Level and gyro bias were taken at rest.
    pub is_levelled: bool,
    /// The innovation tests have failed for too long.
    pub has_diverged: bool,
}
