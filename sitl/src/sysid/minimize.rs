//! Nonlinear least squares by Levenberg and Marquardt, with a trust region.
//!
//! Moré 1978, "The Levenberg–Marquardt algorithm: implementation and theory", with the constants and stopping
//! rules of MINPACK. Departure: the damped step comes from a singular value decomposition of the scaled
//! triangular factor, not from one orthogonalisation per trial; with a dozen unknowns it costs nothing, makes
//! the search for the damping scalar, and gives rank deficiency the shortest step.

use nalgebra::{DMatrix, DVector};

/// Residuals and their derivatives.
pub trait Problem {
    /// At `x`.
    fn residuals(&self, x: &DVector<f64>) -> DVector<f64>;
    /// Residuals by unknowns, at `x`.
    fn jacobian(&self, x: &DVector<f64>) -> DMatrix<f64>;
}

/// Relative change of cost, of unknowns and of the gradient's cosine below which it has converged.
const TOLERANCE: f64 = 30.0 * f64::EPSILON;
/// First trust region over the length of the scaled start.
const FIRST_REGION: f64 = 100.0;
/// Share of the predicted gain that a step must bring.
const ACCEPTED_GAIN: f64 = 1e-4;
/// How well the step's length meets the region's radius.
const RADIUS_SLACK: f64 = 0.1;
const MAX_DAMPING_TRIALS: usize = 10;

/// Where it ended, and half the sum of squares there. `patience`: evaluations per unknown, and as many again.
pub fn minimize(
    problem: &impl Problem,
    start: DVector<f64>,
    patience: usize,
) -> (DVector<f64>, f64) {
    let mut x = start;
    let mut residuals = problem.residuals(&x);
    let mut norm = residuals.norm();
    let mut left = patience * (x.len() + 1);
    let mut scale = DVector::zeros(x.len());
    let mut region: Option<f64> = None;
    let mut damping = 0.0;
    while left > 0 && norm > 0.0 && norm.is_finite() {
        let linear = Linear::new(problem.jacobian(&x), &residuals, &mut scale);
        if linear.steepest_cosine(norm) <= TOLERANCE {
            break;
        }
        let length = scale.component_mul(&x).norm();
        let mut radius = region.unwrap_or(FIRST_REGION * if length > 0.0 { length } else { 1.0 });
        loop {
            damping = linear.damping(damping, radius);
            let step = linear.step(damping, &scale);
            let step_length = scale.component_mul(&step).norm();
            if region.is_none() {
                radius = radius.min(step_length);
            }
            let trial = &x + &step;
            let trial_residuals = problem.residuals(&trial);
            let trial_norm = trial_residuals.norm();
            left = left.saturating_sub(1);

            // Ten times worse and not a number alike.
            let is_sane = 0.1 * trial_norm < norm;
            let gain = if is_sane { 1.0 - (trial_norm / norm).powi(2) } else { -1.0 };
            let along = (linear.apply(&step).norm() / norm).powi(2);
            let damped = damping * (step_length / norm).powi(2);
            let predicted = along + 2.0 * damped;
            let ratio = if predicted > 0.0 { gain / predicted } else { 0.0 };
            if ratio <= 0.25 {
                let slope = -(along + damped);
                let shrunk = if gain >= 0.0 { 0.5 } else { 0.5 * slope / (slope + 0.5 * gain) };
                let shrunk = if is_sane { shrunk.max(0.1) } else { 0.1 };
                radius = shrunk * radius.min(10.0 * step_length);
                damping /= shrunk;
            } else if damping == 0.0 || ratio >= 0.75 {
                radius = 2.0 * step_length;
                damping *= 0.5;
            }
            region = Some(radius);

            let is_accepted = ratio >= ACCEPTED_GAIN;
            if is_accepted {
                (x, residuals, norm) = (trial, trial_residuals, trial_norm);
            }
            let is_flat = gain.abs() <= TOLERANCE && predicted <= TOLERANCE && ratio <= 2.0;
            let is_small = radius <= TOLERANCE * scale.component_mul(&x).norm();
            if is_flat || is_small || left == 0 {
                return (x, 0.5 * norm * norm);
            }
            if is_accepted {
                break;
            }
        }
    }
    (x, 0.5 * norm * norm)
}

