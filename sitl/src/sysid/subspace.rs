//! State space in innovation form by predictor-based subspace identification. `localization` section 8.

use super::prepare::Signals;
use nalgebra::{DMatrix, DVector};

/// States, past and future horizons.
const ORDER: usize = 6;
const PAST: usize = 10;
const FUTURE: usize = 10;
/// Data filtered at 10 Hz and sampled at 100 are nearly singular.
const RIDGE: f64 = 1e-6;

/// `x' = A x + B u + K e`, `y = C x + e`, in the signals' own units.
#[derive(Clone, Debug)]
pub struct StateSpace {
    /// States.
    pub a: DMatrix<f64>,
    /// Inputs.
    pub b: DMatrix<f64>,
    /// Output.
    pub c: DVector<f64>,
    /// Innovation gain.
    pub k: DVector<f64>,
    /// Singular values of the predicted futures.
    pub singular_values: Vec<f64>,
}

fn deviation(x: &[f64]) -> f64 {
    let n = x.len() as f64;
    let mean = x.iter().sum::<f64>() / n;
    (x.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt().max(1e-12)
}

/// `Y Zᵀ (Z Zᵀ + ridge)⁻¹` for row data.
fn regress(y: &DMatrix<f64>, z: &DMatrix<f64>, ridge: f64) -> Option<DMatrix<f64>> {
    let n = z.nrows();
    let gram = z * z.transpose() + DMatrix::identity(n, n) * ridge;
    let solved = gram.cholesky()?.solve(&(z * y.transpose()));
    Some(solved.transpose())
}

/// Identifies.
///
/// # Errors
/// Data that do not carry the order, or an unstable predictor.
pub fn subspace(data: &Signals) -> Result<StateSpace, String> {
    let weak = || "state space: the data do not excite it".to_owned();
    let scales: Vec<f64> = data.channels().map(|x| deviation(x)).collect();
    let scaled: Vec<Vec<f64>> = data
        .channels()
        .zip(&scales)
        .map(|(x, scale)| x.iter().map(|v| v / scale).collect())
        .collect();
    let (channels, inputs) = (scaled.len(), data.inputs.len());
    let samples = data.len();
    if samples < 20 * PAST * channels {
        return Err("state space: too few samples".into());
    }
    let columns = samples - PAST;
    // Past, oldest first: row block j holds the channels at t - PAST + j.
    let past =
        DMatrix::from_fn(PAST * channels, columns, |r, t| scaled[r % channels][t + r / channels]);
    let output = DMatrix::from_fn(1, columns, |_, t| scaled[inputs][t + PAST]);
    let markov = regress(&output, &past, RIDGE * columns as f64).ok_or_else(weak)?;
    // Row i predicts the output i samples later from the same past: its blocks move by i.
    let mut gamma = DMatrix::<f64>::zeros(FUTURE, PAST * channels);
    for i in 0..FUTURE {
        for block in i..PAST {
            for c in 0..channels {
                gamma[(i, block * channels + c)] = markov[(0, (block - i) * channels + c)];
            }
        }
    }
    let futures = gamma * &past;
    let svd = futures.clone().svd(true, false);
    let u = svd.u.ok_or_else(weak)?;
    let sizes = svd.singular_values;
    let mut order: Vec<usize> = (0..sizes.len()).collect();
    order.sort_by(|a, b| sizes[*b].total_cmp(&sizes[*a]));
    let states = DMatrix::from_fn(ORDER, columns, |r, t| {
        let at = order[r];
        u.column(at).dot(&futures.column(t)) / sizes[at]
    });
    let c = regress(&output, &states, 0.0).ok_or_else(weak)?;
    let innovations = &output - &c * &states;
    let rows = ORDER + inputs + 1;
    let now = DMatrix::from_fn(rows, columns - 1, |r, t| {
        if r < ORDER {
            states[(r, t)]
        } else if r < ORDER + inputs {
            scaled[r - ORDER][t + PAST]
        } else {
            innovations[(0, t)]
        }
    });
    let next = states.columns(1, columns - 1).into_owned();
    let all = regress(&next, &now, 0.0).ok_or_else(weak)?;
    let scale = scales[inputs];
    let mut model = StateSpace {
        a: all.columns(0, ORDER).into_owned(),
        b: all.columns(ORDER, inputs).into_owned(),
        c: c.transpose().column(0).into_owned() * scale,
        k: all.column(rows - 1).into_owned() / scale,
        singular_values: order.iter().map(|i| sizes[*i]).collect(),
    };
    for (i, scale) in scales.iter().take(inputs).enumerate() {
        model.b.column_mut(i).scale_mut(1.0 / scale);
    }
    let root = model.predictor_radius();
    if root >= 1.0 {
        return Err(format!("state space: unstable predictor, radius {root:.3}"));
    }
    Ok(model)
}

fn radius(m: &DMatrix<f64>) -> f64 {
    m.complex_eigenvalues().iter().map(|z| z.norm()).fold(0.0, f64::max)
}

impl StateSpace {
    /// Largest eigenvalue of A - K C.
    #[must_use]
    pub fn predictor_radius(&self) -> f64 {
        radius(&(&self.a - &self.k * self.c.transpose()))
    }

    /// Largest eigenvalue of A.
    #[must_use]
    pub fn largest_pole(&self) -> f64 {
        radius(&self.a)
    }

    /// Free parameters, as counted for FPE.
    #[must_use]
    pub fn dimension(&self) -> usize {
        self.a.nrows() * (self.b.ncols() + 2)
    }

    /// One-step prediction errors, from rest.
    #[must_use]
    pub fn residuals(&self, data: &Signals) -> Vec<f64> {
        let mut x = DVector::<f64>::zeros(self.a.nrows());
        (0..data.len())
            .map(|t| {
                let e = data.output[t] - self.c.dot(&x);
                let u = DVector::from_iterator(
                    data.inputs.len(),
                    data.inputs.iter().map(|channel| channel[t]),
                );
                x = &self.a * &x + &self.b * u + &self.k * e;
                e
            })
            .collect()
    }

    /// First values of the noise model's impulse response: 1, CK, CAK, …
    #[must_use]
    pub fn noise_impulse(&self, count: usize) -> Vec<f64> {
        let mut state = self.k.clone();
        let mut impulse = vec![1.0];
        while impulse.len() < count {
            impulse.push(self.c.dot(&state));
            state = &self.a * state;
        }
        impulse
    }

    /// Output per input at rest.
    #[must_use]
    pub fn static_gains(&self) -> Option<Vec<f64>> {
        let n = self.a.nrows();
        let rest = (DMatrix::identity(n, n) - &self.a).lu().solve(&self.b)?;
        Some((self.c.transpose() * rest).iter().copied().collect())
    }
}
