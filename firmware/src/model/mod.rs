//! What the algorithms believe of the vehicle and its link.

mod line;
mod pendulum;
mod planar;
mod rotors;
mod tether_angle;
mod tether_kind;

pub use line::Line;
pub use pendulum::PendulumModel;
pub use planar::{PlanarImu, PlanarModel, PlanarState};
pub use rotors::{Rotor, Rotors, thrust_max};
pub use tether_angle::{TetherAngle, TetherAngleModel, TiltImu};
pub use tether_kind::TetherKind;
