//! Division by something that may pass through zero.

use crate::fault::{Invalid, positive};
use crate::scalar::Scalar;

/// How the decoupling matrix is inverted near its singularity. `planar` section 6.4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Inversion<S> {
    /// As the mathematics says; unbounded at the singularity.
    Exact,
    /// Damped least squares everywhere: biases the well-conditioned direction too.
    Damped {
        /// Damping, in the unit of the divisor.
        damping: S,
    },
    /// Damped in the singular direction and near the singularity only.
    Window {
        /// Divisor below which damping begins.
        threshold: S,
        /// Damping at zero.
        damping: S,
    },
}

impl<S: Scalar> Inversion<S> {
    /// Refuses damping and thresholds that are not finite and positive.
    pub(super) fn check(self) -> Result<Self, Invalid> {
        match self {
            Self::Exact => {}
            Self::Damped { damping } => drop(positive("damping", damping)?),
            Self::Window { threshold, damping } => {
                positive("threshold", threshold)?;
                positive("damping", damping)?;
            }
        }
        Ok(self)
    }

    /// Damping squared at this divisor.
    pub(super) fn square(&self, divisor: S) -> S {
        match *self {
            Self::Exact => S::zero(),
            Self::Damped { damping } => damping * damping,
            Self::Window { threshold, damping } => {
                let share = divisor / threshold;
                damping * damping * (S::one() - share * share).max(S::zero())
            }
        }
    }

    /// `value / divisor`.
    pub(super) fn divide(&self, value: S, divisor: S) -> S {
        let square = self.square(divisor);
        if square > S::zero() {
            value * divisor / (divisor * divisor + square)
        } else {
            value / divisor
        }
    }
}
