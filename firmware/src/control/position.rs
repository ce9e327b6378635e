//! Which force brings the vehicle along the sphere and keeps the link taut?
//!
//! Tangential PID in tether coordinates without singularity at the zenith, radial feed-forward of
//! the tension (fixed length) or radial PD (winch), a tension guard and a brake at the end of a
//! fixed length. `fullstate` section 11.

use crate::frames::{V3, World};
use crate::math::remainder::{FINE, Remainder};
use crate::math::{GRAVITY, so3};
use crate::model::Line;
use crate::param::Params;
use crate::scalar::Scalar;

/// Of a length that is off by more, m, the integral takes only so much: a line that is caught is not pulled at ever harder.
const RADIAL_STEP: f64 = 0.3;

/// Gains and limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PositionLoop<S> {
    /// kg.
    pub mass: S,
    /// Its weight.
    pub line: Line<S>,
    /// 1/s².
    pub kp: S,
    /// 1/s.
    pub kd: S,
    /// 1/s³.
    pub ki: S,
    /// Largest integral, m/s².
    pub integral_max: S,
    /// The same along the line of a winch, m/s².
    pub radial_integral_max: S,
    /// Largest tangential and radial acceleration, m/s².
    pub accel_max: S,
    /// Radial, 1/s².
    pub radial_p: S,
    /// Radial, 1/s.
    pub radial_d: S,
    /// 1/s.
    pub brake: S,
    /// Share of the wind force fed forward.
    pub wind_feed_forward: S,
    /// N.
    pub tension_min: S,
    /// N.
    pub tension_max: S,
    /// N.
    pub thrust_min: S,
    /// N.
    pub thrust_max: S,
    /// Tangent of the largest tilt.
    pub tan_tilt_max: S,
}

/// How the ground end behaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RadialControl {
    /// The length is given; the radial force is the tension set-point.
    FixedLength,
    /// The winch pulls; the length is controlled.
    Winch,
    /// Nothing pulls: plain coordinates.
    Free,
}

/// The integral, m/s², tangential.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PositionState<S: Scalar> {
    /// World axes.
    pub integral: World<V3<S>>,
    /// Of the integral.
    pub rest: Remainder<S>,
}

impl<S: Scalar> Default for PositionState<S> {
    fn default() -> Self {
        Self { integral: World(V3::zeros()), rest: Remainder::default() }
    }
}

/// Estimate and reference of one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PositionInput<S: Scalar> {
    /// m from the anchor.
    pub position: World<V3<S>>,
    /// m/s.
    pub velocity: World<V3<S>>,
    /// Wind force over mass, m/s²; zero where nobody estimates it.
    pub wind: World<V3<S>>,
    /// Unit vector anchor → reference.
    pub direction: World<V3<S>>,
    /// Velocity of the reference, m/s.
    pub reference_velocity: World<V3<S>>,
    /// Length of the reference, m.
    pub length: S,
    /// Its rate, m/s.
    pub length_rate: S,
    /// Tension to feed forward, at the line's middle, N; on a fixed length kept within the limits.
    pub tension: S,
    /// Ground end.
    pub radial_control: RadialControl,
    /// Nothing may be integrated: the thrust or the tilt was cut last time.
    pub hold_integral: bool,
}

/// The force and whether the tension guard spoke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PositionOutput<S: Scalar> {
    /// Thrust force wanted, N.
    pub force: World<V3<S>>,
    /// The guard raised or lowered the radial force.
    pub is_guarded: bool,
}

impl<S: Scalar> PositionLoop<S> {
    /// From the parameters.
    #[must_use]
    #[inline(never)]
    pub fn new(p: &Params) -> Self {
        let f = S::from_f32;
        Self {
            mass: f(p.mass),
            line: Line::new(p),
            kp: f(p.position_p),
            kd: f(p.position_d),
            ki: f(p.position_i),
            integral_max: f(p.position_i_max),
            radial_integral_max: f(p.radial_i_max),
            accel_max: f(p.accel_max),
            radial_p: f(p.radial_p),
            radial_d: f(p.radial_d),
            brake: f(p.brake),
            wind_feed_forward: f(p.wind_feed_forward),
            tension_min: f(p.tension_min),
            tension_max: f(p.tension_max),
            thrust_min: f(p.thrust_min),
            thrust_max: f(p.thrust_max),
            tan_tilt_max: f(crate::math::trig::tan(p.tilt_max)),
        }
    }

