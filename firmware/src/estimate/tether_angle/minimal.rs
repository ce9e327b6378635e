//! Tether angle and tilt from one accelerometer reading and the thrust. `inertial` section 3.

use crate::math::{GRAVITY, wrap_pi};
use crate::model::TetherAngleModel;
use crate::scalar::Scalar;

/// Below this tension over mass, m/s², the tether counts as slack: a thrust mismatch of 0.5 and 2.5
/// deviations of filtered noise.
pub const TENSION_FLOOR: f64 = 1.0;

/// Angles found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Located<S> {
    /// Tension over mass, m/s².
    pub tension: S,
    /// Of the tether, rad from straight up.
    pub angle: S,
    /// Of the thrust axis, rad.
    pub tilt: S,
}

/// Why there are none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NotLocated<S> {
    /// A reading is not finite.
    NotFinite,
    /// The tension over mass, m/s², is below the floor.
    Slack(S),
    /// No angle explains this tension over mass, m/s².
    OutOfRange(S),
}

/// Solves (8) for the angles. `force` is the specific force along body x and z, m/s²; `rate` the tether's
/// rate for the centripetal term, rad/s, or zero for the paper's minimal form. Of the two mirror images
/// the one whose tilt is nearer to `prior` is taken; they are twice the tether angle apart, so that below
/// about 20° the choice is unreliable.
///
/// # Errors
/// [`NotLocated`] says why there is no answer; the readings are never clamped into one.
pub fn locate<S: Scalar>(
    model: &TetherAngleModel<S>,
    force: [S; 2],
    rate: S,
    prior: S,
    floor: S,
) -> Result<Located<S>, NotLocated<S>> {
    let [ax, az] = force;
    if ![ax, az, rate, prior].iter().all(|x| x.is_finite()) {
        return Err(NotLocated::NotFinite);
    }
    let along = model.thrust - az;
    let tension = (ax * ax + along * along).sqrt();
    if tension < floor {
        return Err(NotLocated::Slack(tension));
    }
    let centripetal = model.length * rate * rate;
    let cos = (model.thrust * along / tension - tension + centripetal) / S::lit(GRAVITY);
    if cos.abs() > S::one() {
        return Err(NotLocated::OutOfRange(tension));
    }
    let between = (-ax).atan2(along);
    let angle = cos.acos();
    let off = |angle: S| wrap_pi(angle - between - prior).abs();
    let angle = if off(-angle) < off(angle) { -angle } else { angle };
    Ok(Located { tension, angle, tilt: wrap_pi(angle - between) })
}
