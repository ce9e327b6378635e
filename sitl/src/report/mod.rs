//! Pictures of a flight, from its log.

pub mod chart;
mod draw;
mod read;

pub use draw::draw_flight;
pub use read::{FlightData, Series};
