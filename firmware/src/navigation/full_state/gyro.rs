//! Does the gyro still turn as the filter takes it to?
//!
//! The filter holds the gyro's bias for nearly constant, and what a changed one turns it by it takes for wind for a dozen
//! seconds. The attitude filter beside it is pulled upright by the accelerometer and follows sooner: that the two lean apart
//! says so after three or four. Only about the axis in the line's vertical plane: in the plane itself a tension that moves, a
//! start and a stop make them lean as well.

use crate::estimate::MahonyState;
use crate::estimate::full_state::FullState;
use crate::frames::V3;
use crate::math::so3;
use crate::scalar::Scalar;

/// Shares of a step: 0.4 s, and of what is usual, 10 s.
const SHARE: f64 = 0.01;
const USUAL_SHARE: f64 = 4e-4;
/// Off the usual, rad. Holding up to 3 m/s it stays below; in gusts of 8 m/s one flight of ten passes it.
const LEAN: f64 = 0.01;
/// Nearer to the anchor's vertical, m, the line has hardly a plane.
const LEVEL: f64 = 1.0;
/// Faster, or wanted to be faster than this, m/s, the accelerometer's vertical is not the attitude filter's.
const SLOW: f64 = 0.8;
const STILL: f64 = 0.05;
/// After which it needs 8 s to be it again, and what is usual is what is, in 1 s.
const SETTLE: u16 = 2000;
const SETTLING_SHARE: f64 = 4e-3;
/// After a doubt there is none for 10 s: what is learnt anew leans too.
const PAUSE: u16 = 2500;
/// A bias that was learnt so far off, rad/s, had changed.
const CHANGE: f64 = 0.006;

/// What moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct GyroDoubt<S: Scalar> {
    /// From the filter's down axis to the attitude filter's, across the line's plane, rad, low-passed.
    lean: S,
    usual: S,
    /// Steps.
    pause: u16,
    /// The bias when the last doubt came, until it has changed.
    before: Option<V3<S>>,
    /// How often the bias has changed.
    pub changes: u16,
}

impl<S: Scalar> Default for GyroDoubt<S> {
    fn default() -> Self {
        let o = S::zero();
        Self { lean: o, usual: o, pause: PAUSE, before: None, changes: 0 }
    }
}

impl<S: Scalar> GyroDoubt<S> {
    /// With the filter.
    pub fn begin_anew(&mut self) {
        *self = Self { changes: self.changes, ..Self::default() };
    }

    /// One step, with the velocity that is wanted, m/s; whether the bias must be learnt anew.
    pub fn step(&mut self, state: &FullState<S>, sit: &MahonyState<S>, wanted: &V3<S>) -> bool {
        let down = so3::col_z(&state.attitude.0);
        let apart = so3::cross(&down, &so3::col_z(&sit.attitude.0));
        let place = V3::new(state.position.x, state.position.y, S::zero());
        let lean = so3::dot(&apart, &place) / so3::norm(&place).max(S::lit(LEVEL));
        self.lean += (lean - self.lean) * S::lit(SHARE);
        let settles = self.pause > 0 && self.before.is_none();
        let share = if settles { SETTLING_SHARE } else { USUAL_SHARE };
        self.usual += (self.lean - self.usual) * S::lit(share);
        self.pause = self.pause.saturating_sub(1);
        if is_beyond(state.velocity, SLOW) || is_beyond(*wanted, STILL) {
            self.pause = self.pause.max(SETTLE);
        }
        if self.pause > 0 {
            if self.before.is_some_and(|before| is_beyond(state.gyro_bias - before, CHANGE)) {
                self.before = None;
                self.changes = self.changes.saturating_add(1);
            }
            return false;
        }
        // A doubt that no bias confirmed is over.
        self.before = None;
        let doubts = (self.lean - self.usual).abs() > S::lit(LEAN);
        if doubts {
            (self.pause, self.before) = (PAUSE, Some(state.gyro_bias));
        }
        doubts
    }
}

fn is_beyond<S: Scalar>(v: V3<S>, limit: f64) -> bool {
    so3::dot(&v, &v) > S::lit(limit * limit)
}
