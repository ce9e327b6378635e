//! Which torque makes the vehicle turn at that rate? `fullstate` section 11.

use super::AttitudeCommand;
use crate::frames::{Body, V3};
use crate::math::filter::first_order;
use crate::math::so3;
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::MixerReport;
use crate::time::INNER_DT;

/// Low-pass of the gyro's derivative, s (60 Hz).
const DERIVATIVE_TAU: f32 = 0.002_65;

/// Gains and the vehicle's inertia.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateLoop<S: Scalar> {
    /// Principal moments, kg m².
    pub inertia: V3<S>,
    /// 1/s.
    pub kp: S,
    /// 1/s².
    pub ki: S,
    /// On the rate's derivative, 1; zero: off.
    pub kd: S,
    /// Low-pass of that derivative, per step.
    pub derivative_share: S,
    /// Largest integral, rad/s².
    pub integral_max: S,
    /// Tether attachment below the centre of mass, m.
    pub attachment: S,
}

/// What is asked of the loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateSetpoint<S: Scalar> {
    /// rad/s.
    pub rate: Body<V3<S>>,
    /// Fed forward, rad/s².
    pub accel: Body<V3<S>>,
}

impl<S: Scalar> RateSetpoint<S> {
    /// Rate and acceleration of a command.
    #[must_use]
    pub fn of(command: &AttitudeCommand<S>) -> Self {
        Self { rate: command.rate, accel: command.accel }
    }
}

/// The integral, rad/s², and the rate's derivative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateState<S: Scalar> {
    /// Body axes.
    pub integral: Body<V3<S>>,
    /// Last rate, rad/s.
    last: Option<V3<S>>,
    /// Low-passed derivative, rad/s².
    slope: V3<S>,
}

impl<S: Scalar> RateState<S> {
    /// With this integral, rad/s².
    #[must_use]
    pub fn holding(integral: Body<V3<S>>) -> Self {
        Self { integral, ..Self::default() }
    }
}

impl<S: Scalar> Default for RateState<S> {
    fn default() -> Self {
        Self { integral: Body(V3::zeros()), last: None, slope: V3::zeros() }
    }
}

impl<S: Scalar> RateLoop<S> {
    /// From the parameters.
    #[must_use]
    #[inline(never)]
    pub fn new(p: &Params) -> Self {
        let f = S::from_f32;
        Self {
            inertia: V3::new(f(p.inertia_x), f(p.inertia_y), f(p.inertia_z)),
            kp: f(p.rate_p),
            ki: f(p.rate_i),
            kd: f(p.rate_d),
            derivative_share: first_order(DERIVATIVE_TAU, INNER_DT as f32),
            integral_max: f(p.rate_i_max),
            attachment: f(p.attachment),
        }
    }

    /// Torque, N m, over `dt` s. `pull`: force of the tether on the vehicle, body axes, N; its torque
    /// at the attachment is cancelled. Axes that the mixer cut do not integrate outwards.
    pub fn step(
        &self,
        state: &mut RateState<S>,
        wanted: &RateSetpoint<S>,
        rate: &Body<V3<S>>,
        pull: &Body<V3<S>>,
        mixer: MixerReport,
        dt: S,
    ) -> Body<V3<S>> {
        let error = wanted.rate.0 - rate.0;
        let integrate = |integral: S, error: S, is_cut: bool| {
            let grows = (error > S::zero()) == (integral > S::zero());
            if is_cut && grows {
                integral
            } else {
                (integral + self.ki * error * dt).limit_abs(self.integral_max)
            }
        };
        let old = state.integral.0;
        let integral = V3::new(
            integrate(old.x, error.x, mixer.tilt_is_saturated),
            integrate(old.y, error.y, mixer.tilt_is_saturated),
            integrate(old.z, error.z, mixer.yaw_is_saturated),
        );
        state.integral = Body(integral);
        let slope = (rate.0 - state.last.unwrap_or(rate.0)) / dt;
        state.slope += (slope - state.slope) * self.derivative_share;
        state.last = Some(rate.0);
        let j = &self.inertia;
        let ahead = wanted.accel.0;
        let accel = ahead + error * self.kp + integral + (ahead - state.slope) * self.kd;
        let spin = V3::new(j.x * rate.0.x, j.y * rate.0.y, j.z * rate.0.z);
        let gyroscopic = so3::cross(&rate.0, &spin);
        // -r × f with r = (0, 0, attachment).
        let attachment = V3::new(pull.0.y, -pull.0.x, S::zero()) * self.attachment;
        Body(V3::new(j.x * accel.x, j.y * accel.y, j.z * accel.z) + gyroscopic + attachment)
    }
}
