//! Does the line do what the winch is asked? A winch holds a tension and lets the length go: a vehicle that does not get
//! farther out though it wants to is held by something else, and far more tension than asked is the winch's own.

use crate::scalar::Scalar;

/// What the last seconds show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LineFault {
    /// Far too much tension, and the line does not pay out.
    pub is_caught: bool,
    /// Far too much tension, though nothing is asked of the length.
    pub is_pulled: bool,
}

/// What is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineInput<S> {
    /// Estimated at the line's middle, N.
    pub tension: S,
    /// Asked of the winch, N.
    pub asked: S,
    /// Distance from the anchor, m, and of the reference.
    pub length: S,
    /// m.
    pub wanted: S,
    /// How fast the reference goes out, m/s.
    pub wanted_rate: S,
}

/// Timers, s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LineWatch<S> {
    caught: S,
    pulled: S,
    fault: LineFault,
    /// Of the last step, m, and its rate, low-passed, m/s.
    length: Option<S>,
    rate: S,
}

/// Too much is this many times what is asked, and so many N more.
const TIMES: f64 = 1.7;
const MORE: f64 = 4.0;
/// The vehicle wants so much farther out, m.
const FARTHER: f64 = 0.4;
/// Without a word of the tension: so much farther, m, and slower than this, m/s.
const FAR: f64 = 0.7;
const STANDS: f64 = 0.12;
/// The rate's low-pass, s.
const RATE_TIME: f64 = 0.3;
/// It lasts so long, s.
const CAUGHT_TIME: f64 = 1.0;
const PULLED_TIME: f64 = 1.0;

impl<S: Scalar> LineWatch<S> {
    /// One step over `dt` s; `None`: no winch's line is taut.
    pub fn step(&mut self, input: Option<&LineInput<S>>, dt: S) -> LineFault {
        let Some(z) = input else {
            (self.length, self.rate) = (None, S::zero());
            if self.caught <= S::zero() && self.pulled <= S::zero() {
                self.fault = LineFault::default();
                return self.fault;
            }
            return self.judge(false, false, dt);
        };
        let is_much = z.tension > z.asked * S::lit(TIMES) && z.tension > z.asked + S::lit(MORE);
        let moved = self.length.map_or(S::zero(), |before| (z.length - before) / dt);
        self.rate += (moved - self.rate) * dt * S::lit(1.0 / RATE_TIME);
        self.length = Some(z.length);
        let wants_out = z.wanted > z.length + S::lit(FARTHER);
        let stands = z.wanted > z.length + S::lit(FAR) && self.rate < S::lit(STANDS);
        let stands = stands && z.wanted_rate > S::lit(STANDS);
        self.judge(stands || (is_much && wants_out), is_much && !wants_out, dt)
    }

    fn judge(&mut self, is_caught: bool, is_pulled: bool, dt: S) -> LineFault {
        // A tension that is moved to and fro may hide it for a moment, and so may a line that is slack for one.
        let count = |timer: &mut S, was: bool, holds: bool, time: f64| {
            let next = if holds { *timer + dt } else { *timer - dt * S::lit(0.5) };
            *timer = next.limit(S::zero(), S::lit(2.0 * time));
            *timer >= S::lit(time) || (was && *timer > S::zero())
        };
        let LineFault { is_caught: was_caught, is_pulled: was_pulled } = self.fault;
        self.fault = LineFault {
            is_caught: count(&mut self.caught, was_caught, is_caught, CAUGHT_TIME),
            is_pulled: count(&mut self.pulled, was_pulled, is_pulled, PULLED_TIME),
        };
        self.fault
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(z: LineInput<f64>, seconds: f64) -> LineFault {
        let mut watch = LineWatch::default();
        let steps = (seconds / 0.004) as u32;
        (0..steps).fold(LineFault::default(), |_, _| watch.step(Some(&z), 0.004))
    }

    #[test]
    fn a_line_that_follows_is_left_alone_and_one_that_does_not_is_told_from_a_winch_that_pulls() {
        let good =
            LineInput { tension: 7.0, asked: 6.5, length: 6.0, wanted: 6.1, wanted_rate: 0.3 };
        assert_eq!(after(good, 60.0), LineFault::default());
        let caught = LineInput { tension: 14.0, wanted: 7.0, ..good };
        let silent = LineInput { tension: 6.5, ..caught };
        assert!(after(silent, 2.0).is_caught, "whatever the estimate makes of the tension");
        assert!(after(caught, 2.0).is_caught && !after(caught, 2.0).is_pulled);
        let pulled = LineInput { tension: 25.0, length: 5.0, wanted: 5.2, ..good };
        assert!(after(pulled, 2.0).is_pulled && !after(pulled, 2.0).is_caught);
        assert_eq!(after(pulled, 0.5), LineFault::default(), "a jerk");
    }
}
