//! Where are we, how do we sit, and how hard does the tether pull?
//!
//! Measurements: IMU, altimeter, tether length, and the thrust that was commanded. No GPS, no
//! magnetometer. [`crate::navigation`] joins the blocks; each block is usable alone.
//!
//! **Why the accelerometer still shows "down" on a taut tether.** It measures the sum of all forces
//! but gravity, over the mass. A vehicle at rest on a tether is in balance: thrust, pull and drag
//! together cancel its weight, whatever their shares, so the specific force is exactly -g along the
//! vertical, however tilted the vehicle hangs in its harness of forces. In motion it also shows the
//! acceleration of the vehicle; on a tether that acceleration is bounded by the sphere and averages
//! out over a swing, so the attitude filter follows it only slowly ([`Mahony`], about 5 s) and not at
//! all when the total is far from g.
//!
//! **Yaw** is the integrated gyro. Nothing observes it: it drifts with the residual bias, about
//! 0.1° per 10 s for 0.01 °/s. Azimuth is measured against the heading at start-up and drifts along.

pub mod capture;
mod ekf4;
pub mod full_state;
pub mod high_gain;
pub mod localization;
mod mahony;
pub mod pendulum;
mod start_up;
pub mod taut;
pub mod tether_angle;
mod thrust_model;
mod thrust_scale;
mod velocity;
mod vertical;
mod witness;

pub use crate::fault::Fault;
pub use ekf4::{Ekf4, Ekf4Measurement, Ekf4State, Innovations, cable_jacobian, cable_reading};
pub use mahony::{Mahony, MahonyState};
pub use start_up::{LevelState, Leveller};
pub use thrust_model::{ThrustModel, ThrustModelState};
pub use thrust_scale::{Calibrated, ThrustCalibration, ThrustCalibrationState};
pub use velocity::{VelocityFilter, VelocityState};
pub use vertical::{VerticalFilter, VerticalState};
pub use witness::Witness;
