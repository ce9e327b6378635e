//! What every image for a Cortex-M3 or better needs and no other crate gives.

#![cfg_attr(target_os = "none", no_std)]

#[cfg(target_os = "none")]
pub mod bus_fault;
#[cfg(target_os = "none")]
mod copy;
#[cfg(target_os = "none")]
pub mod crash;
#[cfg(target_os = "none")]
pub mod micros;
#[cfg(target_os = "none")]
pub mod stack;
