//! Steps that are smaller than the resolution of the sum they are added to.
//!
//! In fixed point an integrator with a small gain stands still: its steps round to nothing. Here they are counted
//! [`FINE`] times as large, and what has not reached the sum waits. Floats compute as if this were not here, to the
//! last bit.

use crate::frames::V3;
use crate::scalar::Scalar;

/// Steps are given so many times as large. A power of two.
pub const FINE: f64 = 256.0;

/// What has not reached the sum yet, [`FINE`] times as large; always zero in floats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Remainder<S: Scalar>(V3<S>);

impl<S: Scalar> Default for Remainder<S> {
    fn default() -> Self {
        Self(V3::zeros())
    }
}

impl<S: Scalar> Remainder<S> {
    /// The sum's part of one more step, which is given [`FINE`] times as large.
    pub fn take(&mut self, fine: V3<S>) -> V3<S> {
        let share = S::lit(1.0 / FINE);
        if S::IS_FLOATING {
            return fine * share;
        }
        let waiting = self.0 + fine;
        let whole = waiting * share;
        self.0 = waiting - whole * S::lit(FINE);
        whole
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixed::Q16;

    #[test]
    fn steps_below_the_resolution_add_up() {
        // A tenth of the resolution, ten thousand times.
        let step = 0.1 / 65_536.0;
        let (mut sum, mut plain) = (V3::<Q16>::zeros(), V3::<Q16>::zeros());
        let mut rest = Remainder::default();
        for _ in 0..10_000 {
            let fine = V3::new(Q16::lit(step * FINE), Q16::lit(-step * FINE), Q16::lit(0.0));
            sum += rest.take(fine);
            plain += V3::new(Q16::lit(step), Q16::lit(-step), Q16::lit(0.0));
        }
        let want = step * 10_000.0;
        assert!((f64::from(sum.x.to_f32()) - want).abs() < 0.03 * want, "{sum:?}");
        assert!((f64::from(sum.y.to_f32()) + want).abs() < 0.03 * want, "{sum:?}");
        assert_eq!(plain, V3::zeros());
    }
}
