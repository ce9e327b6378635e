//! What does the core compute with on a part that has no FPU?
//!
//! [`Q16`]: 16 integer and 16 fraction bits, saturating everywhere, division by zero defined.
//! Plain `fixed` operators wrap in release builds, and a wrapped attitude is a crash.
//! Range ±32768, resolution 1.5e-5. Trigonometry is CORDIC, good to about 3e-5.

use crate::scalar::Scalar;
use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Rem, Sub, SubAssign};
use num_traits::{One, Zero};

/// Saturating Q16.16.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Q16(i32);

const ONE: i64 = 1 << 16;
/// Fraction bits inside CORDIC.
const CORDIC_BITS: u32 = 30;
/// atan(2^-i) in units of 2^-30 rad.
const ATAN: [i64; 20] = [
    843_314_857,
    497_837_829,
    263_043_837,
    133_525_159,
    67_021_687,
    33_543_516,
    16_775_851,
    8_388_437,
    4_194_283,
    2_097_149,
    1_048_576,
    524_288,
    262_144,
    131_072,
    65_536,
    32_768,
    16_384,
    8_192,
    4_096,
    2_048,
];
/// Product of cos(atan(2^-i)), 2^-30.
const CORDIC_GAIN: i64 = 652_032_874;
const PI_30: i64 = 3_373_259_426;

impl Q16 {
    /// Largest value, just under 32768.
    pub const MAX: Self = Self(i32::MAX);
    /// Smallest value, -32768.
    pub const MIN: Self = Self(i32::MIN);

    /// From the raw count of 2^-16.
    #[must_use]
    pub const fn from_bits(bits: i32) -> Self {
        Self(bits)
    }
    /// The raw count of 2^-16.
    #[must_use]
    pub const fn to_bits(self) -> i32 {
        self.0
    }
    /// Whether this value sits on a bound: the sign that something saturated.
    #[must_use]
    pub const fn is_saturated(self) -> bool {
        self.0 == i32::MAX || self.0 == i32::MIN
    }
    fn narrow(wide: i64) -> Self {
        Self(wide.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32)
    }
}

impl Add for Q16 {
    type Output = Self;
    #[inline]
    fn add(self, o: Self) -> Self {
        Self(self.0.saturating_add(o.0))
    }
}
impl Sub for Q16 {
    type Output = Self;
    #[inline]
    fn sub(self, o: Self) -> Self {
        Self(self.0.saturating_sub(o.0))
    }
}
impl Mul for Q16 {
    type Output = Self;
    #[inline]
    fn mul(self, o: Self) -> Self {
        Self::narrow((i64::from(self.0) * i64::from(o.0) + (ONE >> 1)) >> 16)
    }
}
impl Div for Q16 {
    type Output = Self;
    /// `0/0` is 0; any other division by zero saturates with the sign of the numerator.
    #[inline]
    fn div(self, o: Self) -> Self {
        match (i64::from(self.0) << 16).checked_div(i64::from(o.0)) {
            Some(quotient) => Self::narrow(quotient),
            None if self.0 == 0 => Self(0),
            None if self.0 > 0 => Self::MAX,
            None => Self::MIN,
        }
    }
}
impl Rem for Q16 {
    type Output = Self;
    /// Zero where the divisor is zero.
    fn rem(self, o: Self) -> Self {
        Self(self.0.checked_rem(o.0).unwrap_or(0))
    }
}
impl Neg for Q16 {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self(self.0.saturating_neg())
    }
}
impl AddAssign for Q16 {
    #[inline]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}
impl SubAssign for Q16 {
    #[inline]
    fn sub_assign(&mut self, o: Self) {
        *self = *self - o;
    }
}
impl MulAssign for Q16 {
    #[inline]
    fn mul_assign(&mut self, o: Self) {
        *self = *self * o;
    }
}
impl DivAssign for Q16 {
    #[inline]
    fn div_assign(&mut self, o: Self) {
        *self = *self / o;
    }
}
impl Zero for Q16 {
    fn zero() -> Self {
        Self(0)
    }
    fn is_zero(&self) -> bool {
        self.0 == 0
    }
}
impl One for Q16 {
    fn one() -> Self {
        Self(ONE as i32)
    }
}

/// Integer square root, exact floor.
fn isqrt(n: u64) -> u64 {
    let mut root = 0_u64;
    let mut rest = n;
    let mut bit = 1_u64 << 62;
    while bit > n {
        bit >>= 2;
    }
    while bit != 0 {
        if rest >= root + bit {
            rest -= root + bit;
            root = (root >> 1) + bit;
        } else {
            root >>= 1;
        }
        bit >>= 2;
    }
    root
}

impl Scalar for Q16 {
    const IS_FLOATING: bool = false;

