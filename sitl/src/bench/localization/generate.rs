//! Flies the circle with a controller on the true state, and records the sensors.

use super::plant::{CableVehicle, State, euler, position, rates, to_body, velocity};
use super::scenario::LocalizationScenario;
use crate::plant::{GRAVITY, V3, generator, normal, runge_kutta};
use nalgebra::Matrix3;

/// Sampling period, s, and plant steps in it.
pub const DT: f64 = 0.005;
const SUBSTEPS: u32 = 4;
/// Duration of the smooth start, s, and period of the rise and fall, s.
const RISE: f64 = 5.0;
const SWING_PERIOD: f64 = 25.0;
/// Position and attitude gains.
const GAINS: [f64; 2] = [6.0, 4.0];
const ATTITUDE_GAINS: [f64; 2] = [225.0, 24.0];

/// One sample: readings, and the truth beside them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// s.
    pub time: f64,
    /// Specific force in body axes, over g.
    pub accel: V3,
    /// rad/s.
    pub gyro: V3,
    /// m.
    pub altitude: f64,
    /// Roll, pitch, yaw, rad.
    pub euler: V3,
    /// Reported thrust, N.
    pub thrust: f64,
    /// Cable length, m.
    pub length: f64,
    /// True position, NED, m.
    pub truth: V3,
}

/// Position, velocity and acceleration of the reference path.
fn path(s: &LocalizationScenario, time: f64) -> [V3; 3] {
    // Differences of the closed form: exact enough for a feed-forward, and one formula.
    const H: f64 = 1e-4;
    let at = |t: f64| {
        let x = (t / RISE).clamp(0.0, 1.0);
        let smooth = x * x * x * (10.0 - 15.0 * x + 6.0 * x * x);
        let angle = s.speed / s.radius * t;
        let swing = s.swing * (std::f64::consts::TAU * t / SWING_PERIOD).sin();
        V3::new(s.radius * angle.cos(), s.radius * angle.sin(), -(s.altitude + swing)) * smooth
    };
    let (before, now, after) = (at(time - H), at(time), at(time + H));
    [now, (after - before) / (2.0 * H), (after - now * 2.0 + before) / (H * H)]
}

fn vee(m: &Matrix3<f64>) -> V3 {
    V3::new(m.m32 - m.m23, m.m13 - m.m31, m.m21 - m.m12) * 0.5
}

/// Thrust and torque.
fn control(vehicle: &CableVehicle, s: &LocalizationScenario, x: &State, time: f64) -> (f64, V3) {
    let [reference, speed, accel] = path(s, time);
    let place = position(x);
    let [kp, kd] = GAINS;
    let a = accel + (reference - place) * kp + (speed - velocity(x)) * kd;
    let gravity = V3::new(0.0, 0.0, GRAVITY);
    let force = (a - gravity) * vehicle.mass - vehicle.pull(&place);
    let z = -force.normalize();
    let y = z.cross(&V3::x()).normalize();
    let desired = Matrix3::from_columns(&[y.cross(&z), y, z]);
    let attitude = to_body(&euler(x)).transpose();
    let thrust = (-force.dot(&attitude.column(2))).max(0.0);
    let error = vee(&(desired.transpose() * attitude - attitude.transpose() * desired));
    let [kr, kw] = ATTITUDE_GAINS;
    let torque = vehicle.inertia.component_mul(&(error * -kr - rates(x) * kw));
    (thrust, torque)
}

/// The whole flight at 200 Hz.
///
/// # Errors
/// One line naming the setting.
pub fn generate(s: &LocalizationScenario, seed: u64) -> Result<Vec<Sample>, String> {
    s.check()?;
    let vehicle = CableVehicle {
        mass: s.mass,
        inertia: V3::new(2.24e-3, 2.98e-3, 4.8e-3),
        tension: s.tension,
    };
    let mut rng = generator(seed, 40);
    let mut x: State = [0.0; 12];
    let count = (s.duration / DT) as usize;
    let mut samples = Vec::with_capacity(count);
    for k in 0..count {
        let time = k as f64 * DT;
        let (thrust, torque) = control(&vehicle, s, &x, time);
        let mut noise = |sd: f64| V3::from_fn(|_, _| sd * normal(&mut rng));
        let place = position(&x);
        let accel =
            vehicle.specific_force(&x, thrust) + noise(s.accel_noise) + V3::repeat(s.accel_bias);
        let gyro = rates(&x) + noise(s.gyro_noise.to_radians());
        let angles = euler(&x) + noise(s.attitude_noise.to_radians());
        samples.push(Sample {
            time,
            accel,
            gyro,
            altitude: -place.z + s.altitude_noise * normal(&mut rng),
            euler: angles,
            thrust: thrust / (1.0 + s.thrust_error),
            length: place.norm() + s.length_noise * normal(&mut rng),
            truth: place,
        });
        for _ in 0..SUBSTEPS {
            x = runge_kutta(x, DT / f64::from(SUBSTEPS), |x| vehicle.rate(x, thrust, &torque));
        }
        if !x.iter().all(|v| v.is_finite()) {
            return Err(format!("the circle cannot be flown: lost at {time:.2} s"));
        }
    }
    Ok(samples)
}
