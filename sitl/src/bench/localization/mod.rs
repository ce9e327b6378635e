//! The simulated flights of the self-localisation article: a quadrotor on a constant-tension cable
//! circles its station; every position estimator of the core runs over the record.

mod generate;
mod plant;
mod run;
mod scenario;

pub use generate::{DT, Sample, generate};
pub use plant::{CableVehicle, State, to_body};
pub use run::{Accuracy, ESTIMATORS, Fix, Outcome, SETTLED, Setup, Track, measurement, run};
pub use scenario::LocalizationScenario;
