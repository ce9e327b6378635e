//! Tautline's flight core.
//!
//! ```text
//! sensors -> estimate -> control -> mixer -> throttle
//!    |          |           |         |
//!    +----------+-----------+---------+--> StepOutput -> log, MAVLink
//!             supervisor (mode, arming, failsafe) gates each stage
//! ```
//!
//! [`vehicle::Vehicle::step`] is the whole autopilot; board and simulator call the same one. Layers,
//! lowest first: [`scalar`], [`time`], [`frames`], [`fault`], [`math`], [`model`]; [`signal`] is the data
//! between stages; [`sense`], [`estimate`] (the filters), [`navigation`] (what joins them), [`trajectory`], [`control`], [`supervisor`] are the stages; [`param`]
//! holds every setting; [`vehicle`] joins them; [`mavlink`] (MAVLink) and [`log`] (ULog) only read its
//! output.
//!
//! `no_std`, no allocator, no panic in the step, time as an argument, no global.

#![no_std]
#![deny(unsafe_code)]
#![cfg_attr(test, allow(clippy::float_cmp))]

#[cfg(test)]
extern crate std;

mod config;
pub mod control;
pub mod estimate;
pub mod fault;
mod feature;
pub mod fixed;
pub mod frames;
pub mod log;
pub mod math;
pub mod mavlink;
pub mod mode;
pub mod model;
pub mod navigation;
pub mod param;
pub mod scalar;
pub mod sense;
pub mod signal;
pub mod single;
pub mod supervisor;
pub mod time;
pub mod trajectory;
pub mod vehicle;
