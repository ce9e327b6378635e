//! Position and tension from IMU, altimeter, tether length and thrust: the 4-state filter of
//! `fullstate` section 10, after `localization` sections 3 and 4.
//!
//! State `(p, fc)`: position from the anchor, NED, m; tension, N. The position is a random walk; the
//! accelerometer, in units of g, measures thrust plus pull:
//! `h = -(fc/(m g)) Rᵀu - (T/(m g)) e3`, `u = p/|p|`. Wind looks like a pull: a steady 3 m/s moves
//! the estimate by about 1 m at 10 m and 5 N.

use super::Fault;
use crate::frames::{Attitude, Body, V3};
use crate::math::kalman::Correction;
use crate::math::{GRAVITY, so3};
use crate::scalar::Scalar;
use nalgebra::{Matrix4, Vector4};

/// Noise model. Variances per step for `q`, of a reading for `r`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ekf4<S> {
    /// Mass, kg.
    pub mass: S,
    /// m² per step, each coordinate.
    pub q_position: S,
    /// N² per step.
    pub q_tension: S,
    /// Specific force over g.
    pub r_accel: S,
    /// m².
    pub r_altitude: S,
    /// m².
    pub r_length: S,
}

/// Estimate and covariance, order `p_n, p_e, p_d, fc`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ekf4State<S: Scalar> {
    /// m and N.
    pub x: Vector4<S>,
    /// Symmetric.
    pub covariance: Matrix4<S>,
}

/// One set of readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ekf4Measurement<S: Scalar> {
    /// Body to world.
    pub attitude: Attitude<S>,
    /// Specific force, m/s².
    pub accel: Body<V3<S>>,
    /// Total thrust along the body's up axis, N.
    pub thrust: S,
    /// Height over the anchor, m.
    pub altitude: Option<S>,
    /// Distance from the anchor, m.
    pub length: Option<S>,
}

/// Squared innovations over their variances.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Innovations<S> {
    /// Mean of three axes.
    pub accel: S,
    /// If there was an altitude.
    pub altitude: Option<S>,
    /// If there was a length.
    pub length: Option<S>,
}

/// Shortest tether that has a direction, m.
const LENGTH_FLOOR: f64 = 1e-3;

impl<S: Scalar> Ekf4State<S> {
    /// At a known place with a known pull, 0.3 m and 1 N uncertain.
    #[must_use]
    pub fn at(position: V3<S>, tension: S) -> Self {
        let p = S::lit(0.09);
        Self {
            x: Vector4::new(position.x, position.y, position.z, tension),
            covariance: Matrix4::from_diagonal(&Vector4::new(p, p, p, S::one())),
        }
    }
    /// From the anchor, NED, m.
    #[must_use]
    pub fn position(&self) -> V3<S> {
        V3::new(self.x.x, self.x.y, self.x.z)
    }
    /// N.
    #[must_use]
    pub fn tension(&self) -> S {
        self.x.w
    }
    fn is_finite(&self) -> bool {
        let c = &self.covariance;
        [self.x.x, self.x.y, self.x.z, self.x.w, c.m11, c.m22, c.m33, c.m44]
            .iter()
            .all(|v| v.is_finite())
    }
}

impl<S: Scalar> Ekf4<S> {
    /// Prediction (random walk) and one vector update, all rows linearised at the same state.
    ///
    /// # Errors
    /// [`Fault::NotFinite`] if a reading or the result is; the state is untouched.
    pub fn step(
        &self,
        state: &mut Ekf4State<S>,
        z: &Ekf4Measurement<S>,
    ) -> Result<Innovations<S>, Fault> {
        let mut next = *state;
        let q = Vector4::new(self.q_position, self.q_position, self.q_position, self.q_tension);
        next.covariance += Matrix4::from_diagonal(&q);

        let p = state.position();
        let length = so3::norm(&p).max(S::lit(LENGTH_FLOOR));
        let u = p / length;
        let tension = state.tension();
        let weight = self.mass * S::lit(GRAVITY);
        let r = &z.attitude.0;
        let pull = so3::transpose_mul(r, &u) * (-tension / weight);
        let predicted = V3::new(pull.x, pull.y, pull.z - z.thrust / weight);
        let nu = z.accel.0 / S::lit(GRAVITY) - predicted;

        let mut correction = Correction::new(&mut next.covariance);
        let stiffness = -tension / (weight * length);
        let mut accel_row = |axis: V3<S>, nu: S| {
            let across = so3::reject(&axis, &u) * stiffness;
            let along = -so3::dot(&axis, &u) / weight;
            correction.row(&Vector4::new(across.x, across.y, across.z, along), nu, self.r_accel)
        };
        let accel = accel_row(so3::col_x(r), nu.x)
            + accel_row(so3::col_y(r), nu.y)
            + accel_row(so3::col_z(r), nu.z);
        let o = S::zero();
        let altitude = z.altitude.map(|altitude| {
            correction.row(&Vector4::new(o, o, -S::one(), o), altitude + p.z, self.r_altitude)
        });
        let measured_length = z.length.map(|measured| {
            correction.row(&Vector4::new(u.x, u.y, u.z, o), measured - length, self.r_length)
        });
        let dx = correction.finish();
        next.x += dx;
        next.covariance = (next.covariance + next.covariance.transpose()) * S::lit(0.5);
        if !next.is_finite() {
            return Err(Fault::NotFinite);
        }
        *state = next;
        Ok(Innovations { accel: accel * S::lit(1.0 / 3.0), altitude, length: measured_length })
    }
}
