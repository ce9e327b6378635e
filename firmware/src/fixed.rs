//! What does the core compute with on a part that has no FPU?
//!
//! [`Q16`]: 16 integer and 16 fraction bits, saturating everywhere, division by zero defined.
//! Plain `fixed` operators wrap in release builds, and a wrapped attitude is a crash.
//! Range ±32768, resolution 1.5e-5. Sine and cosine are polynomials, the arc tangent CORDIC, good to about 3e-5.
//! Everything is done in products of 32 by 32 bits and divisions of 32, which a Cortex-M3 has.

use crate::scalar::Scalar;
use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Rem, Sub, SubAssign};
use num_traits::{One, Zero};

/// Saturating Q16.16.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Q16(i32);

const ONE: i64 = 1 << 16;
/// Fraction bits inside the trigonometry.
const INNER_BITS: u32 = 30;
/// atan(2^-i) in units of 2^-29 rad.
const ATAN: [i32; 20] = [
    421_657_428,
    248_918_915,
    131_521_918,
    66_762_579,
    33_510_843,
    16_771_758,
    8_387_925,
    4_194_219,
    2_097_141,
    1_048_575,
    524_288,
    262_144,
    131_072,
    65_536,
    32_768,
    16_384,
    8_192,
    4_096,
    2_048,
    1_024,
];
/// π in units of 2^-29, and π/2 in units of 2^-30.
const PI_29: i32 = 1_686_629_713;
const QUARTER_30: i64 = 1_686_629_713;
/// 2/π in units of 2^-32.
const PER_QUARTER_32: i64 = 2_734_261_102;
/// Of sine and cosine on [-π/4, π/4], by powers of the angle's square, 2^-30.
const SIN: [i32; 3] = [-178_956_850, 8_946_588, -209_544];
const COS: [i32; 3] = [44_739_176, -1_491_140, 26_235];

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
}

/// Counts what saturates, where the feature asks for it.
#[inline(always)]
fn count(saturates: bool) {
    #[cfg(feature = "count-saturation")]
    if saturates {
        saturation::COUNT.fetch_add(1, core::sync::atomic::Ordering::Relaxed);
    }
    #[cfg(not(feature = "count-saturation"))]
    let _ = saturates;
}

/// How often has an operation saturated? Zero in a flight proves the scaling. For the simulator and for debugging.
#[cfg(feature = "count-saturation")]
pub mod saturation {
    use core::sync::atomic::{AtomicU32, Ordering};

    pub(super) static COUNT: AtomicU32 = AtomicU32::new(0);

    /// Operations of all threads since the start.
    #[must_use]
    pub fn count() -> u32 {
        COUNT.load(Ordering::Relaxed)
    }
}

impl Add for Q16 {
    type Output = Self;
    #[inline]
    fn add(self, o: Self) -> Self {
        count(self.0.checked_add(o.0).is_none());
        Self(self.0.saturating_add(o.0))
    }
}
impl Sub for Q16 {
    type Output = Self;
    #[inline]
    fn sub(self, o: Self) -> Self {
        count(self.0.checked_sub(o.0).is_none());
        Self(self.0.saturating_sub(o.0))
    }
}
impl Mul for Q16 {
    type Output = Self;
    #[inline]
    fn mul(self, o: Self) -> Self {
        let wide = i64::from(self.0) * i64::from(o.0) + (ONE >> 1);
        // It fits when the upper word holds nothing but sign from its sixteenth bit on.
        let upper = (wide >> 32) as i32;
        if upper.wrapping_add(0x8000) as u32 <= 0xFFFF {
            Self((wide >> 16) as i32)
        } else {
            count(true);
            if upper < 0 { Self::MIN } else { Self::MAX }
        }
    }
}
impl Div for Q16 {
    type Output = Self;
    /// `0/0` is 0; any other division by zero saturates with the sign of the numerator.
    #[inline]
    fn div(self, o: Self) -> Self {
        let (n, d) = (self.0.unsigned_abs(), o.0.unsigned_abs());
        let is_negative = (self.0 < 0) != (o.0 < 0);
        let bound = if is_negative { Self::MIN } else { Self::MAX };
        let Some(whole) = n.checked_div(d) else {
            count(n != 0);
            return if n == 0 {
                Self(0)
            } else if self.0 < 0 {
                Self::MIN
            } else {
                Self::MAX
            };
        };
        if whole > 0x7FFF {
            count(true);
            return bound;
        }
        let size = (whole << 16) | fraction(n - whole * d, d);
        Self(if is_negative { (size as i32).wrapping_neg() } else { size as i32 })
    }
}

