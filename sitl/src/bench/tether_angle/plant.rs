//! A point mass on a tether that pulls and never pushes, in a vertical plane, with the attitude loop
//! (20). `inertial` sections 2 and 7; equations of its own.

use crate::plant::{GRAVITY, runge_kutta};

/// Natural frequency, rad/s, and damping of the tilt-rate loop.
pub const RATE_LOOP: [f64; 2] = [78.5, 0.4];

/// What does not move.
#[derive(Clone, Copy, Debug)]
pub struct PlaneModel {
    /// m.
    pub length: f64,
    /// Thrust over mass, m/s².
    pub thrust: f64,
    /// Attachment below the centre of mass, m.
    pub attachment: f64,
    /// Mass over moment of inertia, 1/m².
    pub mass_over_inertia: f64,
}

/// Where the vehicle is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// Tether angle from straight up, rad, and its rate, rad/s.
    Taut([f64; 2]),
    /// Relative to the anchor: x, z up, m; their rates, m/s.
    Slack([f64; 4]),
}

/// State.
#[derive(Clone, Copy, Debug)]
pub struct Plane {
    /// Of the mass.
    pub motion: Motion,
    /// Tilt, rad; its rate, rad/s; the loop's angular acceleration, rad/s².
    pub attitude: [f64; 3],
    /// Tension over mass, m/s²; zero when slack.
    pub tension: f64,
}

/// What acts during a step.
#[derive(Clone, Copy, Debug, Default)]
pub struct Acting {
    /// Asked tilt rate, rad/s.
    pub rate: f64,
    /// Angular acceleration by feed-forward, rad/s².
    pub feed_forward: f64,
    /// Acceleration of the anchor: x, z up, m/s².
    pub anchor: [f64; 2],
}

impl Plane {
    /// At rest at a tether angle; the thrust must suffice.
    #[must_use]
    pub fn at_rest(m: &PlaneModel, angle: f64) -> Self {
        let tilt = angle - (GRAVITY * angle.sin() / m.thrust).clamp(-1.0, 1.0).asin();
        let mut plane =
            Self { motion: Motion::Taut([angle, 0.0]), attitude: [tilt, 0.0, 0.0], tension: 0.0 };
        plane.tension = plane.pull(m, angle, 0.0, [0.0; 2]);
        plane
    }

    /// Tether angle and rate; the direction of the vehicle when slack.
    #[must_use]
    pub fn angle(&self) -> [f64; 2] {
        match self.motion {
            Motion::Taut(q) => q,
            Motion::Slack([x, z, vx, vz]) => {
                [x.atan2(z), (vx * z - vz * x) / (x * x + z * z).max(1e-9)]
            }
        }
    }

    fn pull(&self, m: &PlaneModel, angle: f64, rate: f64, [ax, az]: [f64; 2]) -> f64 {
        m.thrust * (angle - self.attitude[0]).cos() - GRAVITY * angle.cos() + m.length * rate * rate
            - (ax * angle.sin() + az * angle.cos())
    }

    /// Specific force along body x and z, m/s².
    #[must_use]
    pub fn accel(&self, m: &PlaneModel) -> [f64; 2] {
        let (sin, cos) = (self.angle()[0] - self.attitude[0]).sin_cos();
        [-self.tension * sin, m.thrust - self.tension * cos]
    }

    /// `dt` s ahead.
    pub fn step(&mut self, m: &PlaneModel, acting: &Acting, dt: f64) {
        let [wn, zeta] = RATE_LOOP;
        let [ax, az] = acting.anchor;
        // Tension and its lever are held over the step.
        let lever = (self.angle()[0] - self.attitude[0]).sin();
        let tether_torque = m.mass_over_inertia * m.attachment * self.tension.max(0.0) * lever;
        let push = tether_torque + acting.feed_forward;
        let attitude = |tilt_rate: f64, alpha: f64| {
            let jerk = wn * wn * (acting.rate - tilt_rate) - 2.0 * zeta * wn * alpha;
            [tilt_rate, alpha + push, jerk]
        };
        let [tilt, tilt_rate, alpha] = self.attitude;
        match self.motion {
            Motion::Taut([angle, rate]) => {
                let x = [angle, rate, tilt, tilt_rate, alpha];
                let [angle, rate, tilt, tilt_rate, alpha] = runge_kutta(x, dt, |x| {
                    let [s, w, v, r, a] = *x;
                    let accel = GRAVITY * s.sin()
                        - m.thrust * (s - v).sin()
                        - (ax * s.cos() - az * s.sin());
                    let [v1, r1, a1] = attitude(r, a);
                    [w, accel / m.length, v1, r1, a1]
                });
                self.attitude = [tilt, tilt_rate, alpha];
                self.tension = self.pull(m, angle, rate, acting.anchor);
                self.motion = if self.tension < 0.0 {
                    self.tension = 0.0;
                    let (l, (sin, cos)) = (m.length, angle.sin_cos());
                    Motion::Slack([l * sin, l * cos, l * rate * cos, -l * rate * sin])
                } else {
                    Motion::Taut([angle, rate])
                };
            }
            Motion::Slack([x, z, vx, vz]) => {
                let state = [x, z, vx, vz, tilt, tilt_rate, alpha];
                let [x, z, vx, vz, tilt, tilt_rate, alpha] = runge_kutta(state, dt, |state| {
                    let [_, _, vx, vz, v, r, a] = *state;
                    let [v1, r1, a1] = attitude(r, a);
                    let accel = [m.thrust * v.sin() - ax, m.thrust * v.cos() - GRAVITY - az];
                    [vx, vz, accel[0], accel[1], v1, r1, a1]
                });
                self.attitude = [tilt, tilt_rate, alpha];
                self.tension = 0.0;
                let is_outward = x * vx + z * vz > 0.0;
                self.motion = if x.hypot(z) >= m.length && is_outward {
                    // The radial speed is lost in the jerk.
                    let angle = x.atan2(z);
                    Motion::Taut([angle, (vx * angle.cos() - vz * angle.sin()) / m.length])
                } else {
                    Motion::Slack([x, z, vx, vz])
                };
                if let Motion::Taut([angle, rate]) = self.motion {
                    self.tension = self.pull(m, angle, rate, acting.anchor).max(0.0);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MODEL: PlaneModel =
        PlaneModel { length: 3.0, thrust: 12.0, attachment: 0.0, mass_over_inertia: 217.0 };

    #[test]
    fn rest_stays_at_rest_while_the_tilt_is_held() {
        let mut plane = Plane::at_rest(&MODEL, 0.6);
        for _ in 0..800 {
            plane.step(&MODEL, &Acting::default(), 1.0 / 800.0);
        }
        assert!((plane.angle()[0] - 0.6).abs() < 1e-9);
    }

    #[test]
    fn a_slack_tether_does_not_pull() {
        // Thrust straight towards the anchor: slack at once.
        let mut plane = Plane::at_rest(&MODEL, 0.5);
        plane.attitude[0] = 0.5 + std::f64::consts::PI;
        plane.step(&MODEL, &Acting::default(), 1e-3);
        assert!(matches!(plane.motion, Motion::Slack(_)) && plane.tension == 0.0);
        let [x, z] = plane.accel(&MODEL);
        assert!(x.abs() < 1e-12 && (z - 12.0).abs() < 1e-12);
    }
}
