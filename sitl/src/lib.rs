//! Tautline's simulator: the firmware's own step function against a simulated tethered quadrotor.
//!
//! The plant is written apart from the estimators' models and imports nothing of them: a sign error in
//! shared code would cancel and pass. Sensors are register-level fakes read by the real drivers. One
//! [`world::World::step`] is one millisecond: plant → sensors → drivers → `Vehicle::step` → ESCs.
//! The same seed gives the same flight, bit for bit.

#![forbid(unsafe_code)]

pub mod angle_metrics;
pub mod autopilot;
pub mod beside;
pub mod campaign;
pub mod command;
pub mod emulated;
pub mod experiment;
pub mod flight;
pub mod inject;
pub mod integrate;
pub mod localization;
pub mod metrics;
pub mod outside;
pub mod parallel;
pub mod params_file;
pub mod pendulum;
pub mod pendulum_metrics;
pub mod pilot;
pub mod planar;
pub mod plant;
pub mod record;
pub mod report;
pub mod scenario;
pub mod sensor;
pub mod settings;
pub mod sysid;
pub mod taut_metrics;
pub mod tether_angle;
pub mod udp;
pub mod voice;
pub mod world;
