//! Angle encoders.

pub mod as5600;
