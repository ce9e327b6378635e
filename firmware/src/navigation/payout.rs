//! Line does not jump: what a winch's encoder shows from one reading to the next beyond what a drum can turn, or what
//! inertia along the line contradicts, is the encoder's own, slipped, stuck or reset. It is kept from the filter, and if
//! it stays, taken out for good. A line that hangs slack for a moment comes back by itself. But a taut line that goes on
//! running out takes the vehicle with it: then it is the filter that does not know where it is, and the length stands.

use crate::estimate::Witness;
use crate::scalar::Scalar;
use crate::time::Sample;

/// No winch of these is faster, m/s; noise and steps of an encoder, m.
const FASTEST: f64 = 8.0;
const STEP: f64 = 0.25;
/// After so long without a reading, s, line may have gone out unseen.
const GAP: f32 = 0.5;
/// Off what inertia expects, m: in doubt.
const SUSPECT: f64 = 0.1;
/// It agrees with the filter, that coasts meanwhile, within this, m, for so long, s: believed again.
const AGREES: f64 = 0.12;
const AGREES_TIME: f64 = 0.3;
/// In doubt for longer, s, it is taken out, or believed if it is within this of the filter, m.
const PATIENCE: f64 = 1.2;
const BELIEVED: f64 = 0.2;
/// Line taken out bit by bit, each within so many s of the one before, m: nothing but a vehicle that flies away
/// pulls that much off a taut drum.
const RUNAWAY_PAUSE: f64 = 4.0;
const RUNAWAY: f64 = 1.5;
/// What inertia and the altimeters are apart counts so often. A sensor that was silent is no witness for a
/// while, until the attitude has settled, nor a filter that was off, s.
const MARGIN: f64 = 2.0;
const SILENT: f64 = 10.0;
const BLIND: f64 = 2.0;
/// One that shows the same to the last bit is stuck: for so long, s, while the vehicle moves by this, m; or for so long,
/// s, and so many times longer than ever before in this flight.
const STUCK_TIME: f64 = 0.2;
const STUCK_WAY: f64 = 0.06;
const STILL_TIME: f64 = 2.0;
const STILL_TIMES: f64 = 4.0;
/// An encoder of coarser steps, m, may well stand still in calm air.
const COARSE: f64 = 0.02;

/// The distance from the anchor as the filter knows it, m, its rate, m/s, and the acceleration along it, m/s².
#[derive(Clone, Copy, Debug)]
pub(super) struct Outwards<S> {
    pub distance: S,
    pub rate: S,
    pub accel: S,
    /// What else is measured fits it.
    pub is_sound: bool,
}

/// What is known of the inertial sensor.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inertia<S> {
    /// It is heard and believed.
    pub is_known: bool,
    /// How far it is from what the altimeters show, m.
    pub error: S,
}

