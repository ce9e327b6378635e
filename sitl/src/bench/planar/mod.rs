//! The planar world of the articles: a vehicle on a rigid link in a vertical plane, with its own
//! equations of motion, flown by the core's observer and controllers.

mod controller;
mod metrics;
mod plant;
mod run;
mod scenario;

pub use metrics::{Errors, Phase, PlanarSummary};
pub use plant::{PlanarPlant, PlanarPlantModel, Readings};
pub use run::{Row, Trace, fly};
pub use scenario::{
    BranchChoice, Feedback, InversionKind, LawKind, PlanarScenario, Residual, SmoothKind,
    UpdateKind,
};