    /// One step over `dt` s.
    pub fn step(
        &self,
        state: &mut PositionState<S>,
        z: &PositionInput<S>,
        dt: S,
    ) -> PositionOutput<S> {
        if z.radial_control == RadialControl::Free {
            return self.free(state, z, dt);
        }
        let m = self.mass;
        let g = S::lit(GRAVITY);
        let floor = S::lit(1e-3);
        let length = so3::norm(&z.position.0).max(floor);
        let u = z.position.0 / length;
        let velocity = z.velocity.0;
        let radial_speed = so3::dot(&u, &velocity);

        let across = so3::reject(&z.direction.0, &u);
        let error = match so3::direction(&across, S::lit(1e-6)) {
            Some((axis, sin)) => axis * (length * sin.atan2(so3::dot(&u, &z.direction.0))),
            None => across,
        };
        let tangential = velocity - u * radial_speed;
        let speed_error = so3::reject(&z.reference_velocity.0, &u) - tangential;
        let mut integral = state.integral.0;
        // A winch leaves the length free: what is steadily off along the line, a payload or weak rotors, is integrated
        // as across it. A fixed length is not the loop's to change.
        let is_winch = z.radial_control == RadialControl::Winch;
        let off = (z.length - length).limit_abs(S::lit(RADIAL_STEP));
        let along = if is_winch { u * off } else { V3::zeros() };
        if !z.hold_integral {
            integral += state.rest.take((error + along) * (self.ki * dt * S::lit(FINE)));
        }
        let outward = if is_winch { so3::dot(&integral, &u) } else { S::zero() };
        let outward = outward.limit_abs(self.radial_integral_max);
        let across = so3::limit_norm(so3::reject(&integral, &u), self.integral_max);
        state.integral = World(across + u * outward);
        let asked =
            so3::limit_norm(error * self.kp + speed_error * self.kd + across, self.accel_max);

        let centripetal = so3::dot(&tangential, &tangential) / length;
        let wind = z.wind.0;
        let mut force = (asked - wind * self.wind_feed_forward - u * centripetal) * m;
        force.z -= m * g + self.line.half_weight(length);
        let mut is_guarded = false;
        match z.radial_control {
            RadialControl::FixedLength => {
                force += u * z.tension.limit(self.tension_min, self.tension_max);
                let pull = so3::dot(&force, &u) + m * (u.z * g + so3::dot(&wind, &u) + centripetal);
                let kept = pull.limit(self.tension_min, self.tension_max);
                is_guarded = kept != pull;
                force += u * (kept - pull);
                let overspeed = (radial_speed - z.length_rate.max(S::lit(0.2))).max(S::zero());
                force -= u * (m * self.brake * overspeed);
            }
            RadialControl::Winch | RadialControl::Free => {
                let accel = self.radial_p * (z.length - length)
                    + self.radial_d * (z.length_rate - radial_speed);
                force += u * (z.tension + m * (accel.limit_abs(self.accel_max) + outward));
            }
        }
        PositionOutput { force: World(self.limit(force)), is_guarded }
    }

    /// The same gains on every axis; the integral carries whatever pushes.
    fn free(&self, state: &mut PositionState<S>, z: &PositionInput<S>, dt: S) -> PositionOutput<S> {
        let error = z.direction.0 * z.length - z.position.0;
        let mut integral = state.integral.0;
        if !z.hold_integral {
            integral += state.rest.take(error * (self.ki * dt * S::lit(FINE)));
        }
        integral = so3::limit_norm(integral, self.integral_max);
        state.integral = World(integral);
        let damping = (z.reference_velocity.0 - z.velocity.0) * self.kd;
        let asked = so3::limit_norm(error * self.kp + damping + integral, self.accel_max);
        let mut force = asked * self.mass;
        force.z -= self.mass * S::lit(GRAVITY);
        PositionOutput { force: World(self.limit(force)), is_guarded: false }
    }

    /// Vertical share first, then tilt, then total thrust.
    fn limit(&self, mut force: V3<S>) -> V3<S> {
        let up = (-force.z).limit(self.thrust_min, self.thrust_max);
        let rest = (self.thrust_max * self.thrust_max - up * up).sqrt();
        let reach = (up * self.tan_tilt_max).min(rest);
        let side = (force.x * force.x + force.y * force.y).sqrt();
        if side > reach {
            let cut = reach / side;
            force.x *= cut;
            force.y *= cut;
        }
        force.z = -up;
        force
    }
}
