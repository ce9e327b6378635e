//! What arithmetic does the core need, and who supplies it?
//!
//! One letter `S`, one bound. `f32` flies, `f64` checks the science, [`crate::fixed::Q16`] is for
//! parts without an FPU. nalgebra supplies storage and `+ - *`; roots and trigonometry come from
//! here, so that nothing asks for nalgebra's `RealField`.

use core::ops::Neg;
use nalgebra::{ClosedAddAssign, ClosedDivAssign, ClosedMulAssign, ClosedSubAssign};
use num_traits::{One, Zero};

/// Arithmetic of the core.
pub trait Scalar:
    nalgebra::Scalar
    + Copy
    + Default
    + PartialOrd
    + Zero
    + One
    + Neg<Output = Self>
    + ClosedAddAssign
    + ClosedSubAssign
    + ClosedMulAssign
    + ClosedDivAssign
{
    /// Squares and reciprocals of what the core computes with neither overflow nor vanish.
    const IS_FLOATING: bool;

    /// A literal. Folds to a constant after inlining; saturates where the type must.
    fn lit(x: f64) -> Self;
    /// A parameter or a converted reading.
    fn from_f32(x: f32) -> Self;
    /// For telemetry and the log.
    fn to_f32(self) -> f32;
    /// Square root; zero for a negative argument.
    fn sqrt(self) -> Self;
    /// Sine and cosine of an angle in radians.
    fn sin_cos(self) -> (Self, Self);
    /// Angle of the point `(x, self)`, in [-pi, pi]; zero at the origin.
    fn atan2(self, x: Self) -> Self;
    /// Hyperbolic tangent.
    fn tanh(self) -> Self;
    /// Neither infinite nor NaN. Always true in fixed point.
    fn is_finite(self) -> bool;

    /// Angle in [-pi/2, pi/2] whose sine this is; arguments beyond [-1, 1] count as its ends.
    #[inline]
    fn asin(self) -> Self {
        let x = self.limit_abs(Self::one());
        x.atan2(((Self::one() - x) * (Self::one() + x)).sqrt())
    }
    /// Angle in [0, pi] whose cosine this is; arguments beyond [-1, 1] count as its ends.
    #[inline]
    fn acos(self) -> Self {
        let x = self.limit_abs(Self::one());
        ((Self::one() - x) * (Self::one() + x)).sqrt().atan2(x)
    }
    /// Absolute value.
    #[inline]
    fn abs(self) -> Self {
        if self < Self::zero() { -self } else { self }
    }
    /// The smaller one.
    #[inline]
    fn min(self, other: Self) -> Self {
        if other < self { other } else { self }
    }
    /// The larger one.
    #[inline]
    fn max(self, other: Self) -> Self {
        if other > self { other } else { self }
    }
    /// Limits to `[lo, hi]`. Unlike `f32::clamp` it cannot panic: `lo` wins if the bounds cross.
    #[inline]
    fn limit(self, lo: Self, hi: Self) -> Self {
        self.min(hi).max(lo)
    }
    /// Limits to `[-bound, bound]`.
    #[inline]
    fn limit_abs(self, bound: Self) -> Self {
        self.limit(-bound, bound)
    }
}

macro_rules! float_scalar {
    ($t:ident, $sqrt:path, $sincos:path, $atan2:path, $tanh:path) => {
        impl Scalar for $t {
            const IS_FLOATING: bool = true;

            #[inline(always)]
            fn lit(x: f64) -> Self {
                x as $t
            }
            #[inline(always)]
            fn from_f32(x: f32) -> Self {
                x as $t
            }
            #[inline(always)]
            fn to_f32(self) -> f32 {
                self as f32
            }
            #[inline]
            fn sqrt(self) -> Self {
                if self > 0.0 { $sqrt(self) } else { 0.0 }
            }
            #[inline]
            fn sin_cos(self) -> (Self, Self) {
                $sincos(self)
            }
            #[inline]
            fn atan2(self, x: Self) -> Self {
                $atan2(self, x)
            }
            #[inline]
            fn tanh(self) -> Self {
                $tanh(self)
            }
            #[inline]
            fn is_finite(self) -> bool {
                $t::is_finite(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                $t::abs(self)
            }
        }
    };
}

float_scalar!(f32, crate::math::root::sqrt, crate::math::trig::sin_cos, libm::atan2f, libm::tanhf);
float_scalar!(f64, libm::sqrt, libm::sincos, libm::atan2, libm::tanh);
