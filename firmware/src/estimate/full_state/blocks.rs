//! Products of blocks of three, written out: an iterator's end is tested at run time, and here every instruction counts.

use crate::frames::{M3, V3};
use crate::scalar::Scalar;

type Column<S> = [S; 3];

/// `a b`.
#[inline(always)]
#[must_use]
pub(super) fn mul<S: Scalar>(a: &M3<S>, b: &M3<S>) -> M3<S> {
    let [k, l, m] = &b.data.0;
    let mut product = M3::zeros();
    product.data.0 = [combination(a, k), combination(a, l), combination(a, m)];
    product
}

/// `sum + a b`.
#[inline(always)]
pub(super) fn add_mul<S: Scalar>(sum: &mut M3<S>, a: &M3<S>, b: &M3<S>) {
    let [k, l, m] = &b.data.0;
    let [x, y, z] = &mut sum.data.0;
    add_combination(x, a, k);
    add_combination(y, a, l);
    add_combination(z, a, m);
}

/// `sum + k a`.
#[inline(always)]
pub(super) fn add_scaled<S: Scalar>(sum: &mut M3<S>, k: S, a: &M3<S>) {
    let [p, q, r] = &a.data.0;
    let [x, y, z] = &mut sum.data.0;
    add(x, &scaled(p, k));
    add(y, &scaled(q, k));
    add(z, &scaled(r, k));
}

/// `sum + a bᵀ`.
#[inline(always)]
pub(super) fn add_outer<S: Scalar>(sum: &mut M3<S>, a: &V3<S>, b: &V3<S>) {
    let ([a], [[k, l, m]]) = (&a.data.0, b.data.0);
    let [x, y, z] = &mut sum.data.0;
    add(x, &scaled(a, k));
    add(y, &scaled(a, l));
    add(z, &scaled(a, m));
}

/// `a diag(k)`.
#[inline(always)]
pub(super) fn scale_columns<S: Scalar>(a: &mut M3<S>, [k, l, m]: Column<S>) {
    let [p, q, r] = a.data.0;
    a.data.0 = [scaled(&p, k), scaled(&q, l), scaled(&r, m)];
}

/// `diag(k) a`.
#[inline(always)]
pub(super) fn scale_rows<S: Scalar>(a: &mut M3<S>, [k, l, m]: Column<S>) {
    a.data.0 = a.data.0.map(|[x, y, z]| [x * k, y * l, z * m]);
}

#[inline(always)]
fn combination<S: Scalar>(a: &M3<S>, [k, l, m]: &Column<S>) -> Column<S> {
    let [[p, q, r], [s, t, u], [v, w, x]] = a.data.0;
    [p * *k + s * *l + v * *m, q * *k + t * *l + w * *m, r * *k + u * *l + x * *m]
}

/// One term after the other, as a multiply-accumulate wants them.
#[inline(always)]
fn add_combination<S: Scalar>([x, y, z]: &mut Column<S>, a: &M3<S>, [k, l, m]: &Column<S>) {
    let [[p, q, r], [s, t, u], [v, w, o]] = a.data.0;
    *x = *x + p * *k + s * *l + v * *m;
    *y = *y + q * *k + t * *l + w * *m;
    *z = *z + r * *k + u * *l + o * *m;
}

#[inline(always)]
fn scaled<S: Scalar>([x, y, z]: &Column<S>, k: S) -> Column<S> {
    [*x * k, *y * k, *z * k]
}

#[inline(always)]
fn add<S: Scalar>([x, y, z]: &mut Column<S>, [a, b, c]: &Column<S>) {
    *x += *a;
    *y += *b;
    *z += *c;
}
