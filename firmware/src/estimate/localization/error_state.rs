//! Position, velocity, attitude, tension, thrust scale and sensor biases: a 17-state error-state filter.
//! `localization` section 7.
//!
//! The accelerometer drives the inertial navigation and is a measurement of the cable too; the
//! correlation of the two is kept.

use super::noise::ErrorStateNoise;
use crate::estimate::{Ekf4Measurement, Fault};
use crate::frames::{Attitude, Body, M3, V3, World};
use crate::math::kalman::Correction;
use crate::math::{GRAVITY, so3};
use crate::scalar::Scalar;
use nalgebra::{SMatrix, SVector};

/// Position, velocity, attitude, tension, thrust scale, accelerometer bias, gyro bias.
pub const STATES: usize = 17;
const POSITION: usize = 0;
const VELOCITY: usize = 3;
const ATTITUDE: usize = 6;
const TENSION: usize = 9;
const THRUST: usize = 10;
const ACCEL_BIAS: usize = 11;
const GYRO_BIAS: usize = 14;

type Covariance<S> = SMatrix<S, STATES, STATES>;
type Row<S> = SVector<S, STATES>;

/// Closer to the anchor than this, m, the cable has no direction worth using.
const DISTANCE_FLOOR: f64 = 0.3;

/// What it believes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorState<S: Scalar> {
    /// From the anchor, m.
    pub position: World<V3<S>>,
    /// m/s.
    pub velocity: World<V3<S>>,
    /// Body to world.
    pub attitude: Attitude<S>,
    /// N.
    pub tension: S,
    /// True over assumed thrust.
    pub thrust_scale: S,
    /// m/s².
    pub accel_bias: Body<V3<S>>,
    /// rad/s.
    pub gyro_bias: Body<V3<S>>,
    /// In the order of the states; the attitude's error is a rotation vector in body axes.
    pub covariance: Covariance<S>,
}

/// One set of readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorStateMeasurement<S: Scalar> {
    /// Attitude as measured elsewhere, specific force, thrust, altitude, length.
    pub cable: Ekf4Measurement<S>,
    /// rad/s.
    pub gyro: Body<V3<S>>,
}

/// The filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorStateFilter<S> {
    /// kg.
    pub mass: S,
    /// Period, s.
    pub dt: S,
    /// Deviations of sensors and states.
    pub noise: ErrorStateNoise<S>,
}

fn finite<S: Scalar>(v: &V3<S>) -> bool {
    v.iter().all(|x| x.is_finite())
}

fn row_at<S: Scalar>(blocks: &[(usize, V3<S>)]) -> Row<S> {
    let mut row = Row::zeros();
    for (at, v) in blocks {
        row.fixed_rows_mut::<3>(*at).copy_from(v);
    }
    row
}

impl<S: Scalar> ErrorState<S> {
    fn inject(&mut self, dx: &Row<S>) {
        let part = |at: usize| -> V3<S> { dx.fixed_rows::<3>(at).into_owned() };
        let one = |at: usize| dx.get(at).copied().unwrap_or(S::zero());
        self.position.0 += part(POSITION);
        self.velocity.0 += part(VELOCITY);
        self.attitude.0 *= so3::exp(&part(ATTITUDE));
        self.tension += one(TENSION);
        self.thrust_scale += one(THRUST);
        self.accel_bias.0 += part(ACCEL_BIAS);
        self.gyro_bias.0 += part(GYRO_BIAS);
    }

    /// One standard deviation of the state at `index`.
    #[must_use]
    pub fn deviation(&self, index: usize) -> S {
        self.covariance.get((index, index)).map_or(S::zero(), |v| v.sqrt())
    }

    fn is_finite(&self) -> bool {
        finite(&self.position.0)
            && finite(&self.velocity.0)
            && self.attitude.0.iter().all(|x| x.is_finite())
            && self.tension.is_finite()
            && self.covariance.iter().all(|x| x.is_finite())
    }
}

