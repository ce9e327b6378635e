//! Inertial sensors.

pub mod icm42688;
