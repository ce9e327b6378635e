//! Rangefinders.

pub mod tfmini;