impl<S: Scalar> ErrorStateFilter<S> {
    /// Corrects by this sample, in the order altimeter, attitude, length, accelerometer; `state` is then
    /// the estimate at the sample. [`Self::predict`] carries it to the next one.
    ///
    /// Readings that are not finite are left out.
    ///
    /// # Errors
    /// [`Fault::NotFinite`] if the result is; the state is untouched.
    pub fn correct(
        &self,
        state: &mut ErrorState<S>,
        z: &ErrorStateMeasurement<S>,
    ) -> Result<ErrorStateStep<S>, Fault> {
        let mut next = *state;
        let z = &z.cable;
        let n = &self.noise;
        if let Some(altitude) = z.altitude.filter(|h| h.is_finite()) {
            let h = row_at(&[(POSITION, V3::new(S::zero(), S::zero(), -S::one()))]);
            let nu = altitude + next.position.0.z;
            update(&mut next, &[(h, nu)], n.altitude);
        }
        if z.attitude.0.iter().all(|x| x.is_finite()) {
            let off = so3::log(&(next.attitude.0.transpose() * z.attitude.0));
            let axis = |v: V3<S>, nu: S| (row_at(&[(ATTITUDE, v)]), nu);
            let rows = [axis(V3::x(), off.x), axis(V3::y(), off.y), axis(V3::z(), off.z)];
            update(&mut next, &rows, n.attitude);
        }
        let direction =
            |state: &ErrorState<S>| so3::direction(&state.position.0, S::lit(DISTANCE_FLOOR));
        if let (Some(length), Some((u, distance))) =
            (z.length.filter(|l| l.is_finite()), direction(&next))
        {
            update(&mut next, &[(row_at(&[(POSITION, u)]), length - distance)], n.length);
        }
        let mut step = ErrorStateStep { accel: None };
        if let (true, true, Some((u, distance))) =
            (finite(&z.accel.0), z.thrust.is_finite(), direction(&next))
        {
            step.accel = Some(self.accel_rows(&next, z, &u, distance));
            if let Some(rows) = &step.accel {
                update(&mut next, rows, n.accel);
            }
        }
        next.covariance = (next.covariance + next.covariance.transpose()) * S::lit(0.5);
        if !next.is_finite() {
            return Err(Fault::NotFinite);
        }
        *state = next;
        Ok(step)
    }

    fn accel_rows(
        &self,
        x: &ErrorState<S>,
        z: &Ekf4Measurement<S>,
        u: &V3<S>,
        distance: S,
    ) -> [(Row<S>, S); 3] {
        let r = &x.attitude.0;
        let ub = so3::transpose_mul(r, u);
        let pull = x.tension / self.mass;
        let lift = z.thrust / self.mass;
        let mut expected = x.accel_bias.0 - ub * pull;
        expected.z -= x.thrust_scale * lift;
        let nu = z.accel.0 - expected;
        let by_attitude = so3::skew(&ub) * -pull;
        let row = |axis: V3<S>, world_axis: V3<S>, by_thrust: S, nu: S| {
            let across = so3::reject(&world_axis, u) * (-pull / distance);
            let by_turn = so3::transpose_mul(&by_attitude, &axis);
            let mut h = row_at(&[(POSITION, across), (ATTITUDE, by_turn), (ACCEL_BIAS, axis)]);
            let by_tension = -so3::dot(&axis, &ub) / self.mass;
            for (at, derivative) in [(TENSION, by_tension), (THRUST, by_thrust)] {
                if let Some(x) = h.get_mut(at) {
                    *x = derivative;
                }
            }
            (h, nu)
        };
        let o = S::zero();
        [
            row(V3::x(), so3::col_x(r), o, nu.x),
            row(V3::y(), so3::col_y(r), o, nu.y),
            row(V3::z(), so3::col_z(r), -lift, nu.z),
        ]
    }

