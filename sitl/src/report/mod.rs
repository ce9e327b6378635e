//! Pictures of a flight, from its log.

mod draw;
mod read;

pub use draw::draw_flight;
pub use read::{FlightData, Series};
