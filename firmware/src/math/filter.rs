//! Low-pass and notch filters; configuration apart from state.

use crate::frames::V3;
use crate::math::trig::{sin_cos, tan};
use crate::scalar::Scalar;
use core::f32::consts::PI;

/// First-order low-pass coefficient `1 - exp(-dt/tau)`; 1 (no filtering) for `tau <= 0`.
#[must_use]
pub fn first_order<S: Scalar>(tau: f32, dt: f32) -> S {
    if tau > 0.0 { S::from_f32(1.0 - libm::expf(-dt / tau)) } else { S::one() }
}

/// `exp(-dt/tau)`: what is left of a first-order lag's error after `dt`; zero for `tau <= 0`.
#[must_use]
pub fn decay<S: Scalar>(tau: f64, dt: f64) -> S {
    if tau > 0.0 { S::lit(libm::exp(-dt / tau)) } else { S::zero() }
}

/// Second-order section, `a0 = 1`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Biquad<S> {
    b0: S,
    b1: S,
    b2: S,
    a1: S,
    a2: S,
    is_through: bool,
}

/// What moves in a [`Biquad`] (direct form II, transposed).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BiquadState<S> {
    s1: S,
    s2: S,
}

impl<S: Scalar> Biquad<S> {
    /// Passes everything.
    #[must_use]
    pub fn through() -> Self {
        let o = S::zero();
        Self { b0: S::one(), b1: o, b2: o, a1: o, a2: o, is_through: true }
    }

    fn from_f32(b: [f32; 3], a: [f32; 3]) -> Self {
        let ([b0, b1, b2], [a0, a1, a2]) = (b, a);
        let k = |x: f32| S::from_f32(x / a0);
        Self { b0: k(b0), b1: k(b1), b2: k(b2), a1: k(a1), a2: k(a2), is_through: false }
    }

    /// Butterworth low-pass, bilinear with pre-warped cut-off. A cut-off of zero, or at or above
    /// 45 % of the rate, means no filter.
    #[must_use]
    pub fn low_pass(cutoff_hz: f32, rate_hz: f32) -> Self {
        if !(cutoff_hz > 0.0 && cutoff_hz < 0.45 * rate_hz) {
            return Self::through();
        }
        let k = tan(PI * cutoff_hz / rate_hz);
        let (k2, q) = (k * k, core::f32::consts::SQRT_2 * k);
        Self::from_f32([k2, 2.0 * k2, k2], [1.0 + q + k2, 2.0 * (k2 - 1.0), 1.0 - q + k2])
    }

    /// Notch of the given -3 dB bandwidth. A centre of zero or beyond 45 % of the rate means no filter.
    #[must_use]
    pub fn notch(centre_hz: f32, bandwidth_hz: f32, rate_hz: f32) -> Self {
        if !(centre_hz > 0.0 && centre_hz < 0.45 * rate_hz && bandwidth_hz > 0.0) {
            return Self::through();
        }
        let w0 = 2.0 * PI * centre_hz / rate_hz;
        let alpha = tan(PI * bandwidth_hz / rate_hz);
        let c = -2.0 * sin_cos(w0).1;
        Self::from_f32([1.0, c, 1.0], [1.0 + alpha, c, 1.0 - alpha])
    }

    /// State in which a constant input `x` comes out unchanged. Exact for unit gain at DC, which
    /// every filter here has.
    #[must_use]
    pub fn settled(&self, x: S) -> BiquadState<S> {
        let s2 = (self.b2 - self.a2) * x;
        BiquadState { s1: (self.b1 - self.a1) * x + s2, s2 }
    }

    /// One sample.
    #[inline]
    pub fn step(&self, state: &mut BiquadState<S>, x: S) -> S {
        let y = self.b0 * x + state.s1;
        state.s1 = self.b1 * x - self.a1 * y + state.s2;
        state.s2 = self.b2 * x - self.a2 * y;
        y
    }
}

/// The same filter on three axes, starting settled at its first sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Biquad3State<S> {
    axes: Option<[BiquadState<S>; 3]>,
}

impl<S: Scalar> Biquad3State<S> {
    /// Filters one vector.
    #[inline]
    pub fn step(&mut self, filter: &Biquad<S>, v: V3<S>) -> V3<S> {
        if filter.is_through {
            self.axes = None;
            return v;
        }
        let [x, y, z] = self
            .axes
            .get_or_insert_with(|| [filter.settled(v.x), filter.settled(v.y), filter.settled(v.z)]);
        V3::new(filter.step(x, v.x), filter.step(y, v.y), filter.step(z, v.z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gain_at(filter: &Biquad<f64>, hz: f64, rate: f64) -> f64 {
        let mut state = filter.settled(0.0);
        let n = 4000;
        let (mut power, w) = (0.0_f64, 2.0 * core::f64::consts::PI * hz / rate);
        for i in 0..n {
            let y = filter.step(&mut state, (w * f64::from(i)).sin());
            if i >= n / 2 {
                power += y * y;
            }
        }
        (2.0 * power / f64::from(n / 2)).sqrt()
    }

    #[test]
    fn low_pass_halves_the_power_at_its_cut_off() {
        let f = Biquad::low_pass(80.0, 1000.0);
        assert!((gain_at(&f, 80.0, 1000.0) - 0.5_f64.sqrt()).abs() < 0.01);
        assert!(gain_at(&f, 5.0, 1000.0) > 0.99);
        assert!(gain_at(&f, 400.0, 1000.0) < 0.02);
    }

    #[test]
    fn notch_removes_its_centre_and_leaves_the_rest() {
        let f = Biquad::notch(78.0, 20.0, 1000.0);
        assert!(gain_at(&f, 78.0, 1000.0) < 0.02);
        assert!(gain_at(&f, 10.0, 1000.0) > 0.97);
        assert!(gain_at(&f, 300.0, 1000.0) > 0.97);
    }

    #[test]
    fn a_settled_filter_passes_a_constant_from_the_first_sample() {
        for f in [
            Biquad::<f64>::low_pass(80.0, 1000.0),
            Biquad::notch(78.0, 20.0, 1000.0),
            Biquad::through(),
        ] {
            let mut s = f.settled(-9.81);
            for _ in 0..10 {
                assert!((f.step(&mut s, -9.81) + 9.81).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn a_silly_cut_off_means_no_filter() {
        for hz in [0.0, -3.0, 460.0, f32::NAN, f32::INFINITY] {
            assert_eq!(Biquad::<f32>::low_pass(hz, 1000.0), Biquad::through());
        }
    }
}
