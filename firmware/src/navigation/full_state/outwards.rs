//! How the vehicle moves along its line, for whom the length is compared with.

use super::super::payout::Outwards;
use super::FullFlightState;
use crate::frames::{V3, World};
use crate::math::{GRAVITY, so3};
use crate::scalar::Scalar;

/// Along a shorter line there is no direction, m.
const DISTANCE_MIN: f64 = 0.3;
/// Mean squared innovation of the height: without the length, a filter that contradicts it does not find back.
const SOUND: f64 = 1.5;

impl<S: Scalar> FullFlightState<S> {
    /// Under a specific force, m/s²; `None` without a winch, while the line is slack or the feet touch.
    pub fn outwards(&self, force: &World<V3<S>>) -> Option<Outwards<S>> {
        if self.payout.is_none() || self.is_touching || !self.load.is_taut {
            return None;
        }
        let (place, velocity) = (self.state.position, self.state.velocity);
        let distance = so3::norm(&place).max(S::lit(DISTANCE_MIN));
        let out = place / distance;
        let rate = so3::dot(&out, &velocity);
        let turning = (so3::dot(&velocity, &velocity) - rate * rate) / distance;
        let acceleration = force.0 + V3::new(S::zero(), S::zero(), S::lit(GRAVITY));
        let accel = so3::dot(&out, &acceleration) + turning;
        let is_sound = self.health.means.altitude < S::lit(SOUND);
        Some(Outwards { distance, rate, accel, is_sound })
    }
}
