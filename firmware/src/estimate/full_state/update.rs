//! Rows of one measurement: all linearised at the same state, taken one after the other, injected once
//! (`fullstate` section 4).
//!
//! The rows' columns `P hᵀ` are found together and reduced against each other, so that the covariance is passed
//! over once. That is the same as one scalar update after the other.

use super::FullStateFilter;
use super::covariance::{BLOCKS, Blocks, Reduction};
use super::state::FullState;
use crate::fault::Fault;
use crate::frames::{M3, V3};
use crate::scalar::Scalar;

/// The derivative of `M` readings by the error state.
pub(super) trait Rows<S: Scalar, const M: usize> {
    /// `Σ column(k) H_kᵀ` over the blocks k of the error state, for each row.
    fn project(&self, column: impl Fn(usize) -> M3<S>) -> [V3<S>; M];
}

/// Rows with few blocks that are not zero.
pub(super) struct Sparse<S: Scalar, const M: usize, const K: usize>(pub [(usize, [V3<S>; M]); K]);

impl<S: Scalar, const M: usize, const K: usize> Rows<S, M> for Sparse<S, M, K> {
    #[inline(always)]
    fn project(&self, column: impl Fn(usize) -> M3<S>) -> [V3<S>; M] {
        let mut sums = [V3::zeros(); M];
        for (block, rows) in &self.0 {
            let own = column(*block);
            for (sum, row) in sums.iter_mut().zip(rows) {
                *sum += own * row;
            }
        }
        sums
    }
}

/// A row on its way through the elimination.
struct Pending<S: Scalar, const M: usize> {
    reduction: Reduction<S>,
    /// Its product with each row.
    product: [S; M],
    innovation: Option<S>,
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
        let (mut error, nis, reductions) = {
            let p = &state.covariance;
            let mut pending = self.columns(rows, innovations, |i, k| p.block(i, k));
            let (error, nis) = self.eliminate(&mut pending, variance);
            (error, nis, pending.map(|row| row.reduction))
        };
        state.covariance.reduce(self.used, &reductions);
        if let Some(unused) = error.get_mut(self.used..) {
            unused.fill(V3::zeros());
        }
        state.inject(&error)?;
        Ok(nis)
    }

    fn columns<const M: usize>(
        &self,
        rows: &impl Rows<S, M>,
        innovations: [Option<S>; M],
        p: impl Fn(usize, usize) -> M3<S>,
    ) -> [Pending<S, M>; M] {
        let mut pending = innovations.map(|innovation| Pending {
            reduction: Reduction { column: [V3::zeros(); BLOCKS], inverse: S::zero() },
            product: [S::zero(); M],
            innovation: innovation.filter(|nu| nu.is_finite()),
        });
        for i in 0..self.used {
            let columns = rows.project(|k| p(i, k));
            for (row, column) in pending.iter_mut().zip(columns) {
                if let Some(own) = row.reduction.column.get_mut(i) {
                    *own = column;
                }
            }
        }
        // Σ_k H_k B_k, transposed: B_kᵀ stands for a column of blocks.
        let products = rows.project(|k| stacked(&pending, k));
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
        let mut at = 0;
        while let Some((row, later)) = rest.split_first_mut() {
            rest = later;
            let own = row.product.get(at).copied().unwrap_or_else(S::zero);
            at += 1;
            let Some(innovation) = row.innovation else { continue };
            let s = (own + variance).max(S::lit(1e-9));
            let inverse = S::one() / s;
            row.reduction.inverse = inverse;
            nis += innovation * innovation * inverse;
            let taken = innovation.limit_abs(self.gate * s.sqrt()) * inverse;
            for (sum, column) in error.iter_mut().zip(&row.reduction.column) {
                *sum += column * taken;
            }
            for next in rest.iter_mut() {
                let coupling = next.product.get(at - 1).copied().unwrap_or_else(S::zero);
                let share = coupling * inverse;
                for (column, first) in next.reduction.column.iter_mut().zip(&row.reduction.column) {
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

/// `B_kᵀ`, a row for each pending column.
#[inline(always)]
fn stacked<S: Scalar, const M: usize>(pending: &[Pending<S, M>; M], block: usize) -> M3<S> {
    let mut rows = M3::zeros();
    for (row, pending) in pending.iter().enumerate() {
        if let Some(column) = pending.reduction.column.get(block) {
            for (entries, value) in rows.data.0.iter_mut().zip(column.iter()) {
                if let Some(entry) = entries.get_mut(row) {
                    *entry = *value;
                }
            }
        }
    }
    rows
}
