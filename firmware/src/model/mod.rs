//! What the algorithms believe of the vehicle and its link.

mod link_kind;
mod planar;

pub use link_kind::LinkKind;
pub use planar::{PlanarImu, PlanarModel, PlanarState};
