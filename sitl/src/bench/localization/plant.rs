//! A quadrotor on a constant-tension cable, rigid body in Euler angles. `localization` section 2;
//! equations of its own. World NED, body FRD.

use crate::plant::{GRAVITY, V3};
use nalgebra::Matrix3;

/// Position NED, velocity in body axes, roll, pitch, yaw, body rates.
pub type State = [f64; 12];

/// What does not move.
#[derive(Clone, Copy, Debug)]
pub struct CableVehicle {
    /// kg.
    pub mass: f64,
    /// kg m².
    pub inertia: V3,
    /// Cable tension, N.
    pub tension: f64,
}

/// Closer to the station the pull fades, m.
const FADE: f64 = 0.05;

fn vector(x: &State, at: usize) -> V3 {
    V3::from_fn(|i, _| x.get(at + i).copied().unwrap_or(0.0))
}

/// Position, NED, m.
#[must_use]
pub fn position(x: &State) -> V3 {
    vector(x, 0)
}

/// Roll, pitch, yaw, rad.
#[must_use]
pub fn euler(x: &State) -> V3 {
    vector(x, 6)
}

/// Body rates, rad/s.
#[must_use]
pub fn rates(x: &State) -> V3 {
    vector(x, 9)
}

/// NED to body.
#[must_use]
pub fn to_body(euler: &V3) -> Matrix3<f64> {
    let ((sr, cr), (sp, cp), (sy, cy)) = (euler.x.sin_cos(), euler.y.sin_cos(), euler.z.sin_cos());
    let roll = Matrix3::new(1.0, 0.0, 0.0, 0.0, cr, sr, 0.0, -sr, cr);
    let pitch = Matrix3::new(cp, 0.0, -sp, 0.0, 1.0, 0.0, sp, 0.0, cp);
    let yaw = Matrix3::new(cy, sy, 0.0, -sy, cy, 0.0, 0.0, 0.0, 1.0);
    roll * pitch * yaw
}

/// Velocity, NED, m/s.
#[must_use]
pub fn velocity(x: &State) -> V3 {
    to_body(&euler(x)).transpose() * vector(x, 3)
}

impl CableVehicle {
    /// Pull of the cable, NED, N.
    #[must_use]
    pub fn pull(&self, position: &V3) -> V3 {
        -position * (self.tension / position.norm().max(FADE))
    }

    /// Specific force in body axes, over g.
    #[must_use]
    pub fn specific_force(&self, x: &State, thrust: f64) -> V3 {
        let pull = to_body(&euler(x)) * self.pull(&position(x));
        (pull + V3::new(0.0, 0.0, -thrust)) / (self.mass * GRAVITY)
    }

    /// Time derivative under thrust, N, and torque, N m.
    #[must_use]
    pub fn rate(&self, x: &State, thrust: f64, torque: &V3) -> State {
        let (uvw, angles, omega) = (vector(x, 3), euler(x), rates(x));
        let r = to_body(&angles);
        let weight = V3::new(0.0, 0.0, self.mass * GRAVITY);
        let force = r * (self.pull(&position(x)) + weight) + V3::new(0.0, 0.0, -thrust);
        let moving = r.transpose() * uvw;
        let accel = uvw.cross(&omega) + force / self.mass;
        let ((sr, cr), (tp, cp)) = (angles.x.sin_cos(), (angles.y.tan(), angles.y.cos()));
        let turning = V3::new(
            omega.x + (omega.y * sr + omega.z * cr) * tp,
            omega.y * cr - omega.z * sr,
            (omega.y * sr + omega.z * cr) / cp,
        );
        let j = &self.inertia;
        let spin = (torque - omega.cross(&j.component_mul(&omega))).component_div(j);
        let parts = [moving, accel, turning, spin];
        let mut rate = [0.0; 12];
        for (x, v) in rate.iter_mut().zip(parts.iter().flat_map(V3::iter)) {
            *x = *v;
        }
        rate
    }
}
