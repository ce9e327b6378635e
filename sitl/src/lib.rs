//! Tautline's simulator: the firmware's own step function against a simulated tethered quadrotor.
//!
//! The plant is written apart from the estimators' models and imports nothing of them: a sign error in
//! shared code would cancel and pass. Sensors are register-level fakes read by the real drivers. One
//! [`flight::World::step`] is one millisecond: plant → sensors → drivers → `Vehicle::step` → ESCs.
//! The same seed gives the same flight, bit for bit.
//!
//! Rooms, each using only those before it:
//!
//! | room | |
//! |---|---|
//! | [`scenario`] | what is simulated: the TOML file, its faults, parameter files |
//! | [`plant`] | the physical world |
//! | [`sensor`] | truth → errors → registers → drivers |
//! | [`metrics`] | how well it was flown, against the truth |
//! | [`flight`] | one flight: world, mission, log |
//! | [`emulated`] | the same flight with an image under QEMU |
//! | [`campaign`] | one scenario flown many times: varied, shared among machines, resumed |
//! | [`view`] | a flight as a page shows it |
//! | [`mod@bench`] | the papers' small worlds |
//! | [`ulog`] | reading logs |
//! | [`mcap`] | logs for Foxglove and Rerun |
//! | [`report`] | pictures |
//! | [`replay`] | a log's inputs through the firmware's step again |
//! | [`sysid`] | thrust identification |
//! | [`experiment`] | the papers' results |
//! | [`tautbench`] | estimators beside each other, over flights with their truth |
//! | [`command`] | the command line |
//!
//! Without the feature `cli` only what one flight needs is built, also for `wasm32-unknown-unknown`.

#![forbid(unsafe_code)]

#[cfg(feature = "cli")]
pub mod bench;
#[cfg(feature = "cli")]
pub mod campaign;
#[cfg(feature = "cli")]
pub mod command;
#[cfg(feature = "cli")]
pub mod emulated;
#[cfg(feature = "cli")]
pub mod experiment;
pub mod flight;
pub mod ground;
#[cfg(feature = "cli")]
pub mod mcap;
pub mod metrics;
pub mod plant;
#[cfg(feature = "cli")]
pub mod replay;
#[cfg(feature = "cli")]
pub mod report;
pub mod scenario;
pub mod sensor;
#[cfg(feature = "cli")]
pub mod sysid;
#[cfg(feature = "cli")]
pub mod tautbench;
#[cfg(feature = "cli")]
pub mod ulog;
pub mod view;
