//! The world of the flying inverted pendulum's article: a point mass on a rigid rod on a vehicle whose
//! thrust and body rates are commanded, flown by the core's observer and controllers.

#![expect(clippy::indexing_slicing, reason = "states and axes of fixed size")]

mod plant;
mod riccati;
mod run;
mod scenario;
mod summary;

pub use plant::{PendulumAction, PendulumPlant, PendulumTruth, STATES};
pub use riccati::linear_gains;
pub use run::{Flown, PendulumRow, PendulumRun, PendulumTrace, Sensing};
pub use scenario::{FilterSet, GainSet, LawKind, PendulumScenario, Precision};
pub use summary::PendulumSummary;
