//! What the algorithms believe of the vehicle and its link.

mod link_kind;
mod pendulum;
mod planar;
mod tether_angle;

pub use link_kind::LinkKind;
pub use pendulum::PendulumModel;
pub use planar::{PlanarImu, PlanarModel, PlanarState};
pub use tether_angle::{TetherAngle, TetherAngleModel, TiltImu};
