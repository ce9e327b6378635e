//! Feedback gains from poles.

use crate::fault::{Invalid, require};
use crate::scalar::Scalar;

/// Coefficients `k1 … kn` of `Π(s - p) = sⁿ + kn sⁿ⁻¹ + … + k1`, for real poles, 1/s each.
///
/// # Errors
/// [`Invalid`] naming `field` unless every pole is finite and negative.
pub fn gains_from_poles<S: Scalar, const N: usize>(
    field: &'static str,
    poles: &[S; N],
) -> Result<[S; N], Invalid> {
    // Descending powers below the leading 1; multiplying by (s - p) shifts and adds.
    let mut gains = [S::zero(); N];
    for &pole in poles {
        let pole = require(field, "finite and negative (stable)", pole, |p| p < S::zero())?;
        let mut before = S::one();
        for gain in &mut gains {
            let old = *gain;
            *gain -= pole * before;
            before = old;
        }
    }
    gains.reverse();
    Ok(gains)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gains_are_the_coefficients_of_the_product() {
        let k = gains_from_poles("poles", &[-6.0_f64, -4.5, -3.0]).unwrap();
        assert_eq!(k, [81.0, 58.5, 13.5]);
    }

    #[test]
    fn unstable_and_silly_poles_are_refused_by_name() {
        for bad in [0.0, 1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let error = gains_from_poles("force_poles", &[-1.0, bad]).unwrap_err();
            assert_eq!(error.field, "force_poles");
        }
    }
}