    /// Carries the estimate one period ahead with this sample's inertial readings; `step` is what
    /// [`Self::correct`] said of the same sample. Without a finite specific force the velocity is held;
    /// without a finite rate the attitude is.
    pub fn predict(
        &self,
        state: &mut ErrorState<S>,
        z: &ErrorStateMeasurement<S>,
        step: &ErrorStateStep<S>,
    ) {
        let (dt, n) = (self.dt, &self.noise);
        let accel = z.cable.accel.0;
        let rate = if finite(&z.gyro.0) { z.gyro.0 - state.gyro_bias.0 } else { V3::zeros() };
        let r = state.attitude.0;
        let up = V3::new(S::zero(), S::zero(), -S::lit(GRAVITY));
        // Without a reading the force that holds the velocity: minus gravity.
        let force =
            if finite(&accel) { accel - state.accel_bias.0 } else { so3::transpose_mul(&r, &up) };
        let to_velocity = r * -dt;
        let to_position = to_velocity * (dt * S::lit(0.5));
        let turned = so3::exp(&(rate * -dt));
        let mut f = Covariance::identity();
        f.fixed_view_mut::<3, 3>(POSITION, VELOCITY).copy_from(&M3::from_diagonal(&V3::repeat(dt)));
        f.fixed_view_mut::<3, 3>(VELOCITY, ATTITUDE).copy_from(&(to_velocity * so3::skew(&force)));
        f.fixed_view_mut::<3, 3>(VELOCITY, ACCEL_BIAS).copy_from(&to_velocity);
        f.fixed_view_mut::<3, 3>(ATTITUDE, ATTITUDE).copy_from(&turned);
        f.fixed_view_mut::<3, 3>(ATTITUDE, GYRO_BIAS)
            .copy_from(&M3::from_diagonal(&V3::repeat(-dt)));
        let world = r * force - up;
        state.position.0 += state.velocity.0 * dt + world * (dt * dt * S::lit(0.5));
        state.velocity.0 += world * dt;
        state.attitude.0 *= so3::exp(&(rate * dt));

        let before = state.covariance;
        let mut p = f * before * f.transpose();
        let mut g = SMatrix::<S, STATES, 3>::zeros();
        g.fixed_view_mut::<3, 3>(POSITION, 0).copy_from(&to_position);
        g.fixed_view_mut::<3, 3>(VELOCITY, 0).copy_from(&to_velocity);
        p += g * g.transpose() * (n.accel * n.accel);
        if let Some(rows) = &step.accel {
            // K R = P Hᵀ of the corrected covariance: the same noise acted in the correction.
            let mut ph = SMatrix::<S, STATES, 3>::zeros();
            for (mut column, (h, _)) in ph.column_iter_mut().zip(rows) {
                column.copy_from(&(before * h));
            }
            let cross = f * ph * g.transpose();
            p -= cross + cross.transpose();
        }
        let root = dt.sqrt();
        let growth = [
            (ATTITUDE, 3, n.gyro * dt),
            (TENSION, 1, n.tension_walk * root),
            (THRUST, 1, n.thrust_walk * root),
            (ACCEL_BIAS, 3, n.accel_bias_walk * root),
            (GYRO_BIAS, 3, n.gyro_bias_walk * root),
        ];
        for (at, count, deviation) in growth {
            for i in at..at + count {
                if let Some(x) = p.get_mut((i, i)) {
                    *x += deviation * deviation;
                }
            }
        }
        state.covariance = (p + p.transpose()) * S::lit(0.5);
        if let Some(clean) = so3::orthonormal(&state.attitude.0) {
            state.attitude.0 = clean;
        }
    }
}

/// What a correction leaves for the prediction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorStateStep<S: Scalar> {
    accel: Option<[(Row<S>, S); 3]>,
}

fn update<S: Scalar>(state: &mut ErrorState<S>, rows: &[(Row<S>, S)], deviation: S) {
    let mut covariance = state.covariance;
    let mut correction = Correction::new(&mut covariance);
    for (h, nu) in rows {
        correction.row(h, *nu, deviation * deviation);
    }
    let dx = correction.finish();
    state.covariance = covariance;
    state.inject(&dx);
}
