//! Pictures of a flight, from its log.

pub mod chart;
mod draw;
pub mod grid;
mod legend;
mod panels;
mod read;
pub mod space;
mod timeline;

pub use draw::draw_flight;
pub use panels::Kind;
pub use read::{FlightData, Series, State};
