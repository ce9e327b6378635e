//! Thrust from PWM, identified from flight data. `localization` section 8.

#![expect(clippy::indexing_slicing, reason = "numerics on columns of checked length")]

mod arx;
mod draw;
mod fit;
mod identify;
mod log;
mod minimize;
mod polynomial;
mod prepare;
mod record;
mod stand;
mod subspace;
mod thrust_map;

pub use arx::arx;
pub use draw::draw_predictions;
pub use fit::{Form, fit};
pub use identify::{AHEAD, Identified, Model, STRUCTURES, identify, recommend};
pub use log::{from_log, read_log};
pub use polynomial::{Polynomial, largest_root};
pub use prepare::{Prepared, RATE, Signals, low_pass_channel, prepare};
pub use record::{CHANNELS, Record, parse_csv, read_csv};
pub use stand::{Stand, fit_stand, is_stand, parse_stand, read_stand};
pub use subspace::{StateSpace, subspace};
pub use thrust_map::{PwmRange, ThrustFit, fit_thrust_map};
