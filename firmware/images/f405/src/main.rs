//! Flight image for STM32F405 autopilot boards.
//!
//! ```text
//! data-ready edge ─▶ flight (5): burst, Vehicle::step, pulses ─▶ queue ─▶ comms (2): MAVLink, log ─▶ idle: card
//!                       ▲                                                   │
//!                       └──────────────── inbox ◀── devices (1) ◀───────────┘
//! ```
//!
//! Numbers are priorities. The inertial sensor paces everything; when it falls silent a millisecond timer does.
//! The board is a feature: a file of pins under `hardware/`, or `emulated`, where a host plays the devices.

#![cfg_attr(target_os = "none", no_std, no_main)]
#![cfg_attr(not(test), warn(missing_docs))]

#[cfg(not(target_os = "none"))]
fn main() {
    println!("this program is for a board: cargo xtask flash");
}

#[cfg(target_os = "none")]
use defmt_rtt as _;

#[cfg(target_os = "none")]
mod app;
#[cfg(all(target_os = "none", feature = "emulated"))]
#[path = "emulated/mod.rs"]
mod board;
#[cfg(all(target_os = "none", not(feature = "emulated")))]
#[path = "hardware/mod.rs"]
mod board;
#[cfg(target_os = "none")]
mod bytes;
#[cfg(target_os = "none")]
mod clock;
#[cfg(target_os = "none")]
mod crash;
#[cfg(target_os = "none")]
mod telemetry;
