//! Yang, Yu, Reis and Silvestre's flying inverted pendulum: simulation, experiment, baseline, limits.

mod acceptance;
mod baseline;
mod cases;
mod flight;
mod hardware;
mod simulation;
mod sweeps;

pub use acceptance::acceptance;
pub use baseline::baseline;
pub use flight::flight;
pub use hardware::hardware;
pub use simulation::simulation;
pub use sweeps::sweeps;
