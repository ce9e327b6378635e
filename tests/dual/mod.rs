//! Numbers that carry one derivative: the core's generic code differentiates itself.

use num_traits::{One, Zero};
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Rem, Sub, SubAssign};
use tautline_firmware::frames::V3;
use tautline_firmware::scalar::Scalar;

/// A value and its derivative along the chosen direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Dual {
    pub value: f64,
    pub slope: f64,
}

pub fn dual(value: f64, slope: f64) -> Dual {
    Dual { value, slope }
}

/// A vector and its derivative.
pub fn along(value: &V3<f64>, slope: &V3<f64>) -> V3<Dual> {
    value.zip_map(slope, dual)
}

pub fn slope(v: &V3<Dual>) -> V3<f64> {
    v.map(|x| x.slope)
}

impl Add for Dual {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        dual(self.value + o.value, self.slope + o.slope)
    }
}
impl Sub for Dual {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        dual(self.value - o.value, self.slope - o.slope)
    }
}
impl Mul for Dual {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        dual(self.value * o.value, self.slope * o.value + self.value * o.slope)
    }
}
impl Div for Dual {
    type Output = Self;
    fn div(self, o: Self) -> Self {
        let quotient = self.value / o.value;
        dual(quotient, (self.slope - quotient * o.slope) / o.value)
    }
}
impl Rem for Dual {
    type Output = Self;
    fn rem(self, o: Self) -> Self {
        dual(self.value % o.value, self.slope)
    }
}
impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        dual(-self.value, -self.slope)
    }
}

macro_rules! assign {
    ($($trait:ident $method:ident $op:tt;)+) => {$(
        impl $trait for Dual {
            fn $method(&mut self, o: Self) {
                *self = *self $op o;
            }
        }
    )+};
}

assign! {
    AddAssign add_assign +;
    SubAssign sub_assign -;
    MulAssign mul_assign *;
    DivAssign div_assign /;
}

impl PartialOrd for Dual {
    fn partial_cmp(&self, o: &Self) -> Option<std::cmp::Ordering> {
        self.value.partial_cmp(&o.value)
    }
}
impl Zero for Dual {
    fn zero() -> Self {
        dual(0.0, 0.0)
    }
    fn is_zero(&self) -> bool {
        self.value == 0.0
    }
}
impl One for Dual {
    fn one() -> Self {
        dual(1.0, 0.0)
    }
}

impl Scalar for Dual {
    const IS_FLOATING: bool = true;

    fn lit(x: f64) -> Self {
        dual(x, 0.0)
    }
    fn from_f32(x: f32) -> Self {
        dual(x.into(), 0.0)
    }
    fn to_f32(self) -> f32 {
        self.value as f32
    }
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        dual(root, self.slope / (2.0 * root))
    }
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (dual(sin, cos * self.slope), dual(cos, -sin * self.slope))
    }
    fn tanh(self) -> Self {
        let tanh = self.value.tanh();
        dual(tanh, (1.0 - tanh * tanh) * self.slope)
    }
    fn atan2(self, x: Self) -> Self {
        let square = self.value * self.value + x.value * x.value;
        dual(self.value.atan2(x.value), (self.slope * x.value - self.value * x.slope) / square)
    }
    fn is_finite(self) -> bool {
        self.value.is_finite() && self.slope.is_finite()
    }
}
