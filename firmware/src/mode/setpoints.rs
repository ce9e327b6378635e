//! What a mode asks of the loops below, and how it ends.

use crate::control::AttitudeCommand;
use crate::scalar::Scalar;
use crate::signal::FlightReference;
use crate::supervisor::{Failure, GroundState};

/// What one step asks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Setpoints<S: Scalar> {
    /// For the rate loop and the mixer.
    pub attitude: AttitudeCommand<S>,
    /// Where to be, in the modes that know.
    pub reference: Option<FlightReference<S>>,
    /// Of the winch, N.
    pub tension: S,
    /// How far the tension is moved off it now, N, to see where the line points.
    pub dither: S,
    /// On the ground, or not any more.
    pub ground: GroundState,
    /// The vehicle shall come down: ground contact ends the flight.
    pub wants_down: bool,
    pub notice: Option<Notice<S>>,
}

impl<S: Scalar> Setpoints<S> {
    /// Tension asked in this step, its movement included, N.
    pub fn pull(&self) -> S {
        self.tension + self.dither
    }
}

/// What a mode has to say once.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Notice<S> {
    /// It has done what it was asked: Tether Hold flies on.
    Complete,
    /// It learnt how much the thrust is, as a share of the modelled one.
    ThrustRatio(S),
    /// For the operator.
    Warning(&'static str),
}

/// A mode can't go on: a failure like any other, for the failsafe table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Exit {
    pub failure: Failure,
    /// What the operator reads; at most 50 bytes.
    pub text: &'static str,
}

impl Exit {
    /// The mode's own machinery failed.
    pub const fn failed(text: &'static str) -> Self {
        Self { failure: Failure::ModeFailed, text }
    }

    /// The link pulls less than it must.
    pub const fn slack(text: &'static str) -> Self {
        Self { failure: Failure::TetherSlack, text }
    }
}

/// Of every mode that stands on the link.
pub(super) const SLACK: Exit = Exit::slack("Tether slack: descending");