/// The linearised problem in scaled unknowns, taken apart: `J D⁻¹ = U diag(s) Vᵀ`.
struct Linear {
    triangle: DMatrix<f64>,
    /// Columns' norms of the Jacobian.
    columns: DVector<f64>,
    /// Jᵀ r.
    gradient: DVector<f64>,
    singular: DVector<f64>,
    right: DMatrix<f64>,
    /// Uᵀ of the residuals.
    along: DVector<f64>,
}

impl Linear {
    /// `scale` grows with the columns.
    fn new(jacobian: DMatrix<f64>, residuals: &DVector<f64>, scale: &mut DVector<f64>) -> Self {
        let columns = DVector::from_iterator(
            jacobian.ncols(),
            jacobian.column_iter().map(|column| column.norm()),
        );
        for (scale, norm) in scale.iter_mut().zip(&columns) {
            *scale = scale.max(*norm);
            if *scale == 0.0 {
                *scale = 1.0;
            }
        }
        let gradient = jacobian.tr_mul(residuals);
        let parts = jacobian.qr();
        let triangle = parts.r();
        let mut along = residuals.clone();
        parts.q_tr_mul(&mut along);
        let along = along.rows(0, triangle.nrows()).into_owned();
        let mut scaled = triangle.clone();
        for (mut column, scale) in scaled.column_iter_mut().zip(scale.iter()) {
            column /= *scale;
        }
        let parts = scaled.svd(true, true);
        let (left, right) = match (parts.u, parts.v_t) {
            (Some(u), Some(v)) => (u, v),
            // Both were asked for.
            _ => (DMatrix::zeros(along.len(), 0), DMatrix::zeros(0, columns.len())),
        };
        let along = left.tr_mul(&along);
        Self { triangle, columns, gradient, singular: parts.singular_values, right, along }
    }

    /// Largest cosine between the residuals and a column.
    fn steepest_cosine(&self, norm: f64) -> f64 {
        self.gradient.iter().zip(&self.columns).fold(0.0, |most: f64, (gradient, column)| {
            if *column > 0.0 { most.max((gradient / (column * norm)).abs()) } else { most }
        })
    }

    /// Singular values that count: smaller ones are round-off.
    fn floor(&self) -> f64 {
        self.singular.max() * f64::EPSILON * self.columns.len() as f64
    }

    /// The scaled step's components along the right singular vectors.
    fn components(&self, damping: f64) -> DVector<f64> {
        let floor = self.floor();
        self.singular.zip_map(&self.along, |s, along| {
            if s > floor { -s * along / (s * s + damping) } else { 0.0 }
        })
    }

    fn step(&self, damping: f64, scale: &DVector<f64>) -> DVector<f64> {
        self.right.tr_mul(&self.components(damping)).component_div(scale)
    }

    /// J times the step, but for an orthogonal factor.
    fn apply(&self, step: &DVector<f64>) -> DVector<f64> {
        &self.triangle * step
    }

    /// Newton's correction of the damping, for the reciprocal of the step's length.
    fn correction(&self, components: &DVector<f64>, damping: f64, radius: f64) -> f64 {
        let length = components.norm();
        let floor = self.floor();
        let bend: f64 = components
            .iter()
            .zip(&self.singular)
            .filter(|(_, s)| **s > floor)
            .map(|(c, s)| (c / length).powi(2) / (s * s + damping))
            .sum();
        (length - radius) / radius / bend
    }

