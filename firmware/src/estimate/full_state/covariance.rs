//! A symmetric covariance in blocks of three, upper triangle only.
//!
//! Nine vectors of three make the error state; a filter that goes without the last ones uses a prefix of the
//! storage, because the triangle is packed by columns.

use super::blocks::{add_outer, scale_columns, scale_rows};
use crate::frames::{M3, V3};
use crate::scalar::Scalar;

/// From the anchor, world axes, m.
pub const POSITION: usize = 0;
/// World axes, m/s.
pub const VELOCITY: usize = 1;
/// Of the attitude, body axes, rad: the true rotation is `R exp([θ]×)`.
pub const TILT: usize = 2;
/// Tension, N; thrust scale; altimeter bias, m.
pub const SCALARS: usize = 3;
/// Accelerometer bias, m/s².
pub const ACCEL_BIAS: usize = 4;
/// Gyro bias, rad/s.
pub const GYRO_BIAS: usize = 5;
/// Mean wind force over mass, world axes, m/s².
pub const WIND: usize = 6;
/// Gust force over mass, world axes, m/s².
pub const GUST: usize = 7;
/// A sensor's offset, two components; the third stays zero.
pub const OFFSET: usize = 8;
/// Vectors of three in the error state.
pub const BLOCKS: usize = 9;

const PACKED: usize = BLOCKS * (BLOCKS + 1) / 2;

/// One vector for each block: an error, a gain, a column.
pub type Blocks<S> = [V3<S>; BLOCKS];

/// Symmetric, `3 BLOCKS` square.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Covariance<S: Scalar> {
    upper: [M3<S>; PACKED],
}

const fn packed(row: usize, column: usize) -> usize {
    column * (column + 1) / 2 + row
}

impl<S: Scalar> Covariance<S> {
    /// From standard deviations.
    #[must_use]
    pub fn from_deviations(deviations: &Blocks<S>) -> Self {
        let mut all = Self { upper: [M3::zeros(); PACKED] };
        for (i, deviation) in deviations.iter().enumerate() {
            all.set(i, i, M3::from_diagonal(&deviation.map(|sd| sd * sd)));
        }
        all
    }

    /// The block of `row` and `column`, of either triangle.
    #[inline]
    #[must_use]
    pub fn block(&self, row: usize, column: usize) -> M3<S> {
        let (at, is_upper) =
            if row <= column { (packed(row, column), true) } else { (packed(column, row), false) };
        let block = self.upper.get(at).copied().unwrap_or_else(M3::zeros);
        if is_upper { block } else { block.transpose() }
    }

    /// The same where both are known as the code is written: which triangle costs nothing then.
    #[inline(always)]
    pub(super) fn at<const ROW: usize, const COLUMN: usize>(&self) -> M3<S> {
        if ROW <= COLUMN {
            self.upper[const { packed(ROW, COLUMN) }]
        } else {
            self.upper[const { packed(COLUMN, ROW) }].transpose()
        }
    }

    #[inline(always)]
    pub(super) fn at_mut<const ROW: usize, const COLUMN: usize>(&mut self) -> &mut M3<S> {
        &mut self.upper[const { packed(ROW, COLUMN) }]
    }

    /// Sets the block of `row` and `column`, `row <= column`; on the diagonal, a symmetric one.
    #[inline(always)]
    pub fn set(&mut self, row: usize, column: usize, value: M3<S>) {
        if let Some(block) = self.upper.get_mut(packed(row, column)) {
            *block = value;
        }
    }

    /// Multiplies a block's row and column by a factor for each component.
    pub(super) fn scale(&mut self, block: usize, used: usize, factor: &V3<S>) {
        let [factor] = &factor.data.0;
        let column = packed(0, block)..packed(block, block) + 1;
        for own in self.upper.get_mut(column).into_iter().flatten() {
            scale_columns(own, *factor);
        }
        for later in block..used {
            if let Some(own) = self.upper.get_mut(packed(block, later)) {
                scale_rows(own, *factor);
            }
        }
    }

    /// Turns the axes of some blocks.
    pub(super) fn turn(&mut self, blocks: [usize; 4], turn: &M3<S>) {
        for column in 0..BLOCKS {
            for row in 0..=column {
                let mut block = self.block(row, column);
                if blocks.contains(&row) {
                    block = turn * block;
                }
                if blocks.contains(&column) {
                    block *= turn.transpose();
                }
                self.set(row, column, block);
            }
        }
    }

    /// Adds independent noise to a block's components.
    #[inline]
    pub fn inflate(&mut self, block: usize, variance: &V3<S>) {
        if let Some(own) = self.upper.get_mut(packed(block, block)) {
            own.m11 += variance.x;
            own.m22 += variance.y;
            own.m33 += variance.z;
        }
    }

    /// Variances of a block's components.
    #[must_use]
    pub fn variances(&self, block: usize) -> V3<S> {
        self.block(block, block).diagonal()
    }

    /// Takes `Σ inverse column columnᵀ` from the first `used` blocks: one pass for all rows of a measurement.
    #[inline]
    pub(super) fn reduce<const M: usize>(
        &mut self,
        used: usize,
        columns: &[[V3<S>; M]; BLOCKS],
        inverses: &[S; M],
    ) {
        let mut upper = self.upper.iter_mut();
        for (j, own) in columns.iter().take(used).enumerate() {
            let mut scaled = *own;
            for (column, inverse) in scaled.iter_mut().zip(inverses) {
                *column *= -*inverse;
            }
            for (columns, block) in columns.iter().take(j + 1).zip(&mut upper) {
                let mut reduced = *block;
                // Written out: a loop would fetch and store the block for each row.
                if let ([a, ..], [x, ..]) = (&columns[..], &scaled[..]) {
                    add_outer(&mut reduced, a, x);
                }
                if let ([_, b, ..], [_, y, ..]) = (&columns[..], &scaled[..]) {
                    add_outer(&mut reduced, b, y);
                }
                if let ([_, _, c], [_, _, z]) = (&columns[..], &scaled[..]) {
                    add_outer(&mut reduced, c, z);
                }
                *block = reduced;
            }
        }
    }

    /// Whether every variance is a number and none is negative.
    #[must_use]
    pub fn is_sound(&self, used: usize) -> bool {
        (0..used).all(|i| self.variances(i).iter().all(|&v| v.is_finite() && v >= S::zero()))
    }
}
