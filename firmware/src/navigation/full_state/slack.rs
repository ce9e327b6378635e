//! Does a line of fixed length pull, for the full-state filter? By the tension that it estimates, as `fullstate` section 7
//! says, and by what the accelerometer shows along the line: pull and wind look alike to the filter, and its rows of a
//! taut line would hold it on the sphere while the vehicle falls inwards.

use super::super::slackness::{Slackness, SlacknessState};
use crate::math::filter::decay;
use crate::param::Params;
use crate::scalar::Scalar;
use crate::time::OUTER_DT;

/// Within this share of the length, no pull is expected; one that lasts so many steps counts all the same.
const INSIDE: f64 = 0.85;
const INSIDE_STEPS: u16 = 75;
/// Share of a new sample of the pull.
const PULL_SHARE: f64 = 0.06;
/// A taut line does not let the vehicle move along it. While it does, faster than this, m/s, the wind may be what pulls,
/// up to so many N: then no more than this is felt of the line, N, too little to call it taut.
const MOVES: f64 = 0.2;
const WIND_PULL: f64 = 4.0;
const TAUT_PULL: f64 = 1.5;
/// The inertial speed along the line forgets in this time, s; beyond this, m/s, inwards the line is slack, outwards gone.
const DRIFT_TIME: f64 = 1.0;
const DRIFT_MAX: f64 = 0.25;
/// What is felt may be the line's pull: the more, the faster it must be, m/s/N.
const DRIFT_BY_PULL: f64 = 0.15;

/// Outwards from where a line of full length became slack, m: it must have caught the vehicle by then.
const WAY_MAX: f64 = 0.6;
/// A line that became taut or slack jerks for so many steps: 1.5 s.
const SETTLED: u16 = 375;

/// Configuration.
#[derive(Clone, Copy, Debug)]
pub(super) struct FixedLine<S: Scalar> {
    slackness: Slackness<S>,
    /// m.
    pub length: S,
    /// m/s.
    drift_max: S,
    drift_left: S,
}

/// What moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct FixedLineState<S> {
    pub slackness: SlacknessState,
    /// Low-passed: of the line, and of line and wind together, N.
    pull: S,
    felt: S,
    /// Outwards, integrated from the accelerometer, m/s.
    pub drift: S,
    /// Since it became slack, m, outwards.
    way: S,
    /// Since it last became taut or slack.
    steps: u16,
}

/// Along the line, in one step.
pub(super) struct Along<S> {
    /// From anchor to fastening, m.
    pub distance: S,
    /// The filter's speed outwards, m/s.
    pub speed: S,
    /// Acceleration outwards by the accelerometer, the circle's share added, m/s².
    pub accel: S,
    /// The filter's, N.
    pub tension: S,
    /// Inwards, what is left of the specific force without thrust, N, and the wind that the filter believes in.
    pub felt: S,
    pub wind: S,
}

impl<S: Scalar> FixedLineState<S> {
    /// A winch's line: always.
    pub fn taut() -> Self {
        let slackness = SlacknessState::default();
        let o = S::zero();
        Self { slackness, pull: o, felt: o, drift: o, way: o, steps: SETTLED }
    }

    /// It has moved outwards by more than the line lets it.
    pub fn is_beyond(&self) -> bool {
        self.way > S::lit(WAY_MAX)
    }

    /// It has not become taut or slack lately.
    pub fn is_settled(&self) -> bool {
        self.steps >= SETTLED
    }
}

impl<S: Scalar> FixedLine<S> {
    pub fn new(p: &Params) -> Self {
        // A line that stretches with the dither moves the vehicle.
        let rate = core::f32::consts::TAU / p.dither_period.max(0.1);
        let stretch = p.dither * p.tether_length / p.line_stiffness * rate;
        Self {
            slackness: Slackness::new(p, false),
            length: S::from_f32(p.tether_length),
            drift_max: S::lit(DRIFT_MAX) + S::from_f32(stretch),
            drift_left: decay(DRIFT_TIME, OUTER_DT),
        }
    }

    /// Slack, until a pull has lasted.
    pub fn start(&self) -> FixedLineState<S> {
        FixedLineState { slackness: SlacknessState::SLACK, steps: 0, ..FixedLineState::taut() }
    }

    /// Whether no pull is expected at this distance, m.
    pub fn is_inside(&self, distance: S) -> bool {
        distance < self.length * S::lit(INSIDE)
    }

    /// One step; true when the line has become slack.
    pub fn step(&self, state: &mut FixedLineState<S>, along: &Along<S>) -> bool {
        let was_taut = state.slackness.is_taut;
        state.way = if was_taut { S::zero() } else { state.way + state.drift * S::lit(OUTER_DT) };
        self.judge(state, along);
        let is_taut = state.slackness.is_taut;
        state.steps = if is_taut == was_taut { state.steps.saturating_add(1) } else { 0 };
        was_taut && !is_taut
    }

    fn judge(&self, state: &mut FixedLineState<S>, along: &Along<S>) {
        let is_inside = self.is_inside(along.distance);
        let share = S::lit(PULL_SHARE);
        // More than wind can be is the line's, whatever the filter takes it for.
        let surely = along.felt - S::lit(WIND_PULL);
        let left = along.felt - along.wind;
        let sample = if is_inside { left } else { along.tension.max(surely) };
        state.pull += (sample - state.pull) * share;
        state.felt += (along.felt - state.felt) * share;
        state.drift = (state.drift + along.accel * S::lit(OUTER_DT)) * self.drift_left;
        if state.slackness.is_taut {
            let most = self.drift_max + state.felt.max(S::zero()) * S::lit(DRIFT_BY_PULL);
            if state.drift.abs() > most {
                state.slackness = SlacknessState::SLACK;
            } else {
                self.slackness.step(&mut state.slackness, state.pull, None);
            }
            if !state.slackness.is_taut {
                state.pull = S::zero();
            }
            return;
        }
        if along.speed.abs() > S::lit(MOVES) && state.pull < S::lit(WIND_PULL) {
            state.pull = state.pull.min(S::lit(TAUT_PULL));
        }
        self.slackness.step(&mut state.slackness, state.pull, is_inside.then_some(INSIDE_STEPS));
        if state.slackness.is_taut {
            state.drift = S::zero();
        }
    }
}
