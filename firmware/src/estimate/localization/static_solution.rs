//! Position and tension from one balance of forces and the altitude. `localization` section 5.
//!
//! With a known attitude there is no sign to guess: direction and tension come from three accelerometer
//! axes, range from the altitude. An altitude error grows by one over the sine of the elevation.

use crate::estimate::Ekf4Measurement;
use crate::frames::{Body, V3, World};
use crate::math::filter::first_order;
use crate::math::so3;
use crate::scalar::Scalar;

/// Below this pull, N, there is no direction.
const TENSION_FLOOR: f64 = 0.05;
/// Below this sine of the elevation the altitude says nothing of the range.
const SINE_FLOOR: f64 = 0.05;
/// Cut-off of the published low-pass, rad/s.
const CUT_OFF: f32 = 2.0;

/// A place and a pull.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StaticSolution<S: Scalar> {
    /// From the anchor, m.
    pub position: World<V3<S>>,
    /// N.
    pub tension: S,
}

/// Why there is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotSolved {
    /// A reading is missing or not finite.
    NotFinite,
    /// Too little pull.
    Slack,
    /// The cable lies too flat, or points up.
    Low,
    /// The altitude is not positive.
    OutOfRange,
}

/// What neither thrust nor weight explains, N, world axes: minus the tension times the direction from
/// anchor to vehicle, when the vehicle does not accelerate.
#[must_use]
pub fn cable_pull<S: Scalar>(mass: S, z: &Ekf4Measurement<S>) -> World<V3<S>> {
    let thrust = V3::new(S::zero(), S::zero(), z.thrust);
    z.attitude.to_world(Body(z.accel.0 * mass + thrust))
}

/// Follows the pull out to where the altitude says.
///
/// # Errors
/// [`NotSolved`], in the order of its checks.
pub fn solve_static<S: Scalar>(
    pull: &World<V3<S>>,
    altitude: Option<S>,
) -> Result<StaticSolution<S>, NotSolved> {
    let s = &pull.0;
    let altitude = altitude
        .filter(|h| h.is_finite() && s.iter().all(|x| x.is_finite()))
        .ok_or(NotSolved::NotFinite)?;
    let tension = so3::norm(s);
    if tension < S::lit(TENSION_FLOOR) {
        return Err(NotSolved::Slack);
    }
    let u = -s / tension;
    if -u.z < S::lit(SINE_FLOOR) {
        return Err(NotSolved::Low);
    }
    if altitude <= S::zero() {
        return Err(NotSolved::OutOfRange);
    }
    Ok(StaticSolution { position: World(u * (altitude / -u.z)), tension })
}

/// The static solution of low-passed readings: the baseline that the filters are measured against.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LowPassLocator<S> {
    /// kg.
    pub mass: S,
    gain: S,
}

/// What moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LowPassState<S: Scalar> {
    filtered: Option<(World<V3<S>>, S)>,
    /// The last solution: held while there is none.
    pub solution: Option<StaticSolution<S>>,
}

impl<S: Scalar> Default for LowPassState<S> {
    fn default() -> Self {
        Self { filtered: None, solution: None }
    }
}

impl<S: Scalar> LowPassLocator<S> {
    /// At a period of `dt` s.
    #[must_use]
    pub fn new(mass: S, dt: f32) -> Self {
        Self { mass, gain: first_order(1.0 / CUT_OFF, dt) }
    }

    /// Takes one sample; one that is not finite is passed over.
    ///
    /// # Errors
    /// [`NotSolved`] says why there is no new place; the last one is held.
    pub fn step(
        &self,
        state: &mut LowPassState<S>,
        z: &Ekf4Measurement<S>,
    ) -> Result<StaticSolution<S>, NotSolved> {
        let pull = cable_pull(self.mass, z);
        let altitude = z.altitude.filter(|h| h.is_finite()).ok_or(NotSolved::NotFinite)?;
        if !pull.0.iter().all(|x| x.is_finite()) {
            return Err(NotSolved::NotFinite);
        }
        let (s, h) = state.filtered.get_or_insert((pull, altitude));
        s.0 += (pull.0 - s.0) * self.gain;
        *h += (altitude - *h) * self.gain;
        let found = solve_static(s, Some(*h));
        if let Ok(solution) = found {
            state.solution = Some(solution);
        }
        found
    }
}
