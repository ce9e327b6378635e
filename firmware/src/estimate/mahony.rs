//! Attitude from gyro and accelerometer, `fullstate` section 10 (complementary filter on SO(3)).

use super::Fault;
use crate::frames::{Attitude, Body, V3};
use crate::math::remainder::{FINE, Remainder};
use crate::math::{GRAVITY, so3};
use crate::scalar::Scalar;

/// Gains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mahony<S> {
    /// Pull towards the accelerometer's vertical, rad/s per unit of sin(error).
    pub kp: S,
    /// Gyro bias gain, rad/s².
    pub ki: S,
}

/// Attitude and gyro bias.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MahonyState<S: Scalar> {
    /// Body to world.
    pub attitude: Attitude<S>,
    /// rad/s.
    pub gyro_bias: Body<V3<S>>,
    /// Of the attitude's turn, rad, and of the bias, rad/s.
    rest: [Remainder<S>; 2],
}

impl<S: Scalar> MahonyState<S> {
    /// From body to world, and rad/s.
    #[must_use]
    pub fn new(attitude: Attitude<S>, gyro_bias: Body<V3<S>>) -> Self {
        Self { attitude, gyro_bias, rest: Default::default() }
    }
}

impl<S: Scalar> Mahony<S> {
    /// One step over `dt` s: `e = (-f/|f|) × Rᵀe3` where .5 g < |f| < 1.5 g, else 0;
    /// `b -= ki e dt`; `R <- orth(R exp((gyro - b + kp e) dt))`.
    ///
    /// # Errors
    /// [`Fault::NotFinite`], [`Fault::Degenerate`]; the state is untouched.
    pub fn step(
        &self,
        state: &mut MahonyState<S>,
        gyro: &Body<V3<S>>,
        accel: &Body<V3<S>>,
        dt: S,
    ) -> Result<(), Fault> {
        let finite = |v: &V3<S>| v.x.is_finite() && v.y.is_finite() && v.z.is_finite();
        if !finite(&gyro.0) || !finite(&accel.0) {
            return Err(Fault::NotFinite);
        }
        let r = &state.attitude.0;
        let e = match so3::direction(&accel.0, S::lit(0.5 * GRAVITY)) {
            Some((f, size)) if size < S::lit(1.5 * GRAVITY) => {
                so3::cross(&-f, &V3::new(r.m31, r.m32, r.m33))
            }
            _ => V3::zeros(),
        };
        let mut rest = state.rest;
        let [turned, learnt] = &mut rest;
        let fine = dt * S::lit(FINE);
        let bias = state.gyro_bias.0 - learnt.take(e * (self.ki * fine));
        let turn = turned.take((gyro.0 - bias + e * self.kp) * fine);
        let attitude = so3::orthonormal(&(r * so3::exp(&turn))).ok_or(Fault::Degenerate)?;
        *state = MahonyState { attitude: Attitude(attitude), gyro_bias: Body(bias), rest };
        Ok(())
    }
}
