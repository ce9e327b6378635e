//! Mathematics shared by the stages.

pub mod filter;
pub mod history;
pub mod kalman;
mod poles;
pub mod remainder;
pub mod root;
pub mod so3;

pub use poles::gains_from_poles;

use crate::scalar::Scalar;

/// Standard gravity as the specifications use it, m/s².
pub const GRAVITY: f64 = 9.81;

/// Wraps an angle to (-pi, pi].
#[must_use]
pub fn wrap_pi<S: Scalar>(angle: S) -> S {
    let (s, c) = angle.sin_cos();
    s.atan2(c)
}
pub mod trig;
