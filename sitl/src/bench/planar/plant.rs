//! Vehicle and link as two rigid bodies with two degrees of freedom, `planar` section 2.1: the link has
//! mass and is attached beside the centre of mass, the motors lag. Lagrange's equations, Runge-Kutta.

use crate::plant::runge_kutta;
use nalgebra::{Matrix2, Vector2};
use serde::{Deserialize, Serialize};

/// What is simulated; `[plant]` of a planar scenario. The default is the journal's.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct PlanarPlantModel {
    /// Vehicle, kg.
    pub mass: f64,
    /// Vehicle about its centre of mass, kg m².
    pub inertia: f64,
    /// Link, m.
    pub length: f64,
    /// Uniform link, kg.
    pub link_mass: f64,
    /// Attachment from the centre of mass, body axes x and z (z opposite to the thrust), m.
    pub attachment: [f64; 2],
    /// Time constant of thrust and torque, s; zero: they act at once.
    pub motor_lag: f64,
    /// m/s².
    pub gravity: f64,
}

impl Default for PlanarPlantModel {
    fn default() -> Self {
        Self {
            mass: 1.0,
            inertia: 0.25,
            length: 2.0,
            link_mass: 0.0,
            attachment: [0.0, 0.0],
            motor_lag: 0.0,
            gravity: crate::plant::GRAVITY,
        }
    }
}

/// State: link angle, its rate, pitch, its rate, acting thrust and torque.
#[derive(Clone, Debug)]
pub struct PlanarPlant {
    /// Description.
    pub model: PlanarPlantModel,
    /// `[φ, φ', θ, θ']`.
    pub state: [f64; 4],
    /// Acting thrust, N, and torque, N m.
    pub acting: [f64; 2],
}

/// What the plant shows.
#[derive(Clone, Copy, Debug)]
pub struct Readings {
    /// Accelerometer at the centre of mass, x and z, m/s².
    pub accel: [f64; 2],
    /// Gyro, rad/s.
    pub rate: f64,
    /// Along the link, tension positive, N.
    pub link_force: f64,
    /// Of the link on the vehicle, across it, N.
    pub transverse_force: f64,
    /// φ'' and θ'', rad/s².
    pub angular_accel: [f64; 2],
}

impl PlanarPlant {
    /// In this state with this thrust acting, N.
    #[must_use]
    pub fn new(model: PlanarPlantModel, state: [f64; 4], thrust: f64) -> Self {
        Self { model, state, acting: [thrust, 0.0] }
    }

    /// Holds a thrust, N, and a torque, N m, for `dt` s.
    pub fn step(&mut self, thrust: f64, torque: f64, dt: f64, substeps: u32) {
        let lag = self.model.motor_lag;
        if lag <= 0.0 {
            self.acting = [thrust, torque];
        }
        let h = dt / f64::from(substeps);
        let rate = |y: &[f64; 6]| {
            let [phi, phi1, theta, theta1, u1, u2] = *y;
            let [a, b] = accelerations(&self.model, &[phi, phi1, theta, theta1], u1, u2);
            let (d1, d2) =
                if lag > 0.0 { ((thrust - u1) / lag, (torque - u2) / lag) } else { (0.0, 0.0) };
            [phi1, a, theta1, b, d1, d2]
        };
        let ([phi, phi1, theta, theta1], [u1, u2]) = (self.state, self.acting);
        let mut y = [phi, phi1, theta, theta1, u1, u2];
        for _ in 0..substeps {
            y = runge_kutta(y, h, rate);
        }
        let [phi, phi1, theta, theta1, u1, u2] = y;
        self.state = [phi, phi1, theta, theta1];
        self.acting = [u1, u2];
    }

    /// Sensors and forces now.
    #[must_use]
    pub fn readings(&self) -> Readings {
        readings(&self.model, &self.state, self.acting[0], self.acting[1])
    }

    /// Not finite, or beyond any flight.
    #[must_use]
    pub fn has_diverged(&self) -> bool {
        let [_, phi1, _, theta1] = self.state;
        !self.state.iter().all(|x| x.is_finite()) || phi1.abs() > 200.0 || theta1.abs() > 1e4
    }
}

/// φ'' and θ'' of the two coupled bodies.
fn accelerations(m: &PlanarPlantModel, x: &[f64; 4], u1: f64, u2: f64) -> [f64; 2] {
    let [phi, phi1, theta, theta1] = *x;
    let [rx, rz] = m.attachment;
    let (s, c) = (phi + theta).sin_cos();
    let (along, across) = (rx * c + rz * s, rx * s - rz * c);
    let coupling = -m.mass * m.length * along;
    let swing = m.mass * m.length * across;
    let inertia = Matrix2::new(
        (m.mass + m.link_mass / 3.0) * m.length * m.length,
        coupling,
        coupling,
        m.inertia + m.mass * (rx * rx + rz * rz),
    );
    let weight = (m.mass + 0.5 * m.link_mass) * m.length * m.gravity * phi.cos();
    let lever = m.mass * m.gravity * (rx * theta.cos() + rz * theta.sin());
    let force = Vector2::new(
        u1 * m.length * c - swing * theta1 * theta1 - weight,
        u2 - rx * u1 - swing * phi1 * phi1 + lever,
    );
    // Positive definite for any positive masses.
    let out = inertia.try_inverse().map_or(Vector2::zeros(), |inverse| inverse * force);
    [out.x, out.y]
}

fn readings(m: &PlanarPlantModel, x: &[f64; 4], u1: f64, u2: f64) -> Readings {
    let [phi, phi1, theta, theta1] = *x;
    let [a, b] = accelerations(m, x, u1, u2);
    let (sp, cp) = phi.sin_cos();
    let (st, ct) = theta.sin_cos();
    let (d, across) = (Vector2::new(cp, sp), Vector2::new(-sp, cp));
    let (xb, zb) = (Vector2::new(-ct, st), Vector2::new(-st, -ct));
    let [rx, rz] = m.attachment;
    let arm = xb * rx + zb * rz;
    let arm_slope = Vector2::new(rx * st - rz * ct, rx * ct + rz * st);
    let accel = across * (m.length * a) - d * (m.length * phi1 * phi1) - arm_slope * b
        + arm * (theta1 * theta1);
    let specific = accel + Vector2::new(0.0, m.gravity);
    let force = specific * m.mass + zb * u1;
    Readings {
        accel: [specific.dot(&xb), specific.dot(&zb)],
        rate: theta1,
        link_force: -force.dot(&d),
        transverse_force: force.dot(&across),
        angular_accel: [a, b],
    }
}
