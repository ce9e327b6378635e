//! Smooth ways from here to there.

mod flatness;
mod leg;
pub mod load;
mod plan;
mod smooth_step;
mod taut_plan;

pub use flatness::{FlatPoint, ThrustBranch};
pub use leg::{Leg, Shape};
pub(crate) use plan::direction_of;
pub use plan::{Plan, Planner, STREAM_TIME};
pub use smooth_step::{SmoothMove, Smoothness, smooth_step};
pub use taut_plan::{TautBounds, TautPlan};
