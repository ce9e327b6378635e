//! Tether Angle: holds and moves the direction of a taut tether by inertia, under constant thrust.
//! `inertial` sections 4, 5 and 8.
//!
//! Neither position, altitude nor length is measured here; the anchor may move. The heading comes from
//! the attitude filter.

use super::Vehicle;
use super::requests::{Refusal, denied, rejected};
use super::taut::{NEEDS_FIXED_LENGTH, SLACK_SHARE, SLACK_TIME_FORCE};
use crate::control::{AttitudeCommand, TetherAngleLoop};
use crate::estimate::tether_angle::{
    TetherAngleEstimate, TetherAngleEstimator, TetherAngleEstimatorState, plane_angles,
};
use crate::frames::{Body, V3};
use crate::math::wrap_pi;
use crate::model::LinkKind;
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::{Event, EventQueue, FlightReference, Imu};
use crate::supervisor::Mode;
use crate::time::OUTER_DT;
use crate::trajectory::Plan;

/// Outer steps per control step: one for each turn of the filters, 83 Hz.
const CONTROL_EVERY: u8 = 3;
/// From the thrust at entry to the mode's own, N/s, in units of the weight.
const THRUST_RATE: f64 = 0.5;

/// Configuration.
#[derive(Clone, Copy, Debug)]
pub(super) struct AngleMode<S: Scalar> {
    estimator: TetherAngleEstimator<S>,
    control: TetherAngleLoop<S>,
    /// N.
    thrust: S,
    thrust_max: S,
    yaw_gain: S,
    yaw_rate_max: S,
}

/// What moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct AngleFlight<S: Scalar> {
    filter: TetherAngleEstimatorState<S>,
    pub estimate: TetherAngleEstimate<S>,
    /// Of both planes, held between control steps, rad/s.
    tilt_rates: [S; 2],
    /// N.
    thrust: S,
    /// How long the tether has pulled less than it should, s.
    pub slack: S,
    ticks: u8,
}

impl<S: Scalar> AngleMode<S> {
    /// From the parameters; `None` without a cable of fixed length.
    pub fn new(p: &Params) -> Option<Self> {
        if LinkKind::from_parameter(p.tether_kind) != LinkKind::Cable {
            return None;
        }
        let f = S::from_f32;
        let control = TetherAngleLoop {
            tether_time: f(p.angle_tether_time),
            tether_damping: f(p.angle_damping),
            tilt_time: f(p.angle_tilt_time),
            tension_min: Some(f(p.angle_tension_min)),
            rate_max: f(p.tilt_rate_max),
        };
        Some(Self {
            estimator: TetherAngleEstimator::try_new(p).ok()?,
            control: control.validate().ok()?,
            thrust: f(p.angle_thrust * p.mass),
            thrust_max: f(4.0 * p.rotor_thrust_max * p.taut_thrust_share),
            yaw_gain: f(p.yaw_p),
            yaw_rate_max: f(p.yaw_rate_max),
        })
    }
}

impl<S: Scalar> Vehicle<S> {
    /// Inertial readings of the last outer step, bias removed.
    pub(super) fn inertial_mean(&self) -> Imu<S> {
        let average = self.state.estimator.average();
        let gyro = Body(average.gyro.0 - self.state.estimate.gyro_bias.0);
        Imu { gyro, accel: average.accel }
    }

    pub(super) fn request_angle(&mut self) -> Result<(), Refusal> {
        let Some(mode) = self.config.angle else {
            return Err(NEEDS_FIXED_LENGTH);
        };
        if mode.thrust > mode.thrust_max {
            return Err(denied("Mode refused: rotors too weak for TAG_THR_ACC"));
        }
        let estimate = &self.state.estimate;
        let position = estimate.position.filter(|_| self.state.estimator.is_airborne());
        let Some(position) = position.filter(|_| self.has_place()) else {
            return Err(rejected("Mode refused: no position estimate"));
        };
        if estimate.tether.is_none_or(|tether| !tether.is_taut) {
            return Err(rejected("Mode refused: link is slack"));
        }
        let attitude = estimate.attitude;
        let thrust = estimate.thrust;
        let filter = mode.estimator.start(&position, &attitude, &self.inertial_mean(), thrust);
        self.enter(Mode::TetherAngle);
        self.state.plan = Plan::stay(position);
        self.state.angle_flight = Some(AngleFlight {
            estimate: mode.estimator.estimate(&filter, &attitude),
            filter,
            tilt_rates: [S::zero(); 2],
            thrust: thrust.min(mode.thrust_max),
            slack: S::zero(),
            ticks: CONTROL_EVERY,
        });
        Ok(())
    }

    pub(super) fn fly_angle(&mut self, events: &mut EventQueue) {
        let imu = self.inertial_mean();
        let (Some(mode), Some(mut flight)) = (self.config.angle, self.state.angle_flight) else {
            return self.leave_taut("Tether angle lost: holding", events);
        };
        let dt = S::lit(OUTER_DT);
        let estimate = &self.state.estimate;
        let attitude = estimate.attitude;
        let is_busy = mode.estimator.step(&mut flight.filter, &imu, estimate.thrust, &attitude);
        flight.estimate = mode.estimator.estimate(&flight.filter, &attitude);
        let state = &mut self.state;
        let (position, velocity) = state.plan.step(dt);
        state.reference =
            Some(FlightReference { position, velocity, yaw: state.yaw, tension: state.tension });
        // Off its tether the vehicle speeds up until its drag looks like a pull.
        let pulls = flight.estimate.pull > flight.estimate.tension * S::lit(SLACK_SHARE);
        flight.slack = if pulls { S::zero() } else { flight.slack + dt };
        let is_slack = flight.slack > S::lit(SLACK_TIME_FORCE);
        if is_slack || !flight.estimate.is_running() {
            events.push(Event::critical("Tether slack: descending"));
            return self.enter(Mode::Descent);
        }
        // The law has a step to itself: beside a filter it would be too much.
        flight.ticks += 1;
        if flight.ticks >= CONTROL_EVERY && !is_busy {
            flight.ticks = 0;
            let [x, y] = plane_angles(&position);
            let ([plane_x, plane_y], [model_x, model_y]) =
                (&flight.estimate.planes, &flight.estimate.models);
            flight.tilt_rates = [
                mode.control.step(model_x, x, &plane_x.belief.x).rate,
                mode.control.step(model_y, y, &plane_y.belief.x).rate,
            ];
        }
        let step = self.config.weight * S::lit(THRUST_RATE * OUTER_DT);
        flight.thrust += (mode.thrust - flight.thrust).limit_abs(step);
        let (.., yaw) = attitude.euler();
        let turn = (wrap_pi(state.yaw - yaw) * mode.yaw_gain).limit_abs(mode.yaw_rate_max);
        let mut rate = mode.estimator.body_rate(&flight.filter, &attitude, flight.tilt_rates);
        rate.0.z += turn;
        state.attitude = AttitudeCommand { rate, accel: Body(V3::zeros()), thrust: flight.thrust };
        state.angle_flight = Some(flight);
    }
}
