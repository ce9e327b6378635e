//! The closed loop about an equilibrium. `inertial` section 6.

use super::plant::RATE_LOOP;
use super::scenario::AngleScenario;
use crate::plant::GRAVITY;
use nalgebra::{Complex, SMatrix, SVector};

/// State: tether angle, its rate, tilt, its rate, its acceleration.
#[derive(Clone, Debug)]
pub struct LinearLoop {
    /// (23).
    pub a: SMatrix<f64, 5, 5>,
    /// Tilt rate commanded per state, so that `u = K (x - x_ref)`.
    pub k: SVector<f64, 5>,
    /// Of the closed loop, 1/s, by real then imaginary part.
    pub poles: Vec<Complex<f64>>,
}

/// At a tether angle, rad, with the scenario's length, thrust and time constants; `rate_loop` is natural
/// frequency, rad/s, and damping of (20).
#[must_use]
pub fn linearise(s: &AngleScenario, angle: f64, rate_loop: Option<[f64; 2]>) -> LinearLoop {
    let [wn, zeta] = rate_loop.unwrap_or(RATE_LOOP);
    let (l, f) = (s.length, s.thrust);
    let alpha = f * (1.0 - (GRAVITY * angle.sin() / f).powi(2)).max(0.0).sqrt();
    let mut a = SMatrix::<f64, 5, 5>::zeros();
    a[(0, 1)] = 1.0;
    a[(1, 0)] = (GRAVITY * angle.cos() - alpha) / l;
    a[(1, 2)] = alpha / l;
    a[(2, 3)] = 1.0;
    a[(3, 4)] = 1.0;
    a[(4, 3)] = -wn * wn;
    a[(4, 4)] = -2.0 * zeta * wn;
    let tau = s.tether_time;
    let k = SVector::<f64, 5>::from([
        1.0 - (l / (tau * tau) + GRAVITY * angle.cos()) / alpha,
        -2.0 * s.tether_damping * l / (tau * alpha),
        -1.0,
        0.0,
        0.0,
    ]) / s.tilt_time;
    let mut closed = a;
    for (i, k) in k.iter().enumerate() {
        closed[(4, i)] += wn * wn * k;
    }
    let mut poles: Vec<_> = closed.complex_eigenvalues().iter().copied().collect();
    poles.sort_by(|a, b| a.re.total_cmp(&b.re).then(a.im.total_cmp(&b.im)));
    LinearLoop { a, k, poles }
}
