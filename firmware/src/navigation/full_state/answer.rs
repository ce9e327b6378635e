//! Does the line answer? What is felt along it must follow the tension that is moved to and fro: a slope of one, whatever
//! the wind. A line that was cut, or never was there, has none; nor is there much left to feel of a strong pull.

use crate::scalar::Scalar;
use crate::time::OUTER_DT;

/// The moments forget in 1 s.
const SHARE: f64 = OUTER_DT;
/// Slope below which it does not answer, and how many steps of it make it gone: 0.4 s.
const SLOPE_MIN: f64 = 0.2;
const STEPS: u16 = 100;
/// Nothing is missed before so many steps, 2 s: the direction may be wrong after a start.
const EARLY: u16 = 500;
/// A pull so strong, N, is missed when so little of it is felt, low-passed over 0.2 s.
const STRONG: f64 = 7.0;
const FELT_MIN: f64 = 0.15;
const QUICK_SHARE: f64 = 0.02;
/// Of what is asked; a line that pulls more is there.
const HELD_SHARE: f64 = 0.8;
/// Variance of the movement that is needed to tell, N².
const MOVED: f64 = 0.5;

/// Low-passed moments of movement and pull.
#[derive(Clone, Copy, Debug)]
pub(super) struct Answer<S> {
    moved: S,
    felt: S,
    quick: S,
    product: S,
    square: S,
    steps: u16,
    age: u16,
    /// Little is felt of what is asked for.
    pub is_doubtful: bool,
}

impl<S: Scalar> Answer<S> {
    /// Nothing known.
    pub fn new() -> Self {
        let o = S::zero();
        Self {
            moved: o,
            felt: o,
            quick: o,
            product: o,
            square: o,
            steps: 0,
            age: 0,
            is_doubtful: false,
        }
    }

    /// One step with the tension that is asked for, what of it is movement, and what was felt, N; true when the line is
    /// gone.
    pub fn step(&mut self, tension: S, moved: S, felt: S) -> bool {
        let share = S::lit(SHARE);
        let follow = |mean: &mut S, sample: S| *mean += (sample - *mean) * share;
        follow(&mut self.moved, moved);
        follow(&mut self.felt, felt);
        follow(&mut self.product, moved * felt);
        follow(&mut self.square, moved * moved);
        self.quick += (felt - self.quick) * S::lit(QUICK_SHARE);
        self.is_doubtful = self.quick < tension * S::lit(FELT_MIN);
        let is_missed = tension > S::lit(STRONG) && self.is_doubtful;
        let variance = self.square - self.moved * self.moved;
        let covariance = self.product - self.moved * self.felt;
        self.age = (self.age + 1).min(EARLY);
        let is_still = variance > S::lit(MOVED) && covariance < variance * S::lit(SLOPE_MIN);
        // One that pulls without an answer is caught, not gone.
        let is_still = is_still && self.felt < tension * S::lit(HELD_SHARE);
        let is_silent = self.age == EARLY && (is_still || is_missed);
        self.steps = if is_silent { self.steps.saturating_add(1) } else { 0 };
        self.steps > STEPS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seconds until a line is called gone, that answers with `slope` until `cut` s; wind swings by `wind` N.
    fn gone_after(slope: f64, cut: f64, wind: f64) -> Option<f64> {
        let mut answer = Answer::<f64>::new();
        (0..15_000).map(|step| f64::from(step) * OUTER_DT).find(|t| {
            let moved = 2.5 * (core::f64::consts::TAU / 1.5 * t).sin().signum();
            let pull = if *t < cut { 6.5 + slope * moved } else { 0.0 };
            answer.step(6.5 + moved, moved, pull + wind * (0.9 * t).sin())
        })
    }

    #[test]
    fn a_line_that_answers_is_there_in_any_wind() {
        for wind in [0.0, 2.0, 4.0] {
            assert_eq!(gone_after(0.8, 100.0, wind), None);
        }
    }

    #[test]
    fn a_line_that_is_cut_is_missed_within_two_seconds() {
        for cut in [20.0, 20.4, 20.8, 21.2] {
            let told = gone_after(1.0, cut, 1.0).unwrap();
            assert!(told > cut && told < cut + 2.0, "{cut} {told}");
        }
    }
}
