//! Rows of one measurement: all linearised at the same state, taken one after the other, injected once
//! (`fullstate` section 4).
//!
//! The rows' columns `P hᵀ` are found together and reduced against each other, so that the covariance is passed
//! over once. That is the same as one scalar update after the other.

use super::FullStateFilter;
use super::covariance::{BLOCKS, Blocks, Covariance};
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
struct Own<'a, S: Scalar, const M: usize>(&'a Columns<S, M>);

/// `P hᵀ` of each row, by blocks.
type Columns<S, const M: usize> = [[V3<S>; M]; BLOCKS];

impl<S: Scalar, const M: usize> Column<S> for Own<'_, S, M> {
    #[inline(always)]
    fn at<const BLOCK: usize>(&self) -> M3<S> {
        self.get(BLOCK)
    }
    #[inline(always)]
    fn get(&self, block: usize) -> M3<S> {
        let mut columns = [V3::zeros(); 3];
        for (own, column) in columns.iter_mut().zip(self.0.get(block).into_iter().flatten()) {
            *own = *column;
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

/// What becomes of an innovation beyond the gate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outlier {
    /// It counts as one on the gate: of a sensor without which the filter does not fly.
    Clamped,
    /// The row is left out: of one that it can do without.
    LeftOut,
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
    /// Returns the sum of the squared normalised innovations.
    ///
    /// # Errors
    /// [`Fault::NotFinite`]; the state is spoilt then.
    pub(super) fn update<const M: usize>(
        &self,
        state: &mut FullState<S>,
        rows: &impl Rows<S, M>,
        innovations: [Option<S>; M],
        variance: S,
        outlier: Outlier,
    ) -> Result<S, Fault> {
        let mut columns = self.columns(&state.covariance, rows);
        let products = rows.project(&Own(&columns));
        let factors = Factors::new(products, innovations, variance, (self.gate, outlier));
        let error = factors.eliminate(&mut columns);
        state.covariance.reduce(self.used, &columns, &factors.inverse);
        state.inject(&error)?;
        Ok(factors.nis)
    }

    fn columns<R: Rows<S, M>, const M: usize>(&self, p: &Covariance<S>, rows: &R) -> Columns<S, M> {
        let mut columns = [[V3::zeros(); M]; BLOCKS];
        if R::IS_DENSE {
            columns[0] = rows.project(&Of::<_, 0>(p));
            columns[1] = rows.project(&Of::<_, 1>(p));
            columns[2] = rows.project(&Of::<_, 2>(p));
            columns[3] = rows.project(&Of::<_, 3>(p));
            columns[4] = rows.project(&Of::<_, 4>(p));
            columns[5] = rows.project(&Of::<_, 5>(p));
            columns[6] = rows.project(&Of::<_, 6>(p));
            if self.used > 7 {
                columns[7] = rows.project(&Of::<_, 7>(p));
            }
            if self.used > 8 {
                columns[8] = rows.project(&Of::<_, 8>(p));
            }
        } else {
            for (i, own) in columns.iter_mut().enumerate().take(self.used) {
                *own = rows.project(&Any(p, i));
            }
        }
        columns
    }
}

/// How the rows depend on one another: row after row, what each leaves of those that follow.
struct Factors<S, const M: usize> {
    /// Of a row, by the earlier one that it takes it from.
    share: [[S; M]; M],
    /// One over the innovation's variance; zero for a row left out.
    inverse: [S; M],
    /// Innovation within the gate, over its variance.
    taken: [S; M],
    /// Sum of the squared normalised innovations.
    nis: S,
}

impl<S: Scalar, const M: usize> Factors<S, M> {
    /// From `H P Hᵀ`.
    fn new(
        products: [V3<S>; M],
        innovations: [Option<S>; M],
        variance: S,
        (gate, outlier): (S, Outlier),
    ) -> Self {
        let o = S::zero();
        let mut factors = Self { share: [[o; M]; M], inverse: [o; M], taken: [o; M], nis: o };
        let mut rows = products.map(|row| {
            let [row] = row.data.0;
            row
        });
        let mut innovations = innovations.map(|nu| nu.filter(|nu| nu.is_finite()));
        for at in 0..M {
            let Some(innovation) = pick(&innovations, at) else { continue };
            let Some(own) = rows.get(at).copied() else { break };
            let s = (pick(&own, at) + variance).max(S::lit(1e-9));
            let inverse = S::one() / s;
            factors.nis += innovation * innovation * inverse;
            let most = gate * s.sqrt();
            if outlier == Outlier::LeftOut && innovation.abs() > most {
                continue;
            }
            let taken = innovation.limit_abs(most) * inverse;
            place(&mut factors.inverse, at, inverse);
            place(&mut factors.taken, at, taken);
            let later = rows.iter_mut().zip(&mut innovations).zip(&mut factors.share).skip(at + 1);
            for ((row, innovation), shares) in later {
                let coupling = pick(row, at);
                let share = coupling * inverse;
                place(shares, at, share);
                for (entry, first) in row.iter_mut().zip(&own) {
                    *entry -= *first * share;
                }
                *innovation = innovation.map(|nu| nu - coupling * taken);
            }
        }
        factors
    }

    /// Takes the earlier rows from each column; gives the error.
    fn eliminate(&self, columns: &mut Columns<S, M>) -> Blocks<S> {
        let mut error = [V3::zeros(); BLOCKS];
        for (sum, columns) in error.iter_mut().zip(columns) {
            for at in 0..M {
                let first = pick(columns, at);
                *sum += first * pick(&self.taken, at);
                for (column, shares) in columns.iter_mut().zip(&self.share).skip(at + 1) {
                    *column -= first * pick(shares, at);
                }
            }
        }
        error
    }
}

/// An entry of a list, by a loop over its length.
#[inline(always)]
fn pick<T: Copy + Default>(list: &[T], at: usize) -> T {
    list.get(at).copied().unwrap_or_default()
}

#[inline(always)]
fn place<T>(list: &mut [T], at: usize, value: T) {
    if let Some(entry) = list.get_mut(at) {
        *entry = value;
    }
}
