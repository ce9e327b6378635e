//! What the algorithms believe of the vehicle and its link.

mod planar;

pub use planar::{PlanarImu, PlanarModel, PlanarState};
