//! Flight image for STM32F405 autopilot boards.
//!
//! What the tasks do is `tautline_runtime::tasks`'s; `app` gives them vectors and priorities. The inertial sensor paces
//! everything; when it falls silent a millisecond timer does.
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
mod clock;
#[cfg(target_os = "none")]
mod telemetry;

#[cfg(target_os = "none")]
tautline_cortex::crash_handlers!(board::stop_motors);
