//! Steps from rest to rest with as many continuous derivatives as one asks for. `planar` section 5.

use crate::fault::{Invalid, positive, require};
use crate::scalar::Scalar;

/// Largest slope of the C2 step: peak speed is this times distance over duration.
pub const PEAK_SLOPE: f32 = 1.875;

/// How many derivatives are continuous at both ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Smoothness {
    /// `3τ² - 2τ³`.
    C1,
    /// `10τ³ - 15τ⁴ + 6τ⁵`.
    C2,
    /// `35τ⁴ - 84τ⁵ + 70τ⁶ - 20τ⁷`.
    C3,
    /// `126τ⁵ - 420τ⁶ + 540τ⁷ - 315τ⁸ + 70τ⁹`.
    C4,
    /// `462τ⁶ - 1980τ⁷ + 3465τ⁸ - 3080τ⁹ + 1386τ¹⁰ - 252τ¹¹`.
    C5,
}

impl Smoothness {
    /// Coefficients, highest power first, down to the constant.
    const fn coefficients(self) -> &'static [f64] {
        match self {
            Self::C1 => &[-2.0, 3.0, 0.0, 0.0],
            Self::C2 => &[6.0, -15.0, 10.0, 0.0, 0.0, 0.0],
            Self::C3 => &[-20.0, 70.0, -84.0, 35.0, 0.0, 0.0, 0.0, 0.0],
            Self::C4 => &[70.0, -315.0, 540.0, -420.0, 126.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            Self::C5 => {
                &[-252.0, 1386.0, -3080.0, 3465.0, -1980.0, 462.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
            }
        }
    }

    /// Value and the first `N - 1` derivatives at `tau`; at rest up to 0 and from 1 on, so that a sample
    /// that falls on an end sees no jump of a higher derivative.
    #[must_use]
    pub fn at<S: Scalar, const N: usize>(self, tau: S) -> [S; N] {
        let mut derivatives = [S::zero(); N];
        if let Some(value) = derivatives.first_mut().filter(|_| tau >= S::one()) {
            *value = S::one();
        }
        if tau <= S::zero() || tau >= S::one() {
            return derivatives;
        }
        // From the nearer end, where the large alternating coefficients cost no digits.
        let is_late = tau > S::lit(0.5);
        let tau = if is_late { S::one() - tau } else { tau };
        // Horner's scheme carries the Taylor coefficients along.
        for &c in self.coefficients() {
            let mut carry = S::lit(c);
            for coefficient in &mut derivatives {
                let old = *coefficient;
                *coefficient = old * tau + carry;
                carry = old;
            }
        }
        let (mut factorial, mut order) = (S::one(), S::zero());
        for derivative in &mut derivatives {
            *derivative *= factorial;
            order += S::one();
            factorial *= if is_late { -order } else { order };
        }
        if is_late {
            derivatives = derivatives.map(|x| -x);
            if let Some(value) = derivatives.first_mut() {
                *value += S::one();
            }
        }
        derivatives
    }
}

/// The C2 step: value and slope at `tau`; clamped to rest outside [0, 1].
#[must_use]
pub fn smooth_step<S: Scalar>(tau: S) -> (S, S) {
    let [value, slope] = Smoothness::C2.at(tau);
    (value, slope)
}

/// One number going from rest to rest in a given time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothMove<S> {
    from: S,
    to: S,
    duration: S,
    smoothness: Smoothness,
}

impl<S: Scalar> SmoothMove<S> {
    /// From and to in the same unit, duration in s.
    ///
    /// # Errors
    /// [`Invalid`] naming `from`, `to` or `duration`.
    pub fn try_new(from: S, to: S, duration: S, smoothness: Smoothness) -> Result<Self, Invalid> {
        let finite = |field, x| require(field, "finite", x, |_| true);
        Ok(Self {
            from: finite("from", from)?,
            to: finite("to", to)?,
            duration: positive("duration", duration)?,
            smoothness,
        })
    }

    /// Stay there.
    #[must_use]
    pub fn stay(at: S, smoothness: Smoothness) -> Self {
        Self { from: at, to: at, duration: S::one(), smoothness }
    }

    /// Value and `N - 1` time derivatives at a time since the start, s; at rest before and after.
    #[must_use]
    pub fn at<const N: usize>(&self, time: S) -> [S; N] {
        let per = S::one() / self.duration;
        let mut derivatives = self.smoothness.at(time * per);
        let mut factor = self.to - self.from;
        for derivative in &mut derivatives {
            *derivative *= factor;
            factor *= per;
        }
        if let Some(value) = derivatives.first_mut() {
            *value += self.from;
        }
        derivatives
    }

    /// Where it ends.
    #[must_use]
    pub fn end(&self) -> S {
        self.to
    }

    /// s.
    #[must_use]
    pub fn duration(&self) -> S {
        self.duration
    }
}
