//! Pictures of a flight, from its log.

pub mod chart;
mod draw;
pub mod grid;
mod read;
pub mod space;

pub use draw::draw_flight;
pub use read::{FlightData, Series};