    #[inline(always)]
    fn lit(x: f64) -> Self {
        // A float-to-int cast saturates and sends NaN to zero.
        Self((x * 65_536.0 + if x < 0.0 { -0.5 } else { 0.5 }) as i32)
    }
    fn from_f32(x: f32) -> Self {
        Self::lit(f64::from(x))
    }
    fn to_f32(self) -> f32 {
        (f64::from(self.0) / 65_536.0) as f32
    }
    fn sqrt(self) -> Self {
        if self.0 <= 0 {
            return Self(0);
        }
        Self(isqrt((self.0 as u64) << 16) as i32)
    }
    fn sin_cos(self) -> (Self, Self) {
        let mut z = (i64::from(self.0) << (CORDIC_BITS - 16)) % (2 * PI_30);
        if z > PI_30 {
            z -= 2 * PI_30;
        } else if z < -PI_30 {
            z += 2 * PI_30;
        }
        // CORDIC converges within about 99 degrees: fold the left half plane over.
        let flip = if z > PI_30 / 2 {
            z -= PI_30;
            true
        } else if z < -PI_30 / 2 {
            z += PI_30;
            true
        } else {
            false
        };
        let (mut x, mut y) = (CORDIC_GAIN, 0_i64);
        for (i, step) in ATAN.iter().enumerate() {
            let (dx, dy) = (y >> i, x >> i);
            if z >= 0 {
                x -= dx;
                y += dy;
                z -= step;
            } else {
                x += dx;
                y -= dy;
                z += step;
            }
        }
        let round = |v: i64| Self::narrow((v + (1 << 13)) >> (CORDIC_BITS - 16));
        if flip { (round(-y), round(-x)) } else { (round(y), round(x)) }
    }
    fn atan2(self, x: Self) -> Self {
        if self.0 == 0 && x.0 == 0 {
            return Self(0);
        }
        let (mut cx, mut cy) = (i64::from(x.0) << 16, i64::from(self.0) << 16);
        let mut z = 0_i64;
        if cx < 0 {
            z = if cy >= 0 { PI_30 } else { -PI_30 };
            cx = -cx;
            cy = -cy;
        }
        for (i, step) in ATAN.iter().enumerate() {
            let (dx, dy) = (cy >> i, cx >> i);
            if cy > 0 {
                cx += dx;
                cy -= dy;
                z += step;
            } else {
                cx -= dx;
                cy += dy;
                z -= step;
            }
        }
        Self::narrow((z + (1 << 13)) >> (CORDIC_BITS - 16))
    }
    fn is_finite(self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arithmetic_saturates_instead_of_wrapping() {
        assert_eq!(Q16::MAX + Q16::one(), Q16::MAX);
        assert_eq!(Q16::MIN - Q16::one(), Q16::MIN);
        assert_eq!(Q16::lit(300.0) * Q16::lit(300.0), Q16::MAX);
        assert_eq!(-Q16::MIN, Q16::MAX);
        assert_eq!(Q16::one() / Q16::zero(), Q16::MAX);
        assert_eq!(-Q16::one() / Q16::zero(), Q16::MIN);
        assert_eq!(Q16::zero() / Q16::zero(), Q16::zero());
        assert_eq!(Q16::lit(f64::NAN), Q16::zero());
        assert_eq!(Q16::lit(1e9), Q16::MAX);
    }

    #[test]
    fn roots_and_angles_agree_with_f64() {
        for i in -4000..4000 {
            let a = f64::from(i) * 0.0031;
            let (s, c) = Q16::lit(a).sin_cos();
            assert!((f64::from(s.to_f32()) - a.sin()).abs() < 4e-5, "sin {a}");
            assert!((f64::from(c.to_f32()) - a.cos()).abs() < 4e-5, "cos {a}");
            let r = Q16::lit(a.abs()).sqrt().to_f32();
            assert!((f64::from(r) - a.abs().sqrt()).abs() < 3e-3, "sqrt {a}");
            for x in [-7.5, -0.3, 0.4, 9.0] {
                let t = Q16::lit(a).atan2(Q16::lit(x)).to_f32();
                let want = f64::from(Q16::lit(a).to_f32()).atan2(x);
                assert!((f64::from(t) - want).abs() < 4e-5, "atan2 {a} {x}: {t} {want}");
            }
        }
    }
}
