//! The planar and spatial worlds of taut-tether sensing: a point mass under constant thrust, flown by
//! the core's minimal localisation, filter and controller.

#![expect(clippy::indexing_slicing, reason = "matrices and planes of fixed size")]

mod linear;
mod monte_carlo;
mod plant;
mod run;
mod scenario;
mod spatial;

pub use linear::{LinearLoop, linearise};
pub use monte_carlo::{Sensitivity, Setting, sensitivity};
pub use plant::{Acting, Motion, Plane, PlaneModel};
pub use run::{AngleRow, AngleSummary, AngleTrace, fly};
pub use scenario::{AnchorMotion, AngleFeedback, AngleScenario, ThrustDrop};
pub use spatial::{SpatialRow, SpatialTrace, fly_spatial};
