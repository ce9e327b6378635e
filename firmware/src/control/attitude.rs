//! Which body rates and thrust give that force? Reduced attitude: the thrust axis first, yaw after.
//! `fullstate` section 11.

use crate::frames::{Attitude, Body, V3, World};
use crate::math::so3;
use crate::param::Params;
use crate::scalar::Scalar;

/// Gains and limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AttitudeLoop<S> {
    /// Tilt error to rate, 1/s.
    pub tilt_gain: S,
    /// Yaw error to rate, 1/s.
    pub yaw_gain: S,
    /// rad/s.
    pub tilt_rate_max: S,
    /// rad/s.
    pub yaw_rate_max: S,
    /// Lowest thrust, N.
    pub thrust_min: S,
}

/// Rates and thrust to realise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AttitudeCommand<S: Scalar> {
    /// rad/s.
    pub rate: Body<V3<S>>,
    /// Angular acceleration known in advance, rad/s².
    pub accel: Body<V3<S>>,
    /// Along the body's up axis, N.
    pub thrust: S,
}

impl<S: Scalar> AttitudeCommand<S> {
    /// No rotation, no thrust.
    #[must_use]
    pub fn idle() -> Self {
        Self { rate: Body(V3::zeros()), accel: Body(V3::zeros()), thrust: S::zero() }
    }
}

impl<S: Scalar> AttitudeLoop<S> {
    /// From the parameters.
    #[must_use]
    #[inline(never)]
    pub fn new(p: &Params) -> Self {
        let f = S::from_f32;
        Self {
            tilt_gain: f(p.attitude_p),
            yaw_gain: f(p.yaw_p),
            tilt_rate_max: f(p.tilt_rate_max),
            yaw_rate_max: f(p.yaw_rate_max),
            thrust_min: f(p.thrust_min),
        }
    }

    /// `force`: thrust wanted, N, world; `yaw`: heading wanted, rad from North. A force too small to
    /// have a direction asks for level.
    #[must_use]
    pub fn step(&self, force: &World<V3<S>>, attitude: &Attitude<S>, yaw: S) -> AttitudeCommand<S> {
        let r = &attitude.0;
        let down = V3::new(S::zero(), S::zero(), S::one());
        let wanted = so3::direction(&-force.0, S::lit(1e-3)).map_or(down, |(axis, _)| axis);
        let current = so3::col_z(r);
        let across = so3::cross(&current, &wanted);
        let cos = so3::dot(&current, &wanted);
        let (error, aligned) = match so3::direction(&across, S::lit(1e-6)) {
            Some((axis, sin)) => (axis * sin.atan2(cos), so3::axis_angle(&axis, sin, cos) * r),
            // Upside down to the last bit: any axis will do.
            None if cos < S::zero() => (so3::col_x(r) * S::lit(core::f64::consts::PI), *r),
            None => (across, *r),
        };
        let tilt =
            so3::limit_norm(so3::transpose_mul(r, &error) * self.tilt_gain, self.tilt_rate_max);

        let (sin_yaw, cos_yaw) = yaw.sin_cos();
        let right = V3::new(-sin_yaw, cos_yaw, S::zero());
        let yaw_error = (-so3::dot(&right, &so3::col_x(&aligned)))
            .atan2(so3::dot(&right, &so3::col_y(&aligned)));
        let spin = (yaw_error * self.yaw_gain).limit_abs(self.yaw_rate_max);
        AttitudeCommand {
            rate: Body(V3::new(tilt.x, tilt.y, tilt.z + spin)),
            accel: Body(V3::zeros()),
            thrust: (-so3::dot(&force.0, &current)).max(self.thrust_min),
        }
    }
}
