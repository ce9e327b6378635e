//! Does the link pull? With hysteresis in force and time.

use crate::param::Params;
use crate::scalar::Scalar;

/// Pull that ends slackness, N, and for how many steps it, or its lack, must last.
const TAUT_TENSION: f64 = 1.6;
const TAUT_STEPS: u16 = 15;
const SLACK_STEPS: u16 = 38;

/// Configuration.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slackness<S> {
    slack_tension: S,
    /// Never slack.
    is_rigid: bool,
}

/// What moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct SlacknessState {
    pub is_taut: bool,
    steps: u16,
}

impl SlacknessState {
    /// Until a pull has lasted.
    pub const SLACK: Self = Self { is_taut: false, steps: 0 };
}

impl Default for SlacknessState {
    fn default() -> Self {
        Self { is_taut: true, steps: 0 }
    }
}

impl<S: Scalar> Slackness<S> {
    pub fn new(p: &Params, is_rigid: bool) -> Self {
        Self { slack_tension: S::from_f32(p.slack_tension), is_rigid }
    }

    /// One step with the estimated tension, N. A `patience` is for how many steps a pull must last where none is expected.
    pub fn step(&self, state: &mut SlacknessState, tension: S, patience: Option<u16>) {
        let (crossed, needed) = if state.is_taut {
            (tension < self.slack_tension && !self.is_rigid, SLACK_STEPS)
        } else {
            (tension > S::lit(TAUT_TENSION), patience.unwrap_or(TAUT_STEPS))
        };
        state.steps = if crossed { state.steps + 1 } else { 0 };
        if state.steps >= needed {
            *state = SlacknessState { is_taut: !state.is_taut, steps: 0 };
        }
    }
}
