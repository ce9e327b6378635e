//! Motion across the plane: four states, one scalar measurement. `flight` section 3.
//!
//! `[a, b, r, β]`: azimuth of the vehicle minus heading, rad; its absolute rate, rad/s; roll, rad; bias of
//! the roll gyro, rad/s.

use crate::frames::{Body, V3};
use crate::math::kalman::Correction;
use crate::model::PlanarState;
use crate::param::Params;
use crate::scalar::Scalar;
use crate::time::OUTER_DT;
use nalgebra::{Matrix4, Vector4};

/// Process noise per second of each state.
const PROCESS: [f64; 4] = [1e-6, 2.5e-3, 3e-6, 1e-9];
/// Initial variance of angles and rate, and of the bias (0.02 °/s): small, or the start upsets the loop.
const START: [f64; 4] = [1e-3, 1e-3, 1e-3, 1.2e-7];
/// Variance of one accelerometer sample, (m/s²)², as a density over its 178 Hz of noise bandwidth, and
/// what drag and bias add.
const ACCEL_VARIANCE: f64 = 0.25;
const ACCEL_BANDWIDTH: f64 = 178.0;
const MODEL_VARIANCE: f64 = 0.02;
/// All variances are kept this many times as large, or fixed point had no bits for them. A power of two: floats
/// compute the same to the last bit.
const SCALE: f64 = 16_384.0;
/// Shortest horizontal distance from the anchor's vertical, m.
const REACH_MIN: f64 = 0.3;

/// Configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutOfPlaneFilter<S> {
    variance: S,
}

/// What moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutOfPlaneState<S: Scalar> {
    pub(crate) x: Vector4<S>,
    pub(crate) covariance: Matrix4<S>,
}

/// What one step reads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutOfPlaneInput<S: Scalar> {
    /// rad/s.
    pub gyro: Body<V3<S>>,
    /// Specific force to the right, m/s².
    pub across: S,
    /// Thrust over mass, m/s².
    pub thrust: S,
    /// Link force over mass, m/s², positive in tension.
    pub force: S,
    /// In the plane.
    pub planar: PlanarState<S>,
    /// m.
    pub length: S,
}

impl<S: Scalar> OutOfPlaneFilter<S> {
    /// From the parameters.
    #[must_use]
    pub fn new(p: &Params) -> Self {
        let scale = f64::from(p.taut_out_of_plane_noise);
        let white = scale * scale * ACCEL_VARIANCE / (ACCEL_BANDWIDTH * OUTER_DT);
        Self { variance: S::lit(SCALE * (white + MODEL_VARIANCE)) }
    }

    /// From azimuth minus heading and roll, rad.
    #[must_use]
    pub fn start(&self, azimuth: S, roll: S) -> OutOfPlaneState<S> {
        let [a, b, r, bias] = START.map(|p| S::lit(SCALE * p));
        OutOfPlaneState {
            x: Vector4::new(azimuth, S::zero(), roll, S::zero()),
            covariance: Matrix4::from_diagonal(&Vector4::new(a, b, r, bias)),
        }
    }

    /// Predicts, corrects with the specific force across it. What is not finite leaves the state alone.
    pub fn step(&self, state: &mut OutOfPlaneState<S>, input: &OutOfPlaneInput<S>) {
        let dt = S::lit(OUTER_DT);
        let (o, one) = (S::zero(), S::one());
        let planar = &input.planar;
        let (sin_phi, cos_phi) = planar.elevation.sin_cos();
        let (sin_theta, cos_theta) = planar.pitch.sin_cos();
        let (sin_z, _) = (planar.elevation + planar.pitch).sin_cos();
        let reach = (input.length * cos_phi).max(S::lit(REACH_MIN));
        let closing = -input.length * sin_phi * planar.elevation_rate / reach;
        let x = &state.x;
        let (a, b, r, bias) = (x.x, x.y, x.z, x.w);
        let gyro = &input.gyro.0;
        let turn = gyro.z / cos_theta.max(S::lit(0.2));
        let (sin_r, cos_r) = r.sin_cos();
        let push = input.thrust / reach;
        let damping = S::lit(2.0) * closing;
        let next = Vector4::new(
            a + dt * (b - turn),
            b + dt * (push * (sin_r - sin_theta * a) - damping * b),
            r + dt * (gyro.x - bias - sin_theta * turn),
            bias,
        );
        let transition = Matrix4::new(
            one,
            dt,
            o,
            o,
            -dt * push * sin_theta,
            one - dt * damping,
            dt * push * cos_r,
            o,
            o,
            o,
            one,
            -dt,
            o,
            o,
            o,
            one,
        );
        let [qa, qb, qr, q_bias] = PROCESS.map(|q| S::lit(SCALE * q * OUTER_DT));
        let mut covariance = transition * state.covariance * transition.transpose()
            + Matrix4::from_diagonal(&Vector4::new(qa, qb, qr, q_bias));
        let row = Vector4::new(-input.force * cos_phi, o, input.force * sin_z, o);
        let innovation = input.across - row.dot(&next);
        let mut correction = Correction::new(&mut covariance);
        correction.row(&row, innovation, self.variance);
        let x = next + correction.finish();
        // The plane is unstable in compression: an asymmetry that rounding leaves would grow with it.
        let covariance = (covariance + covariance.transpose()) * S::lit(0.5);
        if x.iter().chain(covariance.iter()).all(|v| v.is_finite()) {
            *state = OutOfPlaneState { x, covariance };
        }
    }
}

impl<S: Scalar> OutOfPlaneState<S> {
    /// Symmetric, in the order of the states, 16,384 times as large.
    #[must_use]
    pub fn covariance(&self) -> &Matrix4<S> {
        &self.covariance
    }
    /// Azimuth of the vehicle minus heading, rad.
    #[must_use]
    pub fn azimuth(&self) -> S {
        self.x.x
    }
    /// Rate of the vehicle's azimuth, rad/s.
    #[must_use]
    pub fn azimuth_rate(&self) -> S {
        self.x.y
    }
    /// rad.
    #[must_use]
    pub fn roll(&self) -> S {
        self.x.z
    }
    /// Of the roll gyro, rad/s.
    #[must_use]
    pub fn roll_bias(&self) -> S {
        self.x.w
    }
}
