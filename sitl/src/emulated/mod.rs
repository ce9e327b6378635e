//! The host of an emulated board: the same world, the same fakes and the same mission runner as [`crate::flight`], but the
//! firmware is an image under QEMU that asks for every bus transaction.

mod devices;
mod flight;
mod pipe;
mod qemu;

pub use flight::{Outcome, Plan, fly};
pub use qemu::Telemetry;
