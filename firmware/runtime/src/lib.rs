//! What every flight image does between its drivers and the core, free of any microcontroller: the host tests it,
//! the simulator uses it, an image only says on which pins and at which priority.
//!
//! | module | what |
//! |---|---|
//! | [`tasks`] | what the tasks of an image do |
//! | [`inner_loop`] | one inertial sample: read, step, motors |
//! | [`slow`] | barometer, rangefinder, battery, each at its own pace |
//! | [`radio`] | a pilot's radio, both ways |
//! | [`line`](mod@line) | the line's own sensors, where fitted |
//! | [`inbox`] | what the slower tasks have for the next step |
//! | [`comms`] | MAVLink on every port, and the flight log |
//! | [`port`], [`serial`], [`usb`] | bytes between interrupts and the tasks that speak MAVLink |
//! | [`recorder`], [`blackbox`] | the log: from task to card, and the card's files |
//! | [`settings`] | parameters from flash at boot, and back when they change; the signing key beside them |
//! | [`keys`] | the signing key between the task that hears it and the one that writes the flash |
//! | [`crash`] | what is left of a panic or a fault after the reset |
//! | [`status`] | what somebody on the ground wants to know of each step |
//! | [`wire`] | how an emulated board asks its host |

#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]

pub mod blackbox;
pub mod comms;
pub mod crash;
pub mod inbox;
pub mod keys;
pub mod line;
pub mod port;
pub mod radio;
pub mod recorder;
pub mod serial;
pub mod settings;
mod silence;
pub mod slow;
pub mod status;
pub mod tasks;
pub mod usb;
pub mod wire;

pub use tautline_inner_loop as inner_loop;
