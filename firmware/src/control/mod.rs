//! From reference and estimate to rotor commands. `fullstate` section 11.
//!
//! [`PositionLoop`] → force → [`AttitudeLoop`] → rates and thrust → [`RateLoop`] → torque →
//! [`Mixer`] → rotor thrusts → [`ThrustMap`] → throttle. The mixer reports what it could not give;
//! the integrators read that report.

mod attitude;
mod dither;
mod mixer;
pub mod pendulum;
mod position;
mod rate;
pub mod taut;
mod tether_angle;
mod thrust_map;
mod vertical;

pub use attitude::{AttitudeCommand, AttitudeLoop};
pub use dither::{Dither, DitherState, Shape};
pub use mixer::{Mixer, Priority};
pub use position::{PositionInput, PositionLoop, PositionOutput, PositionState, RadialControl};
pub use rate::{RateLoop, RateSetpoint, RateState};
pub use tether_angle::{TetherAngleCommand, TetherAngleLoop, attachment_compensation};
pub use thrust_map::ThrustMap;
pub use vertical::{ClimbLoop, ClimbState};
