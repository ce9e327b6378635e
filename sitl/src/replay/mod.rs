//! The recorded flight once more: what went into each step of the firmware, from the log, through the step of this build.
//!
//! A log carries a stream beside its topics ([`crate::flight::tape`]): how the firmware started, and each step's input
//! with a fingerprint of its output. The same build gives the same fingerprints; another, or other parameters, is compared
//! step by step.

mod draw;
mod read;
mod run;

pub use draw::draw_difference;
pub use read::read;
pub use run::{Difference, Replayed, Settings, replay};
