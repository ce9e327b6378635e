//! Is the vehicle on the ground?
//!
//! Two steps. *Contact*: it should be sinking into the ground and is not. The thrust then ramps down.
//! *Landed*: less thrust than weight, yet the accelerometer shows a full g: the ground carries it.
//! The second step needs no altimeter.

use crate::math::GRAVITY;
use crate::scalar::Scalar;

/// For MAVLink and the estimator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GroundState {
    /// Standing.
    #[default]
    OnGround,
    /// Thrust rises or the first climb is on.
    TakingOff,
    /// Flying.
    InAir,
    /// Coming down.
    Landing,
}

/// What the last step says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GroundContact {
    /// Let the thrust ramp down.
    pub touches: bool,
    /// The ground carries the vehicle.
    pub has_landed: bool,
}

/// Configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchDown<S> {
    /// N.
    pub weight: S,
    /// Height of the centre of mass when landed, m.
    pub ground_height: S,
}

/// Timers, s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TouchDownState<S> {
    contact: S,
    carried: S,
}

/// What the detector looks at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchDownInput<S> {
    /// The vehicle is asked to sink.
    pub wants_down: bool,
    /// Height by the altimeter; `None` without.
    pub height: Option<S>,
    /// Climb rate, m/s.
    pub climb: S,
    /// Total thrust by the model, N.
    pub thrust: S,
    /// Size of the specific force, m/s².
    pub specific_force: S,
}

const CONTACT_TIME: f64 = 0.2;
const CARRIED_TIME: f64 = 0.4;

impl<S: Scalar> TouchDown<S> {
    /// One step over `dt` s.
    pub fn step(
        &self,
        state: &mut TouchDownState<S>,
        z: &TouchDownInput<S>,
        dt: S,
    ) -> GroundContact {
        let count = |timer: &mut S, holds: bool| {
            *timer = if holds { (*timer + dt).min(S::lit(10.0)) } else { S::zero() };
            *timer
        };
        let is_low = z.height.is_some_and(|h| h < self.ground_height + S::lit(0.15));
        let contact =
            count(&mut state.contact, z.wants_down && is_low && z.climb.abs() < S::lit(0.15));
        let g = S::lit(GRAVITY);
        let carried = z.thrust < self.weight * S::lit(0.6)
            && (z.specific_force - g).abs() < g * S::lit(0.15)
            && z.height.is_none_or(|h| h < self.ground_height + S::lit(0.5));
        GroundContact {
            touches: contact >= S::lit(CONTACT_TIME),
            has_landed: count(&mut state.carried, carried) >= S::lit(CARRIED_TIME),
        }
    }
}