/// Since when what is shown is in doubt, and since when it agrees again, s.
#[derive(Clone, Copy, Debug)]
struct Doubt<S> {
    lasts: S,
    agrees: S,
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
    /// Since when the inertial sensor was silent, it is no witness for so long, s.
    blind: S,
    /// What it is off by itself, m.
    margin: S,
    /// Taken out lately, m, and for how long that still counts, s.
    lately: S,
    counts: S,
    doubt: Option<Doubt<S>>,
    /// How long it has shown the same, s, and the longest so far in this flight.
    same: S,
    longest: S,
    /// Its smallest step so far, m; zero: it has not moved.
    finest: S,
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
            blind: o,
            margin: o,
            lately: o,
            counts: o,
            doubt: None,
            same: o,
            longest: o,
            finest: o,
            is_stuck: false,
        }
    }

    /// `dt` s on; `None` while the line does not say where the vehicle is.
    pub fn predict(&mut self, outwards: Option<Outwards<S>>, inertia: &Inertia<S>, dt: S) {
        let is_sound = outwards.is_none_or(|outwards| outwards.is_sound);
        let at_least = match (inertia.is_known, is_sound) {
            (false, _) => S::lit(SILENT),
            (true, false) => S::lit(BLIND),
            (true, true) => S::zero(),
        };
        self.blind = (self.blind - dt).max(at_least);
        self.margin = inertia.error.abs() * S::lit(MARGIN);
        self.counts = (self.counts - dt).max(S::zero());
        match &outwards {
            Some(outwards) if self.blind <= S::zero() => {
                self.witness.get_or_insert_default().predict(outwards.accel, dt);
            }
            _ => (self.witness, self.doubt) = (None, None),
        }
        self.outwards = outwards;
    }

    /// The line that is out, m; `None` while what is shown is in doubt.
    pub fn step(&mut self, shown: Sample<S>) -> Option<Sample<S>> {
        if let Some(last) = self.last.replace(shown) {
            let dt = shown.at.seconds_since(last.at);
            let way = shown.value - last.value;
            let most = S::lit(STEP) + S::from_f32(dt.min(GAP)) * S::lit(FASTEST);
            let seconds = S::from_f32(dt.min(GAP));
            self.watch(way, seconds);
            if self.is_stuck {
                self.stand();
                return None;
            }
            if dt < GAP && way.abs() > most {
                self.offset += way;
                self.jumps = self.jumps.saturating_add(1);
                // There and back again leaves no offset, but for the line that moved meanwhile.
                if self.offset.abs() < S::lit(STEP) {
                    self.offset = S::zero();
                }
            } else {
                self.compare(shown.value, seconds);
            }
        }
        let value = (shown.value - self.offset).max(S::zero());
        self.doubt.is_none().then_some(Sample { at: shown.at, value })
    }

    fn watch(&mut self, way: S, dt: S) {
        let was_stuck = self.is_stuck;
        if way.abs() > S::zero() {
            let step = way.abs();
            self.finest = if self.finest > S::zero() { self.finest.min(step) } else { step };
            if self.outwards.is_some() && !was_stuck {
                self.longest = self.longest.max(self.same);
            }
            (self.same, self.is_stuck) = (S::zero(), false);
            if was_stuck {
                self.begin_doubt();
            }
            return;
        }
        self.same += dt;
        let Some(witness) = &self.witness else { return };
        let shown = self.last.map_or(S::zero(), |last| last.value - self.offset);
        let moves = witness.error_of(shown).abs() > S::lit(STUCK_WAY) + self.finest + self.margin;
        // What was never seen to move in this flight says nothing by standing still.
        let still = S::lit(STILL_TIME).max(self.longest * S::lit(STILL_TIMES));
        let is_fine = self.finest < S::lit(COARSE);
        let is_still = is_fine && self.longest > S::zero() && self.same > still;
        self.is_stuck |= is_still || (moves && self.same > S::lit(STUCK_TIME));
    }

    fn begin_doubt(&mut self) {
        self.doubt.get_or_insert(Doubt { lasts: S::zero(), agrees: S::zero() });
    }

    fn compare(&mut self, shown: S, dt: S) {
        let (Some(witness), Some(outwards)) = (&mut self.witness, self.outwards) else { return };
        let length = shown - self.offset;
        let is_suspect = witness.error_of(length).abs() > S::lit(SUSPECT) + self.margin;
        if self.doubt.is_none() && !is_suspect {
            witness.take(length, dt);
            return;
        }
        let off = (length - outwards.distance).abs();
        self.begin_doubt();
        let Some(doubt) = &mut self.doubt else { return };
        doubt.lasts += dt;
        let agrees = off < S::lit(AGREES) + self.margin;
        doubt.agrees = if agrees { doubt.agrees + dt } else { S::zero() };
        let is_over = doubt.lasts > S::lit(PATIENCE);
        if is_over || doubt.agrees > S::lit(AGREES_TIME) {
            self.doubt = None;
        }
        if is_over && off > S::lit(BELIEVED) + self.margin {
            self.take_out(shown - outwards.distance);
        }
        self.stand();
    }

    /// The encoder shows so much that was never paid out, unless it has run on for too long for that.
    fn take_out(&mut self, offset: S) {
        let by = offset - self.offset;
        let before = if self.counts > S::zero() { self.lately } else { S::zero() };
        (self.lately, self.counts) = ((before + by).max(S::zero()), S::lit(RUNAWAY_PAUSE));
        if before > S::lit(RUNAWAY) && by > S::zero() {
            self.offset -= before;
            self.lately = S::zero();
            self.blind = S::lit(SILENT);
            (self.witness, self.outwards) = (None, None);
        } else {
            self.offset = offset;
            self.jumps = self.jumps.saturating_add(1);
        }
    }

    /// The witness begins anew where the filter is.
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

    const SOUND: Inertia<f64> = Inertia { is_known: true, error: 0.0 };

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
            (0..5).for_each(|_| state.predict(Some(truth(time)), &SOUND, 0.004));
            let at = Micros(((from + time) * 1e6) as u64);
            state.step(Sample { at, value: shown(time) }).map(|sample| sample.value)
        };
        (0..steps).map(one).collect()
    }

    fn at_rest(_: f64) -> Outwards<f64> {
        Outwards { distance: 7.0, rate: 0.0, accel: 0.0, is_sound: true }
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
    fn taut_line_that_goes_on_running_out_is_believed_over_a_filter_that_stands_still() {
        let mut state = PayoutState::new();
        fly(&mut state, 0.0, 5.0, |_| 7.0, at_rest);
        let taken = fly(&mut state, 5.0, 8.0, |t| 7.0 + t, at_rest);
        let last = taken.iter().rev().flatten().next().unwrap();
        assert!((last - 15.0).abs() < 0.1, "{last}");
        // Twice a little within a minute is the encoder's own.
        let mut state = PayoutState::new();
        fly(&mut state, 0.0, 5.0, |_| 7.0, at_rest);
        let steps =
            |t: f64| 7.0 + if t > 1.0 { 1.0 } else { 0.0 } + if t > 20.0 { 1.0 } else { 0.0 };
        let taken = fly(&mut state, 5.0, 40.0, steps, at_rest);
        assert!(taken.iter().flatten().all(|length| (length - 7.0).abs() < 0.15));
        assert_eq!(state.jumps, 2);
    }

    #[test]
    fn one_that_shows_the_same_while_the_vehicle_moves_is_stuck_until_it_moves() {
        let mut state = PayoutState::new();
        assert!(fly(&mut state, 0.0, 5.0, |_| 7.0, at_rest).iter().all(Option::is_some));
        assert!(!state.is_stuck, "nothing moves");
        let leaves = |t: f64| {
            let rate = (0.5 * t).min(0.5);
            Outwards {
                distance: 7.0 + 0.5 * t,
                rate,
                accel: if t < 1.0 { 0.5 } else { 0.0 },
                is_sound: true,
            }
        };
        fly(&mut state, 5.0, 2.0, |_| 7.0, leaves);
        assert!(state.is_stuck);
        assert_eq!(show(&mut state, 7000, 7.0), None);
        fly(&mut state, 7.02, 0.1, |t| 7.01 + t, at_rest);
        assert!(!state.is_stuck);
    }

    #[test]
    fn a_coarse_encoder_may_stand_still_in_calm_air() {
        let mut state = PayoutState::new();
        let coarse = |length: f64| (length / 0.1).round() * 0.1;
        let climbs =
            |t: f64| Outwards { distance: 5.0 + 0.5 * t, rate: 0.5, accel: 0.0, is_sound: true };
        fly(&mut state, 0.0, 4.0, |t| coarse(5.0 + 0.5 * t), climbs);
        fly(&mut state, 4.0, 8.0, |_| 7.0, at_rest);
        assert!(!state.is_stuck);
    }
}
