//! The 9×9 covariance of rod direction, rod rate and disturbance as six 3×3 blocks.
//!
//! The transition matrix has only identity, `-S(q) dt` and `S(q)² dt²/2` in it, so the prediction is nine
//! products with a skew matrix where a dense `Φ P Φᵀ` takes 1458 multiplications.

use crate::frames::{M3, V3};
use crate::math::so3;
use crate::scalar::Scalar;

/// Upper blocks; `rod`, `rate` and `disturbance` are symmetric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PendulumCovariance<S: Scalar> {
    /// Of the direction.
    pub rod: M3<S>,
    /// Direction with rate.
    pub rod_rate: M3<S>,
    /// Direction with disturbance.
    pub rod_disturbance: M3<S>,
    /// Of the rate, (rad/s)².
    pub rate: M3<S>,
    /// Rate with disturbance.
    pub rate_disturbance: M3<S>,
    /// Of the disturbance over vehicle mass times length, (rad/s²)².
    pub disturbance: M3<S>,
}

/// One column of the covariance, or its product with a row: parts of direction, rate, disturbance.
pub(super) type Column<S> = [V3<S>; 3];

/// `[n]× m`.
fn turn<S: Scalar>(n: &V3<S>, m: &M3<S>) -> M3<S> {
    M3::new(
        n.y * m.m31 - n.z * m.m21,
        n.y * m.m32 - n.z * m.m22,
        n.y * m.m33 - n.z * m.m23,
        n.z * m.m11 - n.x * m.m31,
        n.z * m.m12 - n.x * m.m32,
        n.z * m.m13 - n.x * m.m33,
        n.x * m.m21 - n.y * m.m11,
        n.x * m.m22 - n.y * m.m12,
        n.x * m.m23 - n.y * m.m13,
    )
}

/// `m [n]×`.
fn turned<S: Scalar>(m: &M3<S>, n: &V3<S>) -> M3<S> {
    M3::new(
        m.m12 * n.z - m.m13 * n.y,
        m.m13 * n.x - m.m11 * n.z,
        m.m11 * n.y - m.m12 * n.x,
        m.m22 * n.z - m.m23 * n.y,
        m.m23 * n.x - m.m21 * n.z,
        m.m21 * n.y - m.m22 * n.x,
        m.m32 * n.z - m.m33 * n.y,
        m.m33 * n.x - m.m31 * n.z,
        m.m31 * n.y - m.m32 * n.x,
    )
}

fn add_diagonal<S: Scalar>(m: &mut M3<S>, v: &V3<S>) {
    m.m11 += v.x;
    m.m22 += v.y;
    m.m33 += v.z;
}

fn symmetrise<S: Scalar>(m: &mut M3<S>) {
    let half = S::lit(0.5);
    let (a, b, c) = ((m.m12 + m.m21) * half, (m.m13 + m.m31) * half, (m.m23 + m.m32) * half);
    (m.m12, m.m21) = (a, a);
    (m.m13, m.m31) = (b, b);
    (m.m23, m.m32) = (c, c);
}

impl<S: Scalar> PendulumCovariance<S> {
    /// Nothing correlated; variances of direction, rate and disturbance.
    #[must_use]
    pub fn from_diagonal(rod: &V3<S>, rate: &V3<S>, disturbance: &V3<S>) -> Self {
        let o = M3::zeros();
        Self {
            rod: M3::from_diagonal(rod),
            rod_rate: o,
            rod_disturbance: o,
            rate: M3::from_diagonal(rate),
            rate_disturbance: o,
            disturbance: M3::from_diagonal(disturbance),
        }
    }

    /// `Φ P Φᵀ` with `n = q dt` in `Φ = [[1, -[n]×, [n]×²/2], [0, 1, -[n]×], [0, 0, 1]]`.
    #[must_use]
    pub(super) fn predicted(&self, n: &V3<S>) -> Self {
        let half = S::lit(0.5);
        // Rows: Y = Φ P; the upper blocks are all that is needed.
        let g = turn(n, &self.disturbance);
        let rate_disturbance = self.rate_disturbance - g;
        let rod_disturbance = self.rod_disturbance - turn(n, &(self.rate_disturbance - g * half));
        let h = turn(n, &self.rate_disturbance.transpose());
        let rate = self.rate - h;
        let rod_rate = self.rod_rate - turn(n, &(self.rate - h * half));
        let l = turn(n, &self.rod_disturbance.transpose());
        let rod = self.rod - turn(n, &(self.rod_rate.transpose() - l * half));
        // Columns: P' = Y Φᵀ.
        let j = turned(&rod_disturbance, n);
        Self {
            rod: rod + turned(&(rod_rate + j * half), n),
            rod_rate: rod_rate + j,
            rod_disturbance,
            rate: rate + turned(&rate_disturbance, n),
            rate_disturbance,
            disturbance: self.disturbance,
        }
    }

