//! Flight image for STM32H743 autopilot boards: the tasks of `tautline_runtime::tasks` on another family.
//!
//! One board so far, the Matek H743-SLIM V3. The inertial sensor paces everything; when it falls silent a millisecond
//! timer does.

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
#[cfg(target_os = "none")]
mod battery;
#[cfg(target_os = "none")]
mod board;
#[cfg(target_os = "none")]
mod card;
#[cfg(target_os = "none")]
mod clock;
#[cfg(target_os = "none")]
mod flash;
#[cfg(target_os = "none")]
mod motors;
#[cfg(target_os = "none")]
mod serial;
#[cfg(target_os = "none")]
mod time;
#[cfg(target_os = "none")]
mod usb;

#[cfg(target_os = "none")]
tautline_cortex::crash_handlers!(motors::stop);
