//! Line does not jump: what a winch's encoder shows from one reading to the next beyond what a drum can turn, or what
//! inertia along the line contradicts, is the encoder's own, slipped, stuck or reset, and is taken out for good.

use crate::estimate::Witness;
use crate::scalar::Scalar;
use crate::time::Sample;

/// No winch of these is faster, m/s; noise and steps of an encoder, m.
const FASTEST: f64 = 8.0;
const STEP: f64 = 0.25;
/// After so long without a reading, s, line may have gone out unseen.
const GAP: f32 = 0.5;
/// Off what inertia expects, m: to be kept back, and, low-passed, to be taken out.
const SUSPECT: f64 = 0.1;
/// And so long afterwards, s.
const PROOF: f64 = 0.3;
/// One that shows the same to the last bit for so long, s, while the vehicle moves by this, m, is stuck.
const STUCK_TIME: f64 = 0.2;
const STUCK_WAY: f64 = 0.06;
const ERROR_MOST: f64 = 0.2;

/// The distance from the anchor as the filter knows it, m, its rate, m/s, and the acceleration along it, m/s².
#[derive(Clone, Copy, Debug)]
pub(super) struct Outwards<S> {
    pub distance: S,
    pub rate: S,
    pub accel: S,
}

/// What moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct PayoutState<S> {
    last: Option<Sample<S>>,
    /// Shown, and never paid out, m.
    offset: S,
    /// Jumps so far.
    pub jumps: u16,
    /// While the vehicle hangs on the taut line.
    witness: Option<Witness<S>>,
    outwards: Option<Outwards<S>>,
    /// How long it has shown the same, s.
    same: S,
    /// How long it must still agree, s.
    proof: S,
    /// It has shown what is not so, and takes the filter's distance when it is believed again.
    rejoins: bool,
    /// It does not move though the vehicle does.
    pub is_stuck: bool,
}

impl<S: Scalar> PayoutState<S> {
    pub fn new() -> Self {
        let o = S::zero();
        Self {
            last: None,
            offset: o,
            jumps: 0,
            witness: None,
            outwards: None,
            same: o,
            proof: o,
            rejoins: false,
            is_stuck: false,
        }
    }

    /// `dt` s on; `None` while the line does not say where the vehicle is.
    pub fn predict(&mut self, outwards: Option<Outwards<S>>, dt: S) {
        match &outwards {
            Some(outwards) => self.witness.get_or_insert_default().predict(outwards.accel, dt),
            None => self.witness = None,
        }
        self.outwards = outwards;
    }

    fn take_out(&mut self, shift: S) {
        self.offset += shift;
        self.jumps = self.jumps.saturating_add(1);
        // There and back again leaves no offset, but for the line that moved meanwhile.
        if self.offset.abs() < S::lit(STEP) {
            self.offset = S::zero();
        }
    }

    /// The line that is out, m; `None` while what is shown is in doubt.
    pub fn step(&mut self, shown: Sample<S>) -> Option<Sample<S>> {
        if let Some(last) = self.last.replace(shown) {
            let dt = shown.at.seconds_since(last.at);
            let was_in_doubt = self.proof > S::zero();
            self.proof = (self.proof - S::from_f32(dt)).max(S::zero());
            if was_in_doubt && self.proof <= S::zero() && core::mem::take(&mut self.rejoins) {
                self.join(shown.value);
            }
            let way = shown.value - last.value;
            let most = S::lit(STEP) + S::from_f32(dt.min(GAP)) * S::lit(FASTEST);
            self.watch(way, S::from_f32(dt));
            if self.is_stuck {
                self.rejoins = true;
                self.proof = S::lit(PROOF);
                self.stand();
                return None;
            }
            if dt < GAP && way.abs() > most {
                self.take_out(way);
            } else {
                self.compare(shown.value, S::from_f32(dt.min(GAP)));
            }
        }
        let value = (shown.value - self.offset).max(S::zero());
        let error = self.witness.map_or(S::zero(), |witness| witness.error_of(value));
        if error.abs() > S::lit(SUSPECT) {
            self.proof = S::lit(PROOF);
        }
        (self.proof <= S::zero()).then_some(Sample { at: shown.at, value })
    }

    fn watch(&mut self, way: S, dt: S) {
        if way.abs() > S::zero() {
            (self.same, self.is_stuck) = (S::zero(), false);
            return;
        }
        self.same += dt;
        let error = |witness: &Witness<S>| {
            let shown = self.last.map_or(S::zero(), |last| last.value - self.offset);
            witness.error_of(shown).abs() > S::lit(STUCK_WAY)
        };
        self.is_stuck |= self.same > S::lit(STUCK_TIME) && self.witness.as_ref().is_some_and(error);
    }