    /// The damping at which the step just fits the region; 0 if the whole step does. `last` is the first guess.
    fn damping(&self, last: f64, radius: f64) -> f64 {
        let whole = self.components(0.0);
        let over = whole.norm() - radius;
        if over <= RADIUS_SLACK * radius {
            return 0.0;
        }
        let is_regular = self.singular.min() > self.floor();
        let mut low = if is_regular { self.correction(&whole, 0.0, radius) } else { 0.0 };
        let slope = self.singular.component_mul(&self.along).norm();
        let mut high = slope / radius;
        let mut damping = last.clamp(low, high.max(low));
        if damping == 0.0 {
            damping = slope / whole.norm();
        }
        for _ in 0..MAX_DAMPING_TRIALS {
            let components = self.components(damping);
            let over = components.norm() - radius;
            if over.abs() <= RADIUS_SLACK * radius {
                break;
            }
            if over > 0.0 {
                low = low.max(damping);
            } else {
                high = high.min(damping);
            }
            damping = (damping + self.correction(&components, damping, radius)).max(low);
        }
        damping.min(high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Rosenbrock;

    impl Problem for Rosenbrock {
        fn residuals(&self, x: &DVector<f64>) -> DVector<f64> {
            DVector::from_vec(vec![10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]])
        }
        fn jacobian(&self, x: &DVector<f64>) -> DMatrix<f64> {
            DMatrix::from_row_slice(2, 2, &[-20.0 * x[0], 10.0, -1.0, 0.0])
        }
    }

    /// Moré, Garbow and Hillstrom 1981, problem 15: a sum of squares that does not vanish.
    struct KowalikOsborne;

    const Y: [f64; 11] =
        [0.1957, 0.1947, 0.1735, 0.16, 0.0844, 0.0627, 0.0456, 0.0342, 0.0323, 0.0235, 0.0246];
    const U: [f64; 11] = [4.0, 2.0, 1.0, 0.5, 0.25, 0.167, 0.125, 0.1, 0.0833, 0.0714, 0.0625];

    impl Problem for KowalikOsborne {
        fn residuals(&self, x: &DVector<f64>) -> DVector<f64> {
            DVector::from_fn(11, |i, _| {
                let u = U[i];
                Y[i] - x[0] * (u * u + u * x[1]) / (u * u + u * x[2] + x[3])
            })
        }
        fn jacobian(&self, x: &DVector<f64>) -> DMatrix<f64> {
            DMatrix::from_fn(11, 4, |i, j| {
                let u = U[i];
                let (over, under) = (u * u + u * x[1], u * u + u * x[2] + x[3]);
                let inner = x[0] * over / (under * under);
                [-over / under, -x[0] * u / under, inner * u, inner][j]
            })
        }
    }

    /// One unknown twice: the columns depend on each other.
    struct Twins;

    impl Problem for Twins {
        fn residuals(&self, x: &DVector<f64>) -> DVector<f64> {
            DVector::from_vec(vec![x[0] + x[1] - 4.0, 2.0 * (x[0] + x[1]) - 8.0, 0.0])
        }
        fn jacobian(&self, _: &DVector<f64>) -> DMatrix<f64> {
            DMatrix::from_row_slice(3, 2, &[1.0, 1.0, 2.0, 2.0, 0.0, 0.0])
        }
    }

    #[test]
    fn a_curved_valley_is_followed_to_its_end() {
        let (x, cost) = minimize(&Rosenbrock, DVector::from_vec(vec![-1.2, 1.0]), 30);
        assert!((x[0] - 1.0).abs() < 1e-9 && (x[1] - 1.0).abs() < 1e-9, "{x}");
        assert!(cost < 1e-18, "{cost}");
    }

    #[test]
    fn the_published_minima_are_found_from_both_starts() {
        // From ten times as far the valley leads to infinity; the authors give that sum of squares too.
        for (factor, least) in [(1.0, 3.07505e-4), (10.0, 1.02734e-3)] {
            let start = DVector::from_vec(vec![0.25, 0.39, 0.415, 0.39]) * factor;
            let (_, cost) = minimize(&KowalikOsborne, start, 100);
            assert!((2.0 * cost - least).abs() < 1e-8, "{factor}: {cost}");
        }
    }

    #[test]
    fn columns_that_depend_on_each_other_share_the_step() {
        let (x, cost) = minimize(&Twins, DVector::from_vec(vec![1.0, 0.0]), 30);
        assert!((x[0] - 2.5).abs() < 1e-9 && (x[1] - 1.5).abs() < 1e-9 && cost < 1e-20, "{x}");
    }

    #[test]
    fn a_start_without_a_number_comes_back_as_such() {
        let (_, cost) = minimize(&Rosenbrock, DVector::from_vec(vec![f64::NAN, 1.0]), 30);
        assert!(!cost.is_finite());
    }
}
