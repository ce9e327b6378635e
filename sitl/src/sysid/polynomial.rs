//! `A y = Σ (B/F) u + (C/D) e`: ARX, ARMAX, Box–Jenkins, output error and first-order processes are
//! choices of which polynomials are free.

use super::prepare::Signals;
use nalgebra::DMatrix;

/// Coefficients by rising delay; A, C, D and each F begin with 1, each B with 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Polynomial {
    /// Of the output.
    pub a: Vec<f64>,
    /// B and F of each input.
    pub inputs: Vec<[Vec<f64>; 2]>,
    /// Of the noise.
    pub c: Vec<f64>,
    /// Of the noise.
    pub d: Vec<f64>,
}

/// `b/a` on a signal, from rest.
#[must_use]
pub fn rational(b: &[f64], a: &[f64], x: &[f64]) -> Vec<f64> {
    let mut y = Vec::with_capacity(x.len());
    for t in 0..x.len() {
        let mut sum = 0.0;
        for (k, b) in b.iter().enumerate().take(t + 1) {
            sum += b * x[t - k];
        }
        for (k, a) in a.iter().enumerate().take(t + 1).skip(1) {
            sum -= a * y[t - k];
        }
        y.push(sum / a[0]);
    }
    y
}

/// Largest magnitude of a polynomial's roots, by the eigenvalues of its companion matrix.
#[must_use]
pub fn largest_root(polynomial: &[f64]) -> f64 {
    let order = polynomial.len().saturating_sub(1);
    if order == 0 {
        return 0.0;
    }
    let mut companion = DMatrix::<f64>::zeros(order, order);
    for (k, a) in polynomial.iter().enumerate().skip(1) {
        companion[(0, k - 1)] = -a / polynomial[0];
        if k < order {
            companion[(k, k - 1)] = 1.0;
        }
    }
    companion.complex_eigenvalues().iter().map(|z| z.norm()).fold(0.0, f64::max)
}

impl Polynomial {
    /// One-step prediction errors.
    #[must_use]
    pub fn residuals(&self, data: &Signals) -> Vec<f64> {
        let mut v = rational(&self.a, &[1.0], &data.output);
        for ([b, f], u) in self.inputs.iter().zip(&data.inputs) {
            for (v, x) in v.iter_mut().zip(rational(b, f, u)) {
                *v -= x;
            }
        }
        rational(&self.d, &self.c, &v)
    }

    /// First `count` values of the noise model's impulse response, C/(A D).
    #[must_use]
    pub fn noise_impulse(&self, count: usize) -> Vec<f64> {
        let mut impulse = vec![0.0; count];
        if let Some(first) = impulse.first_mut() {
            *first = 1.0;
        }
        rational(&[1.0], &self.d, &rational(&self.c, &self.a, &impulse))
    }

    /// Largest root of what must be stable: predictor and plant.
    #[must_use]
    pub fn largest_pole(&self) -> f64 {
        let denominators = self.inputs.iter().map(|[_, f]| f).chain([&self.a, &self.c, &self.d]);
        denominators.map(|p| largest_root(p)).fold(0.0, f64::max)
    }

    /// Whether plant and predictor forget: F and C alone decide that of the prediction errors.
    #[must_use]
    pub fn predicts_stably(&self) -> bool {
        let denominators = self.inputs.iter().map(|[_, f]| f).chain([&self.c]);
        denominators.map(|p| largest_root(p)).all(|r| r < 1.0)
    }

    /// Output per input at rest.
    #[must_use]
    pub fn static_gains(&self) -> Vec<f64> {
        let at_one = |p: &[f64]| p.iter().sum::<f64>();
        self.inputs.iter().map(|[b, f]| at_one(b) / at_one(f) / at_one(&self.a)).collect()
    }
}
