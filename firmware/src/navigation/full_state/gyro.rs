//! Does the gyro still turn as the filter takes it to?
//!
//! The filter holds the gyro's bias for nearly constant, and what a changed one turns it by it takes for wind for a dozen
//! seconds. The attitude filter beside it is pulled upright by the accelerometer and follows sooner: that the two lean apart
//! says so after three or four.

use crate::estimate::MahonyState;
use crate::estimate::full_state::FullState;
use crate::frames::V3;
use crate::math::so3;
use crate::scalar::Scalar;

/// Shares of a step: 0.4 s, and of what is usual, 10 s.
const SHARE: f64 = 0.01;
const USUAL_SHARE: f64 = 4e-4;
/// Off the usual, rad. Holding in gusts of 8 m/s it stays below 0.01.
const LEAN: f64 = 0.012;
/// Faster, m/s, the accelerometer's vertical is not the attitude filter's.
const SLOW: f64 = 0.8;
/// After which it needs 6 s to be it again.
const SETTLE: u16 = 1500;
/// After a doubt there is none for 10 s: what is learnt anew leans too.
const PAUSE: u16 = 2500;
/// A bias that was learnt so far off, rad/s, had changed.
const CHANGE: f64 = 0.006;

/// What moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct GyroDoubt<S: Scalar> {
    /// From the filter's down axis to the attitude filter's, world axes, rad, low-passed.
    lean: V3<S>,
    usual: V3<S>,
    /// Steps.
    pause: u16,
    /// The bias when the last doubt came, until it has changed.
    before: Option<V3<S>>,
    /// How often the bias has changed.
    pub changes: u16,
}

impl<S: Scalar> Default for GyroDoubt<S> {
    fn default() -> Self {
        let o = V3::zeros();
        Self { lean: o, usual: o, pause: PAUSE, before: None, changes: 0 }
    }
}

impl<S: Scalar> GyroDoubt<S> {
    /// With the filter.
    pub fn begin_anew(&mut self) {
        *self = Self { changes: self.changes, ..Self::default() };
    }

    /// One step; whether the bias must be learnt anew.
    pub fn step(&mut self, state: &FullState<S>, sit: &MahonyState<S>) -> bool {
        let down = so3::col_z(&state.attitude.0);
        let lean = so3::cross(&down, &so3::col_z(&sit.attitude.0));
        self.lean += (lean - self.lean) * S::lit(SHARE);
        self.usual += (self.lean - self.usual) * S::lit(USUAL_SHARE);
        self.pause = self.pause.saturating_sub(1);
        if is_beyond(state.velocity, SLOW) {
            self.pause = self.pause.max(SETTLE);
        }
        if self.pause > 0 {
            if self.before.is_some_and(|before| is_beyond(state.gyro_bias - before, CHANGE)) {
                self.before = None;
                self.changes = self.changes.saturating_add(1);
            }
            return false;
        }
        let doubts = is_beyond(self.lean - self.usual, LEAN);
        if doubts {
            (self.pause, self.before) = (PAUSE, Some(state.gyro_bias));
        }
        doubts
    }
}

fn is_beyond<S: Scalar>(v: V3<S>, limit: f64) -> bool {
    so3::dot(&v, &v) > S::lit(limit * limit)
}
