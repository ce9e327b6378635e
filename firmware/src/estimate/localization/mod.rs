//! Position and cable tension without a force sensor. `localization`, after Al-Radaideh and Sun.
//!
//! [`solve_static`] balances one sample; [`LowPassLocator`] is the low-passed baseline; the four-state
//! filter of the article is [`super::Ekf4`], and its three-state form is the same filter at a known
//! tension ([`super::Ekf4State::with_known_tension`]). [`ErrorStateFilter`] adds velocity, attitude,
//! thrust scale and sensor biases, which removes the trade-off between lag and noise.

mod article;
mod error_state;
mod noise;
mod start;
mod static_solution;

pub use article::{NoiseReading, article_ekf, article_start};
pub use error_state::{
    ErrorState, ErrorStateFilter, ErrorStateMeasurement, ErrorStateStep, STATES,
};
pub use noise::ErrorStateNoise;
pub use start::ErrorStateStart;
pub use static_solution::{
    LowPassLocator, LowPassState, NotSolved, StaticSolution, cable_pull, solve_static,
};
