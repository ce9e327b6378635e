//! Magnetometers.

pub mod ist8310;
