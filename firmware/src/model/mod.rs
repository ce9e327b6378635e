//! What the algorithms believe of the vehicle and its link.

mod link_kind;
mod planar;
mod tether_angle;

pub use link_kind::LinkKind;
pub use planar::{PlanarImu, PlanarModel, PlanarState};
pub use tether_angle::{TetherAngle, TetherAngleModel, TiltImu};
