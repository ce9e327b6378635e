//! Sequential scalar Kalman updates for a small dense covariance.
//!
//! `fullstate` section 4: every row of one vector measurement is linearised at the same state; the
//! correction is collected in `dx` and injected once.

use crate::scalar::Scalar;
use nalgebra::{SMatrix, SVector};

/// One vector measurement in progress.
#[derive(Debug)]
pub struct Correction<'a, S: Scalar, const N: usize> {
    covariance: &'a mut SMatrix<S, N, N>,
    dx: SVector<S, N>,
}

fn dot<S: Scalar, const N: usize>(a: &[S; N], b: &[S; N]) -> S {
    a.iter().zip(b).fold(S::zero(), |sum, (&a, &b)| sum + a * b)
}

impl<'a, S: Scalar, const N: usize> Correction<'a, S, N> {
    /// Starts with no correction.
    pub fn new(covariance: &'a mut SMatrix<S, N, N>) -> Self {
        Self { covariance, dx: SVector::zeros() }
    }

    /// Takes one row `h` with innovation `nu` and variance `r`. Returns this row's squared normalised innovation.
    pub fn row(&mut self, h: &SVector<S, N>, nu: S, r: S) -> S {
        let ([h], [dx]) = (&h.data.0, &mut self.dx.data.0);
        // Symmetric: its columns are its rows.
        let b = self.covariance.data.0.each_ref().map(|column| dot(column, h));
        let s = (dot(h, &b) + r).max(S::lit(1e-9));
        let y = nu - dot(h, dx);
        let nis = y * y / s;
        let inverse = S::one() / s;
        let k = b.map(|b| if S::IS_FLOATING { b * inverse } else { b / s });
        for (sum, &gain) in dx.iter_mut().zip(&k) {
            *sum += gain * y;
        }
        for (column, &along) in self.covariance.data.0.iter_mut().zip(&b) {
            for (entry, &gain) in column.iter_mut().zip(&k) {
                *entry -= gain * along;
            }
        }
        nis
    }

    /// The correction to inject.
    #[must_use]
    pub fn finish(self) -> SVector<S, N> {
        self.dx
    }
}
