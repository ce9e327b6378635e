//! Vehicle, rod and load from Newton's law and the pull in the rod; `pendulum` section 2, equations of its
//! own. World NED, body FRD.

use crate::plant::runge_kutta;
use nalgebra::{Matrix3, Vector3};

type V3 = Vector3<f64>;

/// Load position and velocity, rod direction and rate, attitude row by row, body rates.
pub const STATES: usize = 24;

/// What does not move.
#[derive(Clone, Copy, Debug)]
pub struct PendulumPlant {
    /// kg.
    pub vehicle_mass: f64,
    /// kg.
    pub load_mass: f64,
    /// m.
    pub length: f64,
    /// m/s².
    pub gravity: f64,
    /// Time constant of the body rates, s; zero: they are as commanded.
    pub lag: f64,
    /// Linear drag of the vehicle, N s/m.
    pub drag: f64,
}

/// What acts during a step.
#[derive(Clone, Copy, Debug)]
pub struct PendulumAction {
    /// N.
    pub thrust: f64,
    /// Commanded, rad/s.
    pub rate: V3,
    /// On the vehicle, N.
    pub disturbance: V3,
}

/// A state, taken apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PendulumTruth {
    /// Of the load, m.
    pub position: V3,
    /// Of the load, m/s.
    pub velocity: V3,
    /// Vehicle → load.
    pub rod: V3,
    /// rad/s.
    pub rod_rate: V3,
    /// Body to world.
    pub attitude: Matrix3<f64>,
    /// Body, rad/s.
    pub rate: V3,
}

impl PendulumTruth {
    /// At rest and level.
    #[must_use]
    pub fn at_rest(position: V3, rod: V3) -> Self {
        let o = V3::zeros();
        Self {
            position,
            velocity: o,
            rod: rod.normalize(),
            rod_rate: o,
            attitude: Matrix3::identity(),
            rate: o,
        }
    }

    /// From an array in the order of [`STATES`].
    #[must_use]
    pub fn from_array(y: &[f64; STATES]) -> Self {
        let three = |at: usize| V3::new(y[at], y[at + 1], y[at + 2]);
        Self {
            position: three(0),
            velocity: three(3),
            rod: three(6),
            rod_rate: three(9),
            attitude: Matrix3::from_row_slice(&y[12..21]),
            rate: three(21),
        }
    }

    /// Into an array in the order of [`STATES`].
    #[must_use]
    pub fn to_array(&self) -> [f64; STATES] {
        let mut y = [0.0; STATES];
        let vectors = [self.position, self.velocity, self.rod, self.rod_rate];
        let rows = self.attitude.transpose();
        let all = vectors.iter().flatten().chain(rows.iter()).chain(self.rate.iter());
        y.iter_mut().zip(all).for_each(|(y, x)| *y = *x);
        y
    }

    /// Angle of the rod from upright, rad.
    #[must_use]
    pub fn rod_tilt(&self) -> f64 {
        (-self.rod.z).clamp(-1.0, 1.0).acos()
    }

    /// Velocity of the vehicle, m/s.
    #[must_use]
    pub fn vehicle_velocity(&self, length: f64) -> V3 {
        self.velocity - self.rod_rate.cross(&self.rod) * length
    }
}

impl PendulumPlant {
    /// `dt` s ahead.
    #[must_use]
    pub fn step(&self, x: &PendulumTruth, action: &PendulumAction, dt: f64) -> PendulumTruth {
        let mut start = *x;
        if self.lag <= 0.0 {
            start.rate = action.rate;
        }
        let y = runge_kutta(start.to_array(), dt, |y| {
            self.derivative(&PendulumTruth::from_array(y), action).to_array()
        });
        let mut next = PendulumTruth::from_array(&y);
        next.rod.normalize_mut();
        next.rod_rate -= next.rod * next.rod.dot(&next.rod_rate);
        let r = next.attitude;
        next.attitude = r * (Matrix3::identity() * 1.5 - r.transpose() * r * 0.5);
        next
    }

    fn derivative(&self, x: &PendulumTruth, action: &PendulumAction) -> PendulumTruth {
        let gravity = V3::z() * self.gravity;
        let drag = x.vehicle_velocity(self.length) * -self.drag;
        let force = x.attitude.column(2) * -action.thrust + action.disturbance + drag;
        // The rod pulls the load by `pull` along it, and the vehicle against it, so that both ends keep
        // their distance.
        let turning = self.length * x.rod_rate.norm_squared();
        let share = 1.0 / self.vehicle_mass + 1.0 / self.load_mass;
        let pull = (x.rod.dot(&force) / self.vehicle_mass - turning) / share;
        let load = x.rod * (pull / self.load_mass) + gravity;
        let vehicle = (force - x.rod * pull) / self.vehicle_mass + gravity;
        let rate = x.rate;
        PendulumTruth {
            position: x.velocity,
            velocity: load,
            rod: x.rod_rate.cross(&x.rod),
            rod_rate: x.rod.cross(&(load - vehicle)) / self.length,
            attitude: x.attitude * rate.cross_matrix(),
            rate: if self.lag > 0.0 { (action.rate - rate) / self.lag } else { V3::zeros() },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLANT: PendulumPlant = PendulumPlant {
        vehicle_mass: 0.3,
        load_mass: 0.05,
        length: 0.7,
        gravity: 9.81,
        lag: 0.0,
        drag: 0.0,
    };

    #[test]
    fn without_thrust_rod_and_vehicle_fall_together() {
        let mut x = PendulumTruth::at_rest(V3::zeros(), V3::new(0.3, 0.1, -1.0));
        let rod = x.rod;
        let action = PendulumAction { thrust: 0.0, rate: V3::zeros(), disturbance: V3::zeros() };
        for _ in 0..1000 {
            x = PLANT.step(&x, &action, 1e-3);
        }
        assert!((x.velocity - V3::z() * 9.81).norm() < 1e-9 && (x.rod - rod).norm() < 1e-9);
    }

    #[test]
    fn energy_is_kept_under_no_force_but_gravity() {
        let energy = |x: &PendulumTruth| {
            let vehicle = x.vehicle_velocity(0.7);
            let height = (x.position - x.rod * 0.7).z * 0.3 + x.position.z * 0.05;
            0.15 * vehicle.norm_squared() + 0.025 * x.velocity.norm_squared() - 9.81 * height
        };
        let mut x = PendulumTruth::at_rest(V3::zeros(), V3::new(0.3, 0.1, -1.0));
        x.rod_rate = x.rod.cross(&V3::new(2.0, -1.0, 0.5));
        let before = energy(&x);
        let action =
            PendulumAction { thrust: 0.0, rate: V3::new(1.0, 2.0, 3.0), disturbance: V3::zeros() };
        for _ in 0..500 {
            x = PLANT.step(&x, &action, 1e-3);
        }
        assert!((energy(&x) - before).abs() < 1e-8, "{}", energy(&x) - before);
    }
}
