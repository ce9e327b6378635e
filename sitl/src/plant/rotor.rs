//! A rotor with its ESC and motor: first-order speed, thrust and drag torque by the square of speed.

use crate::scenario::VehicleSection;
use serde::{Deserialize, Serialize};

/// Where a rotor sits, in units of the arm, and the sense of its yaw torque.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Hub {
    /// Forward.
    pub x: f64,
    /// To the right.
    pub y: f64,
    /// +1 if its drag yaws the nose to the right, else -1.
    pub spin: f64,
}

const fn hub(x: f64, y: f64, spin: f64) -> Hub {
    Hub { x, y, spin }
}

/// Front right, rear left, front left, rear right.
const QUAD_X: [Hub; 4] =
    [hub(1.0, 1.0, 1.0), hub(-1.0, -1.0, 1.0), hub(1.0, -1.0, -1.0), hub(-1.0, 1.0, -1.0)];

/// As the scenario says, or a quad.
#[must_use]
pub fn hubs(vehicle: &VehicleSection) -> Vec<Hub> {
    if vehicle.rotors.is_empty() { QUAD_X.to_vec() } else { vehicle.rotors.clone() }
}

/// All rotors alike.
#[derive(Clone, Debug)]
pub struct RotorModel {
    /// In the order of the motor outputs.
    pub hubs: Vec<Hub>,
    /// Distance of each hub from the centre of mass along x and along y, m.
    pub arm: f64,
    /// N/(rad/s)².
    pub thrust_coefficient: f64,
    /// Drag torque per thrust, m.
    pub torque_ratio: f64,
    /// Speed at full throttle and nominal voltage, rad/s.
    pub speed_max: f64,
    /// V.
    pub nominal_voltage: f64,
    /// Speed over its maximum = throttle to this power.
    pub curve: f64,
    /// Time constant of the speed, s.
    pub time_constant: f64,
    /// Thrust gain error of all rotors together, drawn uniformly within ±.
    pub common_gain_error: f64,
    /// Of each rotor alone.
    pub gain_error: f64,
    /// Mechanical over electrical power.
    pub efficiency: f64,
}

impl RotorModel {
    /// Of the way to its target that the speed moves in `dt` s.
    #[must_use]
    pub fn share(&self, dt: f64) -> f64 {
        (dt / self.time_constant).min(1.0)
    }

    /// As the scenario describes them.
    #[must_use]
    pub fn new(vehicle: &VehicleSection) -> Self {
        Self {
            hubs: hubs(vehicle),
            arm: vehicle.arm,
            thrust_coefficient: vehicle.thrust_coefficient,
            torque_ratio: vehicle.torque_ratio,
            speed_max: vehicle.rotor_speed_max,
            nominal_voltage: vehicle.nominal_voltage,
            curve: vehicle.throttle_curve,
            time_constant: vehicle.rotor_time_constant,
            common_gain_error: vehicle.common_thrust_error,
            gain_error: vehicle.rotor_thrust_error,
            efficiency: 0.65,
        }
    }
}

/// A power; two square roots cost a tenth of the general one, and most scenarios keep the default curve.
#[expect(clippy::float_cmp, reason = "a number as it stands in the scenario")]
fn power(x: f64, exponent: f64) -> f64 {
    if exponent == 0.75 { x.sqrt() * x.sqrt().sqrt() } else { x.powf(exponent) }
}

/// State.
#[derive(Clone, Debug)]
pub struct Rotor {
    /// rad/s.
    pub speed: f64,
    /// Of the thrust, that is there: a fault.
    pub strength: f64,
    target: f64,
    gain: f64,
}

impl Rotor {
    /// Standing still; `gain` scales its thrust.
    #[must_use]
    pub fn new(gain: f64) -> Self {
        Self { speed: 0.0, strength: 1.0, target: 0.0, gain }
    }

    /// Where the speed goes, rad/s, and thrust per its square, N/(rad/s)².
    #[inline]
    pub(super) fn drive(&self, model: &RotorModel) -> (f64, f64) {
        (self.target, self.strength * self.gain * model.thrust_coefficient)
    }

    /// Takes a throttle at this voltage; it holds until the next.
    pub fn command(&mut self, model: &RotorModel, throttle: f64, voltage: f64) {
        let top = model.speed_max * voltage / model.nominal_voltage;
        self.target = top * power(throttle.clamp(0.0, 1.0), model.curve);
    }

    /// Thrust, N, after the speed has moved by a share of its way: [`RotorModel::share`].
    #[inline]
    pub fn step(&mut self, model: &RotorModel, share: f64) -> f64 {
        self.speed += (self.target - self.speed) * share;
        self.thrust(model)
    }

    /// N.
    #[must_use]
    pub fn thrust(&self, model: &RotorModel) -> f64 {
        self.strength * self.gain * model.thrust_coefficient * self.speed * self.speed
    }

    /// Electrical, W.
    #[must_use]
    pub fn power(&self, model: &RotorModel) -> f64 {
        self.thrust(model) * model.torque_ratio * self.speed / model.efficiency
    }
}
