//! Benches: the papers' own small worlds, each with its equations of motion, flown by the core's blocks alone.

pub mod localization;
pub mod pendulum;
pub mod planar;
pub mod tether_angle;
