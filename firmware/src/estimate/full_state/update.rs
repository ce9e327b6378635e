//! Rows of one measurement: all linearised at the same state, taken one after the other, injected once
//! (`fullstate` section 4).
//!
//! The rows' columns `P hᵀ` are found together and reduced against each other, so that the covariance is passed
//! over once. That is the same as one scalar update after the other.

use super::FullStateFilter;
use super::covariance::{BLOCKS, Blocks, Covariance, Pending};
use super::state::FullState;
use crate::fault::Fault;
use crate::frames::{M3, V3};
use crate::scalar::Scalar;

/// A column of blocks, one for each block of the error state.
pub(super) trait Column<S: Scalar> {
    /// Known as the code is written.
    fn at<const BLOCK: usize>(&self) -> M3<S>;
    /// Or not.
    fn get(&self, block: usize) -> M3<S>;
}

/// Of the covariance.
pub(super) struct Of<'a, S: Scalar, const COLUMN: usize>(pub &'a Covariance<S>);

impl<S: Scalar, const COLUMN: usize> Column<S> for Of<'_, S, COLUMN> {
    #[inline(always)]
    fn at<const BLOCK: usize>(&self) -> M3<S> {
        self.0.at::<BLOCK, COLUMN>()
    }
    #[inline(always)]
    fn get(&self, block: usize) -> M3<S> {
        self.0.block(block, COLUMN)
    }
}

/// Of the covariance, where it is not known which.
struct Any<'a, S: Scalar>(&'a Covariance<S>, usize);

impl<S: Scalar> Column<S> for Any<'_, S> {
    #[inline(always)]
    fn at<const BLOCK: usize>(&self) -> M3<S> {
        self.get(BLOCK)
    }
    #[inline(always)]
    fn get(&self, block: usize) -> M3<S> {
        self.0.block(block, self.1)
    }
}

/// The columns of the rows themselves.
struct Stacked<'a, S: Scalar, const M: usize>(&'a [Pending<S, M>; M]);

impl<S: Scalar, const M: usize> Column<S> for Stacked<'_, S, M> {
    #[inline(always)]
    fn at<const BLOCK: usize>(&self) -> M3<S> {
        self.get(BLOCK)
    }
    #[inline(always)]
    fn get(&self, block: usize) -> M3<S> {
        let mut columns = [V3::zeros(); 3];
        for (own, pending) in columns.iter_mut().zip(self.0) {
            *own = pending.column.get(block).copied().unwrap_or_else(V3::zeros);
        }
        M3::from_columns(&columns)
    }
}

/// The derivative of `M` readings by the error state.
pub(super) trait Rows<S: Scalar, const M: usize> {
    /// Most blocks are not zero: worth code of its own for each block of the error state.
    const IS_DENSE: bool;
    /// `Σ P_k H_kᵀ` over the blocks k of the error state, for each row, where the column of blocks P is symmetric to
    /// a row.
    fn project(&self, column: &impl Column<S>) -> [V3<S>; M];
}

/// Rows with few blocks that are not zero.
pub(super) struct Sparse<S: Scalar, const M: usize, const K: usize>(pub [(usize, [V3<S>; M]); K]);

impl<S: Scalar, const M: usize, const K: usize> Rows<S, M> for Sparse<S, M, K> {
    const IS_DENSE: bool = false;

    #[inline(always)]
    fn project(&self, column: &impl Column<S>) -> [V3<S>; M] {
        let mut sums = [V3::zeros(); M];
        for (block, rows) in &self.0 {
            let own = column.get(*block).transpose();
            for (sum, row) in sums.iter_mut().zip(rows) {
                *sum += own * row;
            }
        }
        sums
    }
}

impl<S: Scalar> FullStateFilter<S> {
    /// Takes `M` innovations (what was read less what was expected; `None` leaves a row out) of one variance.
    /// Returns the sum of the squared normalised innovations. An innovation beyond the gate counts as one on it.
    ///
    /// # Errors
    /// [`Fault::NotFinite`]; the state is spoilt then.
    pub(super) fn update<const M: usize>(
        &self,
        state: &mut FullState<S>,
        rows: &impl Rows<S, M>,
        innovations: [Option<S>; M],
        variance: S,
    ) -> Result<S, Fault> {
        let mut pending = self.columns(&state.covariance, rows, innovations);
        let (error, nis) = self.eliminate(&mut pending, variance);
        state.covariance.reduce(self.used, &pending);
        state.inject(&error)?;
        Ok(nis)
    }

    fn columns<R: Rows<S, M>, const M: usize>(
        &self,
        p: &Covariance<S>,
        rows: &R,
        innovations: [Option<S>; M],
    ) -> [Pending<S, M>; M] {
        let mut pending = innovations.map(|innovation| Pending {
            column: [V3::zeros(); BLOCKS],
            inverse: S::zero(),
            product: [S::zero(); M],
            innovation: innovation.filter(|nu| nu.is_finite()),
        });
        let mut put = |at: usize, columns: [V3<S>; M]| {
            for (row, column) in pending.iter_mut().zip(columns) {
                if let Some(own) = row.column.get_mut(at) {
                    *own = column;
                }
            }
        };
        if R::IS_DENSE {
            put(0, rows.project(&Of::<_, 0>(p)));
            put(1, rows.project(&Of::<_, 1>(p)));
            put(2, rows.project(&Of::<_, 2>(p)));
            put(3, rows.project(&Of::<_, 3>(p)));
            put(4, rows.project(&Of::<_, 4>(p)));
            put(5, rows.project(&Of::<_, 5>(p)));
            put(6, rows.project(&Of::<_, 6>(p)));
            if self.used > 7 {
                put(7, rows.project(&Of::<_, 7>(p)));
            }
            if self.used > 8 {
                put(8, rows.project(&Of::<_, 8>(p)));
            }
        } else {
            for i in 0..self.used {
                put(i, rows.project(&Any(p, i)));
            }
        }
        let products = rows.project(&Stacked(&pending));
        for (row, product) in pending.iter_mut().zip(products) {
            for (own, value) in row.product.iter_mut().zip(product.iter()) {
                *own = *value;
            }
        }
        pending
    }

    /// Row after row: what each takes from those that follow, and what it adds to the error.
    fn eliminate<const M: usize>(
        &self,
        pending: &mut [Pending<S, M>; M],
        variance: S,
    ) -> (Blocks<S>, S) {
        let (mut error, mut nis) = ([V3::zeros(); BLOCKS], S::zero());
        let mut rest = &mut pending[..];
        for at in 0..M {
            let Some((row, later)) = rest.split_first_mut() else { break };
            rest = later;
            let own = row.product.get(at).copied().unwrap_or_else(S::zero);
            let Some(innovation) = row.innovation else { continue };
            let s = (own + variance).max(S::lit(1e-9));
            let inverse = S::one() / s;
            row.inverse = inverse;
            nis += innovation * innovation * inverse;
            let taken = innovation.limit_abs(self.gate * s.sqrt()) * inverse;
            for (sum, column) in error.iter_mut().zip(&row.column) {
                *sum += column * taken;
            }
            for next in rest.iter_mut() {
                let coupling = next.product.get(at).copied().unwrap_or_else(S::zero);
                let share = coupling * inverse;
                for (column, first) in next.column.iter_mut().zip(&row.column) {
                    *column -= first * share;
                }
                for (product, first) in next.product.iter_mut().zip(&row.product) {
                    *product -= *first * share;
                }
                next.innovation = next.innovation.map(|nu| nu - coupling * taken);
            }
        }
        (error, nis)
    }
}
