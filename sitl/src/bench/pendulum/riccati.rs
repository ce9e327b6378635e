//! Gains of the linear-quadratic baseline, `pendulum` section 10.

use nalgebra::{SMatrix, SVector};
use tautline_firmware::control::pendulum::LinearGains;
use tautline_firmware::scalar::Scalar;

type M5 = SMatrix<f64, 5, 5>;

/// Weights of position, velocity, lean of the rod, its rate, lean of the thrust; then of the input.
pub const NORMAL: ([f64; 5], f64) = ([40.0, 10.0, 20.0, 4.0, 4.0], 0.5);
/// Gentler: more of the tilt range is recoverable under limits, less is held against a disturbance.
pub const SOFT: ([f64; 5], f64) = ([4.0, 2.0, 10.0, 2.0, 4.0], 2.0);

/// Feedback about the upright rod. `stiffness`: weight over vehicle mass times length, 1/s².
#[must_use]
pub fn linear_gains<S: Scalar>(
    gravity: f64,
    stiffness: f64,
    (weights, input): ([f64; 5], f64),
    feeds_forward: bool,
) -> LinearGains<S> {
    let mut a = M5::zeros();
    a[(0, 1)] = 1.0;
    a[(1, 2)] = gravity;
    a[(2, 3)] = 1.0;
    a[(3, 2)] = stiffness;
    a[(3, 4)] = stiffness;
    let b = SVector::<f64, 5>::from([0.0, 0.0, 0.0, 0.0, 1.0]);
    let p = riccati(&a, &b, &M5::from_diagonal(&SVector::from(weights)), input);
    let across: [f64; 5] = (b.transpose() * p / input).into();
    // A double integrator under the same weights.
    let [position, velocity, ..] = weights.map(|w| w / input);
    let kp = position.sqrt();
    let vertical = [kp, (velocity + 2.0 * kp).sqrt()];
    LinearGains { across: across.map(S::lit), vertical: vertical.map(S::lit), feeds_forward }
}

/// The stabilising solution by the matrix-sign iteration of the Hamiltonian.
fn riccati(a: &M5, b: &SVector<f64, 5>, q: &M5, r: f64) -> M5 {
    let mut h = SMatrix::<f64, 10, 10>::zeros();
    h.fixed_view_mut::<5, 5>(0, 0).copy_from(a);
    h.fixed_view_mut::<5, 5>(0, 5).copy_from(&(b * b.transpose() / -r));
    h.fixed_view_mut::<5, 5>(5, 0).copy_from(&-q);
    h.fixed_view_mut::<5, 5>(5, 5).copy_from(&-a.transpose());
    for _ in 0..60 {
        let Some(inverse) = h.try_inverse() else { break };
        // Scaled by the determinant, so that it starts near its end.
        let scale = h.determinant().abs().powf(-0.1);
        h = (h * scale + inverse / scale) * 0.5;
    }
    // (sign + 1) [1; P] = 0.
    let block = |row, column| h.fixed_view::<5, 5>(row, column).into_owned();
    let (mut upper, lower) = (block(0, 5), block(5, 5) + M5::identity());
    let (right, below) = (block(0, 0) + M5::identity(), block(5, 0));
    let mut stacked = SMatrix::<f64, 10, 5>::zeros();
    let mut rhs = SMatrix::<f64, 10, 5>::zeros();
    stacked.fixed_view_mut::<5, 5>(0, 0).copy_from(&upper);
    stacked.fixed_view_mut::<5, 5>(5, 0).copy_from(&lower);
    rhs.fixed_view_mut::<5, 5>(0, 0).copy_from(&-right);
    rhs.fixed_view_mut::<5, 5>(5, 0).copy_from(&-below);
    let normal = stacked.transpose() * stacked;
    upper = normal.try_inverse().unwrap_or_else(M5::zeros) * (stacked.transpose() * rhs);
    (upper + upper.transpose()) * 0.5
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_solution_satisfies_its_equation_and_stabilises() {
        let (g, stiffness) = (9.81, 15.6);
        let gains = linear_gains::<f64>(g, stiffness, NORMAL, true);
        let [kp, kv, kq, kw, kr] = gains.across;
        // The closed loop decays.
        let mut a = M5::zeros();
        a[(0, 1)] = 1.0;
        a[(1, 2)] = g;
        a[(2, 3)] = 1.0;
        a[(3, 2)] = stiffness;
        a[(3, 4)] = stiffness;
        for (i, k) in [kp, kv, kq, kw, kr].into_iter().enumerate() {
            a[(4, i)] -= k;
        }
        let slowest =
            a.complex_eigenvalues().iter().map(|z| z.re).fold(f64::NEG_INFINITY, f64::max);
        assert!(slowest < -0.5, "{slowest}");
        // The first gain of a scalar-input regulator is the root of weight over input.
        assert!((kp - (40.0_f64 / 0.5).sqrt()).abs() < 1e-6, "{kp}");
    }
}
