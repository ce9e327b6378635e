//! Flies a load on a rod along a reference: the article's backstepping law with every derivative
//! explicit, and the linear-quadratic baseline. `pendulum` sections 6, 7, 9 and 11.
//!
//! [`PendulumGains`] → [`guidance::Guidance`] (the force wanted) → [`force_rate::ForceRate`] (how it turns)
//! → [`body_rate`] (how the vehicle must turn). [`PendulumControl`] adds limits and guards.

pub mod body_rate;
pub mod force_rate;
mod gains;
pub mod guidance;
mod law;
mod linear;

pub use gains::{GainConditions, PendulumGains};
pub use law::{PendulumCommand, PendulumControl, PendulumLimits, PendulumMemory};
pub use linear::{LinearGains, LinearPendulum};
