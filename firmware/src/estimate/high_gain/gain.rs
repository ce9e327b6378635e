//! Corrector gain that places the discrete eigenvalues at `exp(r Ts/ε)`. `planar` section 7.7.
//!
//! With `q = 1 - exp(r Ts/ε)` and the elementary symmetric sums `e1, e2, e3` of the three q, the gain is
//! `[e1 - e2 + e3, (2 e2 - 3 e3)/(2 Ts), e3/Ts²]`: no cancellation however small `Ts/ε`.

use crate::fault::{Invalid, positive, require};
use crate::scalar::Scalar;

/// Weights of the innovation on `[φ+θ, φ', φ'']`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CorrectorGain<S>(pub [S; 3]);

impl<S: Scalar> CorrectorGain<S> {
    /// From the real roots, the high-gain parameter ε and the period, s.
    ///
    /// # Errors
    /// [`Invalid`] naming `roots`, `epsilon` or `period`.
    pub fn try_new(roots: &[f64; 3], epsilon: f64, period: f64) -> Result<Self, Invalid> {
        let epsilon = positive("epsilon", epsilon)?;
        let period = positive("period", period)?;
        let mut q = [0.0; 3];
        for (q, &root) in q.iter_mut().zip(roots) {
            let root = require("roots", "finite and negative (stable)", root, |r| r < 0.0)?;
            *q = -libm::expm1(root * period / epsilon);
        }
        let [a, b, c] = q;
        let (e1, e2, e3) = (a + b + c, a * b + a * c + b * c, a * b * c);
        let gain = [e1 - e2 + e3, (2.0 * e2 - 3.0 * e3) / (2.0 * period), e3 / (period * period)];
        Ok(Self(gain.map(S::lit)))
    }
}
