//! Line does not jump: what a winch's encoder shows from one reading to the next beyond what a drum can turn is the
//! encoder's own, slipped or reset, and is taken out for good.

use crate::scalar::Scalar;
use crate::time::Sample;

/// No winch of these is faster, m/s; noise and steps of an encoder, m.
const FASTEST: f64 = 8.0;
const STEP: f64 = 0.25;
/// After so long without a reading, s, line may have gone out unseen.
const GAP: f32 = 0.5;

/// What moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct PayoutState<S> {
    last: Option<Sample<S>>,
    /// Shown, and never paid out, m.
    offset: S,
    /// Jumps so far.
    pub jumps: u16,
}

impl<S: Scalar> PayoutState<S> {
    pub fn new() -> Self {
        Self { last: None, offset: S::zero(), jumps: 0 }
    }

    /// The line that is out, m.
    pub fn step(&mut self, shown: Sample<S>) -> Sample<S> {
        if let Some(last) = self.last.replace(shown) {
            let dt = shown.at.seconds_since(last.at);
            let way = shown.value - last.value;
            let most = S::lit(STEP) + S::from_f32(dt.min(GAP)) * S::lit(FASTEST);
            if dt < GAP && way.abs() > most {
                self.offset += way;
                self.jumps = self.jumps.saturating_add(1);
                // There and back again leaves no offset, but for the line that moved meanwhile.
                if self.offset.abs() < S::lit(STEP) {
                    self.offset = S::zero();
                }
            }
        }
        Sample { at: shown.at, value: (shown.value - self.offset).max(S::zero()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::Micros;

    fn show(state: &mut PayoutState<f64>, ms: u64, value: f64) -> f64 {
        state.step(Sample { at: Micros(ms * 1000), value }).value
    }

    #[test]
    fn a_jump_is_taken_out_while_it_lasts_and_reeling_is_not() {
        let mut state = PayoutState::new();
        for step in 0..50 {
            // Reels out at 4 m/s.
            let value = f64::from(step) * 0.08;
            assert_eq!(show(&mut state, u64::from(step as u32) * 20, value), value);
        }
        assert!((show(&mut state, 1000, 5.0) - 3.92).abs() < 1e-9, "1.08 m in 20 ms");
        assert!((show(&mut state, 1020, 5.05) - 3.97).abs() < 1e-9);
        assert_eq!(show(&mut state, 1040, 3.99), 3.99, "and back");
        assert_eq!(state.jumps, 2);
    }

    #[test]
    fn after_a_gap_what_is_shown_is_true() {
        let mut state = PayoutState::new();
        assert_eq!(show(&mut state, 0, 5.0), 5.0);
        assert_eq!(show(&mut state, 2000, 9.0), 9.0);
    }
}
