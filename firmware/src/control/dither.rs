//! A tension that moves to find out where the line points (`fullstate` section 20).
//!
//! What changes with the tension acts along the line: the direction of the change of force is the direction of the
//! chord. Mean wind, slow gusts and the accelerometer's bias do not change with it, and drop out.

use crate::scalar::Scalar;

/// How the tension moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A square wave with rounded corners, which an elastic line follows without bouncing.
    Soft,
    /// Plus and minus.
    Square,
}

/// Configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dither<S> {
    /// N; zero or less for none.
    pub amplitude: S,
    /// s.
    pub period: S,
    /// How it moves.
    pub shape: Shape,
}

/// Part of the period gone, 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DitherState<S>(S);

impl<S: Scalar> Dither<S> {
    /// What to add to the tension's set-point, N.
    #[must_use]
    pub fn offset(&self, state: &DitherState<S>) -> S {
        self.wave(state) * self.amplitude
    }

    /// The same as a share of the amplitude.
    #[must_use]
    pub fn wave(&self, state: &DitherState<S>) -> S {
        let (sin, _) = (state.0 * S::lit(core::f64::consts::TAU)).sin_cos();
        match self.shape {
            Shape::Soft => (sin * S::lit(2.0)).tanh() * S::lit(1.0 / TANH_2),
            Shape::Square if sin > S::zero() => S::one(),
            Shape::Square if sin < S::zero() => -S::one(),
            Shape::Square => S::zero(),
        }
    }

    /// Goes on by `dt` s, at most a period.
    pub fn step(&self, state: &mut DitherState<S>, dt: S) {
        let next = state.0 + dt / self.period.max(dt);
        state.0 = if next >= S::one() { next - S::one() } else { next };
    }
}

const TANH_2: f64 = 0.964_027_580_075_816_9;
