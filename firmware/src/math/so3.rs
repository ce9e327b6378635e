//! Rotations: exponential, orthonormalisation, quaternion.

use crate::frames::{M3, V3};
use crate::scalar::Scalar;

/// Scalar product.
#[inline]
pub fn dot<S: Scalar>(a: &V3<S>, b: &V3<S>) -> S {
    a.x * b.x + a.y * b.y + a.z * b.z
}

/// Vector product.
#[inline]
pub fn cross<S: Scalar>(a: &V3<S>, b: &V3<S>) -> V3<S> {
    V3::new(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
}

/// Euclidean length. In fixed point the largest component is taken out first, so that the squares
/// neither saturate nor vanish.
#[inline]
pub fn norm<S: Scalar>(v: &V3<S>) -> S {
    if S::IS_FLOATING {
        return dot(v, v).sqrt();
    }
    let largest = v.x.abs().max(v.y.abs()).max(v.z.abs());
    if largest <= S::zero() {
        return S::zero();
    }
    let (x, y, z) = (v.x / largest, v.y / largest, v.z / largest);
    largest * (x * x + y * y + z * z).sqrt()
}

/// Scaled so that its length is at most `bound`.
#[inline]
pub fn limit_norm<S: Scalar>(v: V3<S>, bound: S) -> V3<S> {
    let length = norm(&v);
    if length > bound { v * (bound / length) } else { v }
}

/// Unit vector and length; `None` where the length does not exceed `floor`.
#[inline]
pub fn direction<S: Scalar>(v: &V3<S>, floor: S) -> Option<(V3<S>, S)> {
    let length = norm(v);
    (length > floor).then(|| (v / length, length))
}

/// `v` without its part along the unit vector `u`.
#[inline]
pub fn reject<S: Scalar>(v: &V3<S>, u: &V3<S>) -> V3<S> {
    v - u * dot(u, v)
}

/// `Rᵀ v`, without forming the transpose.
#[inline]
pub fn transpose_mul<S: Scalar>(r: &M3<S>, v: &V3<S>) -> V3<S> {
    V3::new(
        r.m11 * v.x + r.m21 * v.y + r.m31 * v.z,
        r.m12 * v.x + r.m22 * v.y + r.m32 * v.z,
        r.m13 * v.x + r.m23 * v.y + r.m33 * v.z,
    )
}

/// Column `x` (nose) of a rotation.
#[inline]
pub fn col_x<S: Scalar>(r: &M3<S>) -> V3<S> {
    V3::new(r.m11, r.m21, r.m31)
}
/// Column `y` (right) of a rotation.
#[inline]
pub fn col_y<S: Scalar>(r: &M3<S>) -> V3<S> {
    V3::new(r.m12, r.m22, r.m32)
}
/// Column `z` (down) of a rotation.
#[inline]
pub fn col_z<S: Scalar>(r: &M3<S>) -> V3<S> {
    V3::new(r.m13, r.m23, r.m33)
}
/// Row `z` of a rotation: the world's down axis in its own.
#[inline]
pub fn row_z<S: Scalar>(r: &M3<S>) -> V3<S> {
    V3::new(r.m31, r.m32, r.m33)
}
fn from_columns<S: Scalar>(x: &V3<S>, y: &V3<S>, z: &V3<S>) -> M3<S> {
    M3::new(x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z)
}

/// Rotation about the unit `axis` by the angle of the given sine and cosine.
#[must_use]
pub fn axis_angle<S: Scalar>(axis: &V3<S>, sin: S, cos: S) -> M3<S> {
    let k = S::one() - cos;
    let (x, y, z) = (axis.x, axis.y, axis.z);
    M3::new(
        cos + k * x * x,
        k * x * y - sin * z,
        k * x * z + sin * y,
        k * x * y + sin * z,
        cos + k * y * y,
        k * y * z - sin * x,
        k * x * z - sin * y,
        k * y * z + sin * x,
        cos + k * z * z,
    )
}

/// `exp([v]×)`, v in rad (Rodrigues; first order below 1e-6 rad).
#[must_use]
pub fn exp<S: Scalar>(v: &V3<S>) -> M3<S> {
    match direction(v, S::lit(1e-6)) {
        Some((axis, angle)) => {
            let (sin, cos) = angle.sin_cos();
            axis_angle(&axis, sin, cos)
        }
        None => M3::new(S::one(), -v.z, v.y, v.z, S::one(), -v.x, -v.y, v.x, S::one()),
    }
}

/// Rotation vector, rad, at most pi long: the inverse of [`exp`].
#[must_use]
pub fn log<S: Scalar>(r: &M3<S>) -> V3<S> {
    let [w, x, y, z] = quaternion(r);
    let v = V3::new(x, y, z);
    let sin = norm(&v);
    // To first order below 1e-6 rad.
    let scale = if sin > S::lit(1e-6) { S::lit(2.0) * sin.atan2(w) / sin } else { S::lit(2.0) };
    v * scale
}

/// `[v]×`: the matrix of the vector product with `v` on the left.
#[must_use]
pub fn skew<S: Scalar>(v: &V3<S>) -> M3<S> {
    let o = S::zero();
    M3::new(o, -v.z, v.y, v.z, o, -v.x, -v.y, v.x, o)
}

/// Nearest-enough rotation: Gram–Schmidt on columns 0 and 1, column 2 their cross product
/// (`fullstate` section 1). `None` if the columns are degenerate or not finite.
#[must_use]
pub fn orthonormal<S: Scalar>(r: &M3<S>) -> Option<M3<S>> {
    let (x, _) = direction(&col_x(r), S::lit(0.1))?;
    let (y, _) = direction(&reject(&col_y(r), &x), S::lit(0.1))?;
    let z = cross(&x, &y);
    (x.x.is_finite() && y.x.is_finite() && z.x.is_finite()).then(|| from_columns(&x, &y, &z))
}

/// Unit quaternion `[w, x, y, z]` of a rotation, w >= 0 (largest-element form).
#[must_use]
pub fn quaternion<S: Scalar>(r: &M3<S>) -> [S; 4] {
    let (one, half) = (S::one(), S::lit(0.5));
    let quarter = |p: S| {
        let root = (one + p).max(S::lit(1e-6)).sqrt();
        (half * root, half / root)
    };
    let trace = r.m11 + r.m22 + r.m33;
    let (w, x, y, z) = if trace >= r.m11 && trace >= r.m22 && trace >= r.m33 {
        let (q, k) = quarter(trace);
        (q, (r.m32 - r.m23) * k, (r.m13 - r.m31) * k, (r.m21 - r.m12) * k)
    } else if r.m11 >= r.m22 && r.m11 >= r.m33 {
        let (q, k) = quarter(r.m11 - r.m22 - r.m33);
        ((r.m32 - r.m23) * k, q, (r.m12 + r.m21) * k, (r.m13 + r.m31) * k)
    } else if r.m22 >= r.m33 {
        let (q, k) = quarter(r.m22 - r.m11 - r.m33);
        ((r.m13 - r.m31) * k, (r.m12 + r.m21) * k, q, (r.m23 + r.m32) * k)
    } else {
        let (q, k) = quarter(r.m33 - r.m11 - r.m22);
        ((r.m21 - r.m12) * k, (r.m13 + r.m31) * k, (r.m23 + r.m32) * k, q)
    };
    if w < S::zero() { [-w, -x, -y, -z] } else { [w, x, y, z] }
}
