//! Position and tension from IMU, altimeter, tether length and thrust: the 4-state filter of
//! `fullstate` section 10, after `localization` sections 3 and 4.
//!
//! State `(p, fc)`: position from the anchor, NED, m; tension in the line's middle, N. The position is a random walk; the
//! accelerometer, in units of g, measures thrust plus pull:
//! `h = -(fc/(m g)) Rᵀu - (T/(m g)) e3`, `u = p/|p|`. Wind looks like a pull: a steady 3 m/s moves
//! the estimate by about 1 m at 10 m and 5 N.

use super::Fault;
use crate::frames::{Attitude, Body, V3};
use crate::math::kalman::Correction;
use crate::math::{GRAVITY, so3};
use crate::model::Line;
use crate::scalar::Scalar;
use nalgebra::{Matrix4, Vector4};

/// Noise model. Variances per step for `q`, of a reading for `r`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ekf4<S> {
    /// Mass, kg.
    pub mass: S,
    /// Half of the line's weight hangs on the vehicle, and the accelerometer feels it.
    pub line: Line<S>,
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

/// Squared innovations over their variances; `None` where no finite reading came.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Innovations<S> {
    /// Mean of the axes.
    pub accel: Option<S>,
    /// Of the altitude.
    pub altitude: Option<S>,
    /// Of the length.
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
    /// At a known pull that the filter shall not change (with a tension noise of zero): the three-state
    /// filter, position alone.
    #[must_use]
    pub fn with_known_tension(position: V3<S>, variance: S, tension: S) -> Self {
        Self {
            x: Vector4::new(position.x, position.y, position.z, tension),
            covariance: Matrix4::from_diagonal(&Vector4::new(
                variance,
                variance,
                variance,
                S::zero(),
            )),
        }
    }
    /// Whether the estimate stands on its mirror image: position and pull both reversed give the same
    /// specific force. It is not clipped, because that would falsify the covariance; the altimeter
    /// brings it back.
    #[must_use]
    pub fn tension_is_negative(&self) -> bool {
        self.x.w < S::zero()
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

fn direction<S: Scalar>(position: V3<S>) -> (V3<S>, S) {
    let length = so3::norm(&position).max(S::lit(LENGTH_FLOOR));
    (position / length, length)
}

/// The accelerometer over g at a place, under a pull and a thrust, N; `weight` is m g, N.
#[must_use]
pub fn cable_reading<S: Scalar>(
    attitude: &Attitude<S>,
    position: V3<S>,
    tension: S,
    thrust: S,
    weight: S,
) -> V3<S> {
    let (u, _) = direction(position);
    let pull = so3::transpose_mul(&attitude.0, &u) * (-tension / weight);
    V3::new(pull.x, pull.y, pull.z - thrust / weight)
}

/// Its derivative by position and tension, a row for each body axis: the corrected (35).
#[must_use]
pub fn cable_jacobian<S: Scalar>(
    attitude: &Attitude<S>,
    position: V3<S>,
    tension: S,
    weight: S,
) -> [Vector4<S>; 3] {
    let (u, length) = direction(position);
    let stiffness = -tension / (weight * length);
    let r = &attitude.0;
    [so3::col_x(r), so3::col_y(r), so3::col_z(r)].map(|axis| {
        let across = so3::reject(&axis, &u) * stiffness;
        Vector4::new(across.x, across.y, across.z, -so3::dot(&axis, &u) / weight)
    })
}

impl<S: Scalar> Ekf4<S> {
    /// Prediction (random walk) and one vector update, all rows linearised at the same state. A row whose
    /// reading is not finite is left out.
    ///
    /// # Errors
    /// [`Fault::NotFinite`] if the result is; the state is untouched.
    pub fn step(
        &self,
        state: &mut Ekf4State<S>,
        z: &Ekf4Measurement<S>,
    ) -> Result<Innovations<S>, Fault> {
        let mut next = *state;
        let q = Vector4::new(self.q_position, self.q_position, self.q_position, self.q_tension);
        next.covariance += Matrix4::from_diagonal(&q);

        let p = state.position();
        let (u, length) = direction(p);
        let tension = state.tension();
        let weight = self.mass * S::lit(GRAVITY);
        // `fullstate` section 2: the weight of half the line, by the length.
        let down = so3::row_z(&z.attitude.0);
        let hanging = down * (self.line.half_weight(length) / weight);
        let reading = cable_reading(&z.attitude, p, tension, z.thrust, weight) + hanging;
        let nu = z.accel.0 / S::lit(GRAVITY) - reading;
        let by_length = self.line.half_weight(S::one()) / weight;

        let mut correction = Correction::new(&mut next.covariance);
        let mut row =
            |h: Vector4<S>, nu: S, r: S| nu.is_finite().then(|| correction.row(&h, nu, r));
        let (mut sum, mut count) = (S::zero(), S::zero());
        let jacobian = cable_jacobian(&z.attitude, p, tension, weight);
        let axes = jacobian.into_iter().zip([nu.x, nu.y, nu.z]).zip([down.x, down.y, down.z]);
        for ((mut h, nu), down) in axes {
            let more = u * (by_length * down);
            h += Vector4::new(more.x, more.y, more.z, S::zero());
            if let Some(nis) = row(h, nu, self.r_accel) {
                sum += nis;
                count += S::one();
            }
        }
        let accel = (count > S::zero()).then(|| sum / count);
        let o = S::zero();
        let altitude = z.altitude.and_then(|altitude| {
            row(Vector4::new(o, o, -S::one(), o), altitude + p.z, self.r_altitude)
        });
        let measured_length = z.length.and_then(|measured| {
            row(Vector4::new(u.x, u.y, u.z, o), measured - length, self.r_length)
        });
        let dx = correction.finish();
        next.x += dx;
        next.covariance = (next.covariance + next.covariance.transpose()) * S::lit(0.5);
        if !next.is_finite() {
            return Err(Fault::NotFinite);
        }
        *state = next;
        Ok(Innovations { accel, altitude, length: measured_length })
    }
}