    /// Process noise: variances of direction, rate and disturbance.
    pub(super) fn grow(&mut self, rod: &V3<S>, rate: &V3<S>, disturbance: &V3<S>) {
        add_diagonal(&mut self.rod, rod);
        add_diagonal(&mut self.rate, rate);
        add_diagonal(&mut self.disturbance, disturbance);
    }

    /// `P h` for a row that reads the direction along the unit axis `axis`.
    pub(super) fn times_rod(&self, axis: &V3<S>) -> Column<S> {
        [
            self.rod * axis,
            so3::transpose_mul(&self.rod_rate, axis),
            so3::transpose_mul(&self.rod_disturbance, axis),
        ]
    }

    /// `P h` for a row that reads the rate along `axis`.
    pub(super) fn times_rate(&self, axis: &V3<S>) -> Column<S> {
        [self.rod_rate * axis, self.rate * axis, so3::transpose_mul(&self.rate_disturbance, axis)]
    }

    /// `P - c cᵀ w`.
    pub(super) fn shrink(&mut self, [rod, rate, disturbance]: &Column<S>, w: S) {
        let outer = |a: &V3<S>, b: &V3<S>| {
            M3::new(
                a.x * b.x,
                a.x * b.y,
                a.x * b.z,
                a.y * b.x,
                a.y * b.y,
                a.y * b.z,
                a.z * b.x,
                a.z * b.y,
                a.z * b.z,
            )
        };
        let (weighted_rod, weighted_rate) = (rod * w, rate * w);
        self.rod -= outer(&weighted_rod, rod);
        self.rod_rate -= outer(&weighted_rod, rate);
        self.rod_disturbance -= outer(&weighted_rod, disturbance);
        self.rate -= outer(&weighted_rate, rate);
        self.rate_disturbance -= outer(&weighted_rate, disturbance);
        self.disturbance -= outer(&(disturbance * w), disturbance);
    }

    /// Rounding leaves the halves of a symmetric block apart.
    pub(super) fn clean(&mut self) {
        symmetrise(&mut self.rod);
        symmetrise(&mut self.rate);
        symmetrise(&mut self.disturbance);
    }

    /// Variances at least `floor`, that of the vertical disturbance, which an upright rod does not show, at
    /// most `cap`.
    pub(super) fn bound(&mut self, floor: S, cap: S) {
        for block in [&mut self.rod, &mut self.rate, &mut self.disturbance] {
            block.m11 = block.m11.max(floor);
            block.m22 = block.m22.max(floor);
            block.m33 = block.m33.max(floor);
        }
        self.disturbance.m33 = self.disturbance.m33.min(cap);
    }

    /// Variances of direction, rate and disturbance.
    #[must_use]
    pub fn diagonal(&self) -> [V3<S>; 3] {
        [&self.rod, &self.rate, &self.disturbance].map(|m| V3::new(m.m11, m.m22, m.m33))
    }

    /// Dense, row by row: direction, rate, disturbance.
    #[must_use]
    pub fn dense(&self) -> nalgebra::SMatrix<S, 9, 9> {
        let mut p = nalgebra::SMatrix::<S, 9, 9>::zeros();
        let lower =
            [&self.rod_rate, &self.rod_disturbance, &self.rate_disturbance].map(M3::transpose);
        let [rate_rod, disturbance_rod, disturbance_rate] = &lower;
        let rows = [
            [&self.rod, &self.rod_rate, &self.rod_disturbance],
            [rate_rod, &self.rate, &self.rate_disturbance],
            [disturbance_rod, disturbance_rate, &self.disturbance],
        ];
        for (row, blocks) in (0..).step_by(3).zip(rows) {
            for (column, block) in (0..).step_by(3).zip(blocks) {
                p.fixed_view_mut::<3, 3>(row, column).copy_from(block);
            }
        }
        p
    }

    /// From a dense symmetric matrix in the same order.
    #[must_use]
    pub fn from_dense(p: &nalgebra::SMatrix<S, 9, 9>) -> Self {
        let block = |row, column| p.fixed_view::<3, 3>(row, column).into_owned();
        Self {
            rod: block(0, 0),
            rod_rate: block(0, 3),
            rod_disturbance: block(0, 6),
            rate: block(3, 3),
            rate_disturbance: block(3, 6),
            disturbance: block(6, 6),
        }
    }

    pub(super) fn is_finite(&self) -> bool {
        self.diagonal().iter().flatten().all(|x| x.is_finite())
    }
}