/// `(rest << 16) / d` for `rest < d`, by divisions of 32 bits.
#[inline]
fn fraction(rest: u32, d: u32) -> u32 {
    let divide = |n: u32| n.checked_div(d).unwrap_or(0);
    if d <= 0xFFFF {
        return divide(rest << 16);
    }
    if d <= 0x00FF_FFFF {
        let high = divide(rest << 8);
        return (high << 8) | divide(((rest << 8) - high * d) << 8);
    }
    let (mut rest, mut quotient) = (rest, 0);
    for _ in 0..16 {
        rest <<= 1;
        quotient <<= 1;
        if rest >= d {
            rest -= d;
            quotient |= 1;
        }
    }
    quotient
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
impl From<Q16> for f64 {
    fn from(x: Q16) -> Self {
        f64::from(x.0) / 65_536.0
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

/// Root of `raw << 16`, exact floor: two bits of it after another, all in 32 bits.
fn root(raw: u32) -> u32 {
    // Pairs of leading zeros bring nothing.
    let skipped = raw.leading_zeros() / 2;
    let mut bits = raw << (2 * skipped);
    let (mut rest, mut root) = (0_u32, 0_u32);
    for _ in skipped..24 {
        rest = (rest << 2) | (bits >> 30);
        bits <<= 2;
        root <<= 1;
        if rest > 2 * root {
            rest -= 2 * root + 1;
            root += 1;
        }
    }
    root
}

#[inline]
fn mul_30(a: i32, b: i32) -> i32 {
    ((i64::from(a) * i64::from(b)) >> INNER_BITS) as i32
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
        f64::from(self) as f32
    }
    fn sqrt(self) -> Self {
        if self.0 <= 0 { Self(0) } else { Self(root(self.0 as u32) as i32) }
    }
    fn sin_cos(self) -> (Self, Self) {
        let half = 1_i64 << 47;
        let quarter = (i64::from(self.0) * PER_QUARTER_32 + half) >> 48;
        let r = ((i64::from(self.0) << 14) - quarter * QUARTER_30) as i32;
        let z = mul_30(r, r);
        let [a, b, c] = SIN;
        let sin = r + mul_30(mul_30(r, z), a + mul_30(z, b + mul_30(z, c)));
        let [a, b, c] = COS;
        let cos = (1 << 30) - (z >> 1) + mul_30(mul_30(z, z), a + mul_30(z, b + mul_30(z, c)));
        let round = |x: i32| Self((x + (1 << 13)) >> 14);
        let (sin, cos) = (round(sin), round(cos));
        match quarter & 3 {
            0 => (sin, cos),
            1 => (cos, -sin),
            2 => (-sin, -cos),
            _ => (-cos, sin),
        }
    }
    fn atan2(self, x: Self) -> Self {
        let largest = self.0.unsigned_abs() | x.0.unsigned_abs();
        if largest == 0 {
            return Self(0);
        }
        // As large as leaves room for CORDIC's growth of 1.65 and the diagonal.
        let room = largest.leading_zeros() as i32 - 3;
        let scale = |v: i32| if room >= 0 { v << room } else { v >> -room };
        let (mut cx, mut cy, mut z) = (scale(x.0), scale(self.0), 0_i32);
        if cx < 0 {
            z = if cy >= 0 { PI_29 } else { -PI_29 };
            (cx, cy) = (-cx, -cy);
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
        Self((z + (1 << 12)) >> 13)
    }
    fn tanh(self) -> Self {
        Self::from_f32(libm::tanhf(self.to_f32()))
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
    fn products_and_quotients_are_those_of_wide_integers() {
        let narrow = |wide: i64| wide.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32;
        let mut noise = 0x9E37_79B9_7F4A_7C15_u64;
        let mut next = |bits: u32| {
            noise ^= noise << 13;
            noise ^= noise >> 7;
            noise ^= noise << 17;
            (noise >> 32) as i32 >> bits
        };
        for i in 0..200_000_u32 {
            let (a, b) = (next(i % 31), next(i / 31 % 31));
            let product = narrow((i64::from(a) * i64::from(b) + (1 << 15)) >> 16);
            assert_eq!((Q16(a) * Q16(b)).0, product, "{a} * {b}");
            if b != 0 {
                // The magnitude's floor; a quotient of exactly -32768 saturates to the same.
                let quotient = narrow((i64::from(a) << 16) / i64::from(b));
                assert_eq!((Q16(a) / Q16(b)).0, quotient, "{a} / {b}");
            }
        }
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
