//! Every structure on one record, scored as the article's Table 1.

use super::arx::arx;
use super::fit::{Form, fit};
use super::polynomial::Polynomial;
use super::prepare::{Prepared, Signals};
use super::subspace::{StateSpace, subspace};

/// Samples ahead of the predictions that are scored.
pub const AHEAD: usize = 5;
/// Samples at the start that are not scored.
pub const SKIPPED: usize = 100;

/// A root beyond this remembers a false start for over 20 s: as good as unstable.
const FORGETS: f64 = 0.9995;

/// A model of any structure.
#[derive(Clone, Debug)]
pub enum Model {
    /// Rational.
    Polynomial(Polynomial),
    /// State space.
    StateSpace(StateSpace),
}

/// A structure with its scores.
#[derive(Clone, Debug)]
pub struct Identified {
    /// Structure.
    pub name: &'static str,
    /// Free parameters.
    pub dimension: usize,
    /// Five-step prediction of the validation half, %.
    pub fit: f64,
    /// Final prediction error, N².
    pub fpe: f64,
    /// One-step error of the estimation half, N².
    pub mse: f64,
    /// Five-step error of the validation half, N².
    pub mse_ahead: f64,
    /// Largest root of what plant, noise model and predictor divide by.
    pub largest_pole: f64,
    /// Whether plant and predictor are stable.
    pub is_stable: bool,
    /// The model.
    pub model: Model,
    /// Five-step prediction of the validation half, mean taken off, N.
    pub predicted: Vec<f64>,
}

impl Model {
    /// One-step prediction errors.
    #[must_use]
    pub fn residuals(&self, data: &Signals) -> Vec<f64> {
        match self {
            Self::Polynomial(p) => p.residuals(data),
            Self::StateSpace(s) => s.residuals(data),
        }
    }

    /// `y - Σ h e`: what is known of the output `AHEAD` samples before.
    #[must_use]
    pub fn predict(&self, data: &Signals) -> Vec<f64> {
        let errors = self.residuals(data);
        let impulse = match self {
            Self::Polynomial(p) => p.noise_impulse(AHEAD),
            Self::StateSpace(s) => s.noise_impulse(AHEAD),
        };
        let noise = super::polynomial::rational(&impulse, &[1.0], &errors);
        data.output.iter().zip(noise).map(|(y, e)| y - e).collect()
    }

    fn largest_pole(&self) -> f64 {
        match self {
            Self::Polynomial(p) => p.largest_pole(),
            Self::StateSpace(s) => s.largest_pole(),
        }
    }

    /// Plant, noise model and predictor forget their start.
    fn is_stable(&self) -> bool {
        let predictor = match self {
            Self::Polynomial(_) => 0.0,
            Self::StateSpace(s) => s.predictor_radius(),
        };
        predictor.max(self.largest_pole()) < FORGETS
    }

    /// Thrust per unit of PWM at rest, N, where it is defined.
    #[must_use]
    pub fn static_gains(&self) -> Option<Vec<f64>> {
        match self {
            Self::Polynomial(p) => Some(p.static_gains()),
            Self::StateSpace(s) => s.static_gains(),
        }
    }
}

fn mean_square(x: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = x.fold((0.0, 0.0), |(s, n), x| (s + x * x, n + 1.0));
    sum / f64::max(count, 1.0)
}

fn score(name: &'static str, dimension: usize, model: Model, data: &Prepared) -> Identified {
    let errors = model.residuals(&data.estimation);
    let mse = mean_square(errors.iter().skip(SKIPPED).copied());
    let share = dimension as f64 / errors.len().saturating_sub(SKIPPED).max(1) as f64;
    let predicted = model.predict(&data.validation);
    let measured = data.validation.output.iter().skip(SKIPPED);
    let off = measured.clone().zip(predicted.iter().skip(SKIPPED)).map(|(y, p)| y - p);
    let count = measured.clone().count().max(1) as f64;
    let mean = measured.clone().sum::<f64>() / count;
    let mse_ahead = mean_square(off);
    let spread = mean_square(measured.map(|y| y - mean));
    Identified {
        name,
        dimension,
        fit: 100.0 * (1.0 - (mse_ahead / spread).sqrt()),
        fpe: mse * (1.0 + share) / (1.0 - share),
        mse,
        mse_ahead,
        largest_pole: model.largest_pole(),
        is_stable: model.is_stable(),
        predicted,
        model,
    }
}

/// Names of the structures, in the order of the table.
pub const STRUCTURES: [&str; 6] = [
    "transfer function",
    "process",
    "ARX 2,2,1",
    "ARMAX 2,2,2,1",
    "Box-Jenkins",
    "state space n=6",
];

/// All structures; one that cannot be identified reports why and leaves the others.
#[must_use]
pub fn identify(data: &Prepared) -> Vec<Result<Identified, String>> {
    let inputs = data.estimation.inputs.len();
    let [tf, process, arx_name, armax, bj, ss] = STRUCTURES;
    let polynomial = |name, form: Form| {
        let model = fit(form, &data.estimation)?;
        Ok(score(name, form.dimension(inputs), Model::Polynomial(model), data))
    };
    vec![
        polynomial(tf, Form::TransferFunction),
        polynomial(process, Form::Process),
        arx(&data.estimation, 2, 2)
            .map(|model| score(arx_name, 2 + 2 * inputs, Model::Polynomial(model), data)),
        polynomial(armax, Form::Armax),
        polynomial(bj, Form::BoxJenkins),
        subspace(&data.estimation)
            .map(|model| score(ss, model.dimension(), Model::StateSpace(model), data)),
    ]
}

/// The stable one that predicts best.
#[must_use]
pub fn recommend(found: &[Result<Identified, String>]) -> Option<&Identified> {
    found
        .iter()
        .flatten()
        .filter(|m| m.is_stable && m.fit.is_finite())
        .max_by(|a, b| a.fit.total_cmp(&b.fit))
}
