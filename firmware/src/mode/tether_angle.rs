//! Tether Angle: holds and moves the direction of a taut tether by inertia, under constant thrust.
//! `inertial` sections 4, 5 and 8.
//!
//! Neither position, altitude nor length is measured here; the anchor may move. The heading comes from
//! the attitude filter.

use super::refusal::NEEDS_FIXED_LENGTH;
use super::setpoints::SLACK;
use super::taut::{SLACK_SHARE, SLACK_TIME_FORCE};
use super::{
    Context, Entry, Exit, FlightMode, Handover, ModeReport, Refusal, Setpoints, denied, plan,
    rejected,
};
use crate::control::{AttitudeCommand, TetherAngleLoop};
use crate::estimate::tether_angle::{
    TetherAngleEstimate, TetherAngleEstimator, TetherAngleEstimatorState, plane_angles,
};
use crate::frames::{Body, V3};
use crate::model::{TetherKind, thrust_max};
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::{Action, FlightReference};
use crate::time::OUTER_DT;
use crate::trajectory::Plan;

/// Outer steps per control step: one for each turn of the filters, 83 Hz.
const CONTROL_EVERY: u8 = 3;
/// From the thrust at entry to the mode's own, N/s, in units of the weight.
const THRUST_RATE: f64 = 0.5;

/// Configuration.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AngleConfig<S: Scalar> {
    estimator: TetherAngleEstimator<S>,
    control: TetherAngleLoop<S>,
    /// N.
    thrust: S,
    thrust_max: S,
}

/// What moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct TetherAngle<S: Scalar> {
    filter: TetherAngleEstimatorState<S>,
    estimate: TetherAngleEstimate<S>,
    /// Of both planes, held between control steps, rad/s.
    tilt_rates: [S; 2],
    /// N.
    thrust: S,
    /// How long the tether has pulled less than it should, s.
    slack: S,
    ticks: u8,
}

impl<S: Scalar> AngleConfig<S> {
    /// From the parameters; `None` without a cable of fixed length.
    pub fn new(p: &Params) -> Option<Self> {
        if TetherKind::from_parameter(p.tether_kind) != TetherKind::Cable {
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
            thrust_max: f(thrust_max(p) * p.taut_thrust_share),
        })
    }
}

impl<S: Scalar> FlightMode<S> for TetherAngle<S> {
    fn enter(
        _entry: &Entry,
        handover: &mut Handover<S>,
        cx: &Context<'_, S>,
    ) -> Result<Self, Refusal> {
        let Some(config) = &cx.config.modes.angle else {
            return Err(NEEDS_FIXED_LENGTH);
        };
        if config.thrust > config.thrust_max {
            return Err(denied("Mode refused: rotors too weak for TAG_THR_ACC"));
        }
        let situation = cx.situation;
        let estimate = &situation.estimate;
        let Some(position) = estimate.position.filter(|_| situation.navigation.is_airborne())
        else {
            return Err(rejected("Mode refused: no position estimate"));
        };
        if estimate.tether.is_none_or(|tether| !tether.is_taut) {
            return Err(rejected("Mode refused: link is slack"));
        }
        let (attitude, thrust) = (&estimate.attitude, estimate.thrust);
        let filter =
            config.estimator.start(&position, attitude, &cx.situation.inertial_mean(), thrust);
        handover.plan = Plan::stay(position);
        Ok(Self {
            estimate: config.estimator.estimate(&filter, attitude),
            filter,
            tilt_rates: [S::zero(); 2],
            thrust: thrust.min(config.thrust_max),
            slack: S::zero(),
            ticks: CONTROL_EVERY,
        })
    }

    fn step(
        &mut self,
        handover: &mut Handover<S>,
        cx: &Context<'_, S>,
    ) -> Result<Setpoints<S>, Exit> {
        let tension = cx.tension_in_flight(handover);
        let Some(config) = &cx.config.modes.angle else {
            return Err(Exit::failed("Tether angle lost: holding"));
        };
        let dt = S::lit(OUTER_DT);
        let estimate = &cx.situation.estimate;
        let attitude = &estimate.attitude;
        let imu = cx.situation.inertial_mean();
        let is_busy = config.estimator.step(&mut self.filter, &imu, estimate.thrust, attitude);
        self.estimate = config.estimator.estimate(&self.filter, attitude);
        let (position, velocity) = handover.plan.step(dt);
        // Off its tether the vehicle speeds up until its drag looks like a pull.
        let pulls = self.estimate.pull > self.estimate.tension * S::lit(SLACK_SHARE);
        self.slack = if pulls { S::zero() } else { self.slack + dt };
        if self.slack > S::lit(SLACK_TIME_FORCE) || !self.estimate.is_running() {
            return Err(SLACK);
        }
        // The law has a step to itself: beside a filter it would be too much.
        self.ticks += 1;
        if self.ticks >= CONTROL_EVERY && !is_busy {
            self.ticks = 0;
            let [x, y] = plane_angles(&position);
            let ([plane_x, plane_y], [model_x, model_y]) =
                (&self.estimate.planes, &self.estimate.models);
            self.tilt_rates = [
                config.control.step(model_x, x, &plane_x.posterior.x).rate,
                config.control.step(model_y, y, &plane_y.posterior.x).rate,
            ];
        }
        let step = cx.config.constants.weight * S::lit(THRUST_RATE * OUTER_DT);
        self.thrust += (config.thrust - self.thrust).limit_abs(step);
        let heading = handover.heading;
        let mut rate = config.estimator.body_rate(&self.filter, attitude, self.tilt_rates);
        rate.0.z += cx.turn(heading);
        Ok(Setpoints {
            attitude: AttitudeCommand { rate, accel: Body(V3::zeros()), thrust: self.thrust },
            reference: Some(FlightReference { position, velocity, yaw: heading, tension }),
            ..cx.unchanged(tension)
        })
    }

    /// A move of the direction.
    fn command(
        &mut self,
        handover: &mut Handover<S>,
        action: &Action,
        cx: &Context<'_, S>,
    ) -> Result<(), Refusal> {
        if matches!(action, Action::MoveTether { tension: Some(_), .. }) {
            return Err(denied("Move refused: not an output of this mode"));
        }
        plan::command(handover, action, cx).map(|_| ())
    }

    fn sees_pull(&self, _cx: &Context<'_, S>) -> Option<bool> {
        Some(self.slack <= S::zero())
    }

    fn report(&self) -> ModeReport<S> {
        ModeReport { angle: Some(self.estimate), ..ModeReport::default() }
    }
}
