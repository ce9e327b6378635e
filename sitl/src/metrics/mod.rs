//! How well was it flown? Against the truth, not the estimate: a whole flight ([`Metrics`]), and beside it
//! each mode that has figures of its own.

use crate::plant::TICK;

mod angle;
mod flown;
mod interval;
mod mean;
mod pendulum;
mod place;
mod spread;
mod taut;
mod verdict;

pub use angle::{AngleFlightSummary, AngleMetrics};
pub use flown::{Metrics, Summary};
pub use interval::Interval;
pub use mean::Mean;
pub use pendulum::{PendulumFlightSummary, PendulumMetrics};
pub use place::{PlaceMetrics, PlaceSummary};
pub use spread::Spread;
pub use taut::{TautMetrics, TautSummary};
pub use verdict::Verdict;

/// Milliseconds from one look to the next: errors change slower than that.
const PERIOD: u32 = 10;
/// The same, s.
const DT: f64 = TICK * PERIOD as f64;
