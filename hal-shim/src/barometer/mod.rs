//! Barometers.

pub mod dps310;