    fn compare(&mut self, shown: S, dt: S) {
        let Some(witness) = &mut self.witness else { return };
        let length = shown - self.offset;
        witness.take(length, dt);
        if witness.error.abs() > S::lit(ERROR_MOST) {
            self.jumps = self.jumps.saturating_add(1);
            self.rejoins = true;
            self.join(shown);
        }
    }

    /// What is shown is the filter's distance from now on: the filter was kept from what it showed, the witness has
    /// followed a little.
    fn join(&mut self, shown: S) {
        if let Some(outwards) = &self.outwards {
            self.offset = shown - outwards.distance;
            self.stand();
        }
    }

    fn stand(&mut self) {
        if let (Some(witness), Some(outwards)) = (&mut self.witness, &self.outwards) {
            witness.shift(S::zero());
            witness.stand(outwards.distance);
            witness.observer.climb = outwards.rate;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::Micros;
    use std::vec::Vec;

    fn show(state: &mut PayoutState<f64>, ms: u64, value: f64) -> Option<f64> {
        state.step(Sample { at: Micros(ms * 1000), value }).map(|sample| sample.value)
    }

    #[test]
    fn a_jump_is_taken_out_while_it_lasts_and_reeling_is_not() {
        let mut state = PayoutState::new();
        for step in 0..50 {
            // Reels out at 4 m/s.
            let value = f64::from(step) * 0.08;
            assert_eq!(show(&mut state, u64::from(step as u32) * 20, value), Some(value));
        }
        let near = |shown: Option<f64>, length: f64| (shown.unwrap() - length).abs() < 1e-9;
        assert!(near(show(&mut state, 1000, 5.0), 3.92), "1.08 m in 20 ms");
        assert!(near(show(&mut state, 1020, 5.05), 3.97));
        assert_eq!(show(&mut state, 1040, 3.99), Some(3.99), "and back");
        assert_eq!(state.jumps, 2);
    }

    #[test]
    fn after_a_gap_what_is_shown_is_true() {
        let mut state = PayoutState::new();
        assert_eq!(show(&mut state, 0, 5.0), Some(5.0));
        assert_eq!(show(&mut state, 2000, 9.0), Some(9.0));
    }

    /// 50 Hz for so many s: `shown` and what the vehicle does, over the time since then.
    fn fly(
        state: &mut PayoutState<f64>,
        from: f64,
        seconds: f64,
        shown: impl Fn(f64) -> f64,
        truth: impl Fn(f64) -> Outwards<f64>,
    ) -> Vec<Option<f64>> {
        let steps = (seconds * 50.0) as u32;
        let one = |step: u32| {
            let time = f64::from(step) * 0.02;
            (0..5).for_each(|_| state.predict(Some(truth(time)), 0.004));
            let at = Micros(((from + time) * 1e6) as u64);
            state.step(Sample { at, value: shown(time) }).map(|sample| sample.value)
        };
        (0..steps).map(one).collect()
    }

    fn at_rest(_: f64) -> Outwards<f64> {
        Outwards { distance: 7.0, rate: 0.0, accel: 0.0 }
    }

    #[test]
    fn line_that_runs_out_without_the_vehicle_is_kept_back_and_taken_out() {
        let mut state = PayoutState::new();
        let wobble = |t: f64| 7.0 + 0.02 * (t * 40.0).sin();
        assert!(fly(&mut state, 0.0, 5.0, wobble, at_rest).iter().all(Option::is_some));
        let runs = |t: f64| wobble(t) + (4.0 * t).min(3.0);
        let taken = fly(&mut state, 5.0, 5.0, runs, at_rest);
        assert!(taken.iter().flatten().all(|length| (length - 7.0).abs() < 0.15), "{taken:?}");
        assert!(taken.iter().skip(150).all(Option::is_some), "believed again");
        assert!(state.jumps > 0);
    }

    #[test]
    fn one_that_shows_the_same_while_the_vehicle_moves_is_stuck_until_it_moves() {
        let mut state = PayoutState::new();
        assert!(fly(&mut state, 0.0, 5.0, |_| 7.0, at_rest).iter().all(Option::is_some));
        assert!(!state.is_stuck, "nothing moves");
        let leaves = |t: f64| {
            let rate = (0.5 * t).min(0.5);
            Outwards { distance: 7.0 + 0.5 * t, rate, accel: if t < 1.0 { 0.5 } else { 0.0 } }
        };
        fly(&mut state, 5.0, 2.0, |_| 7.0, leaves);
        assert!(state.is_stuck);
        assert_eq!(show(&mut state, 7000, 7.0), None);
        fly(&mut state, 7.02, 0.1, |t| 7.01 + t, at_rest);
        assert!(!state.is_stuck);
    }
}
