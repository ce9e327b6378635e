//! The observer as the articles print it, in continuous time with a held measurement, by four
//! integrations. For comparison: [`super::Predictor`] flies.

use super::{Canonical, Drive};
use crate::math::wrap_pi;
use crate::scalar::Scalar;
use nalgebra::{Matrix4, Vector4};

/// How the held differential equation is integrated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NaiveStep {
    /// Forward Euler.
    Euler,
    /// Runge-Kutta of fourth order.
    Rk4,
    /// Matrix exponential of the linear part; the non-linear term held.
    Exact,
    /// Taylor series without any correction.
    Open,
}

/// Coordinates and the weights `α/ε, α/ε², α/ε³` of the innovation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Naive<S> {
    /// Coordinates.
    pub canonical: Canonical<S>,
    /// Weights.
    pub weights: [S; 3],
}

impl<S: Scalar> Naive<S> {
    /// From the polynomial's coefficients `α1 … α3` (highest power first) and ε.
    #[must_use]
    pub fn new(canonical: Canonical<S>, alpha: &[S; 3], epsilon: S) -> Self {
        let [a1, a2, a3] = *alpha;
        let by = S::one() / epsilon;
        Self { canonical, weights: [a1 * by, a2 * by * by, a3 * by * by * by] }
    }

    /// dz/dt for a measured φ+θ, rad.
    #[must_use]
    pub fn rate(&self, z: &[S; 3], angle: S, drive: &Drive<S>) -> [S; 3] {
        let [w1, w2, w3] = self.weights;
        let [z1, z2, z3] = *z;
        let c = &self.canonical;
        let innovation = wrap_pi(angle - z1);
        [
            z2.limit_abs(c.rate_max) + drive.pitch_rate + w1 * innovation,
            z3.limit_abs(c.accel_max) + w2 * innovation,
            c.jerk(z, drive) + w3 * innovation,
        ]
    }

    /// One step of `h` s with measurement and drive held. Neither wrapped nor bounded: the caller does.
    #[must_use]
    pub fn step(&self, z: &[S; 3], angle: S, drive: &Drive<S>, h: S, how: NaiveStep) -> [S; 3] {
        let add = |d: &[S; 3], h: S| {
            let ([z1, z2, z3], [d1, d2, d3]) = (*z, *d);
            [z1 + h * d1, z2 + h * d2, z3 + h * d3]
        };
        let half = h * S::lit(0.5);
        match how {
            NaiveStep::Euler => add(&self.rate(z, angle, drive), h),
            NaiveStep::Rk4 => {
                let k1 = self.rate(z, angle, drive);
                let k2 = self.rate(&add(&k1, half), angle, drive);
                let k3 = self.rate(&add(&k2, half), angle, drive);
                let k4 = self.rate(&add(&k3, h), angle, drive);
                let two = S::lit(2.0);
                let mean = |a: S, b: S, c: S, d: S| (a + two * (b + c) + d) * S::lit(1.0 / 6.0);
                let ([a1, a2, a3], [b1, b2, b3], [c1, c2, c3], [d1, d2, d3]) = (k1, k2, k3, k4);
                add(&[mean(a1, b1, c1, d1), mean(a2, b2, c2, d2), mean(a3, b3, c3, d3)], h)
            }
            NaiveStep::Exact => self.exact(z, angle, drive, h),
            NaiveStep::Open => {
                let jerk = self.canonical.jerk(z, drive);
                let [_, z2, z3] = *z;
                let third = S::lit(1.0 / 3.0);
                add(
                    &[
                        z2 + drive.pitch_rate + half * (z3 + h * third * jerk),
                        z3 + half * jerk,
                        jerk,
                    ],
                    h,
                )
            }
        }
    }

    /// The affine system as a linear one with a constant fourth coordinate.
    fn exact(&self, z: &[S; 3], angle: S, drive: &Drive<S>, h: S) -> [S; 3] {
        let ([z1, z2, z3], [w1, w2, w3]) = (*z, self.weights);
        let target = z1 + wrap_pi(angle - z1);
        let (o, one) = (S::zero(), S::one());
        let system = Matrix4::new(
            -w1,
            one,
            o,
            drive.pitch_rate + w1 * target,
            -w2,
            o,
            one,
            w2 * target,
            -w3,
            o,
            o,
            self.canonical.jerk(z, drive) + w3 * target,
            o,
            o,
            o,
            o,
        );
        let start = Vector4::new(z1, z2, z3, one);
        // The series applied to the vector, over sub-intervals short enough to converge quickly.
        let pieces = 8;
        let part = h / S::lit(f64::from(pieces));
        let mut x = start;
        for _ in 0..pieces {
            let mut term = x;
            for k in 1..=18_u8 {
                term = system * term * (part / S::lit(f64::from(k)));
                x += term;
            }
        }
        [x.x, x.y, x.z]
    }
}
