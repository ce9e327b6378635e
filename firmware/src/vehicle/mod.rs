//! The whole autopilot: [`Vehicle::step`].
//!
//! ```text
//! sensors -> estimate -> control -> mixer -> throttle
//!    |          |           |         |
//!    +----------+-----------+---------+--> StepOutput -> log, MAVLink
//!             supervisor (mode, arming, failsafe) gates each stage
//! ```
//!
//! The board calls it from the IMU interrupt; the simulator from a loop over simulated time. Time is
//! an argument, nothing reads a global, and the step cannot fail: a block that refuses becomes a
//! supervisor event, and the motors always get a defined command.

mod config;
mod flight;
mod output;
mod pendulum;
mod requests;
mod slack_hover;
mod supervise;
mod taut;
mod tether_angle;

pub use output::{StepInput, StepOutput};
pub use pendulum::PendulumReport;

use crate::control::taut::TautPilotState;
use crate::control::{AttitudeCommand, ClimbState, PositionState, RateSetpoint, RateState};
use crate::estimate::taut::TautEstimatorState;
use crate::estimate::{Phase, TetherEstimatorState};
use crate::frames::{Body, V3, World};
use crate::param::Params;
use crate::scalar::Scalar;
use crate::sense::{ImuScale, SenseState};
use crate::signal::{
    Actuation, Estimate, EventQueue, FlightReference, MixerReport, ROTORS, Reply, Sensors, Sticks,
    WinchCommand, Wrench,
};
use crate::supervisor::{FailsafeState, GroundState, Mode, TouchDownState};
use crate::time::{INNER_DT, Micros, Sample};
use crate::trajectory::{Plan, TautPlan};
use config::Config;
use pendulum::{PendulumFlight, RodWatch};
use slack_hover::SlackHover;
use tether_angle::AngleFlight;

/// One autopilot.
#[derive(Clone, Debug)]
pub struct Vehicle<S: Scalar = f32> {
    params: Params,
    scale: ImuScale,
    config: Config<S>,
    state: State<S>,
}

/// Everything that moves, apart from the blocks' configuration.
#[derive(Clone, Debug)]
struct State<S: Scalar> {
    sense: SenseState<S>,
    estimator: TetherEstimatorState<S>,
    estimate: Estimate<S>,
    specific_force: S,

    mode: Mode,
    armed_at: Option<Micros>,
    /// All arming checks passed when they were last looked at.
    is_armable: bool,
    /// Since the estimators moved on.
    phase: OuterPhase,
    ground: GroundState,
    landed_at: Option<Micros>,
    failsafe: FailsafeState,
    touch_down: TouchDownState<S>,
    /// 1 in flight, runs down to 0 on ground contact.
    contact_ramp: S,

    link_at: Option<Micros>,
    sticks: Option<Sample<Sticks>>,

    plan: Plan<S>,
    /// Time in the thrust ramp on the ground, s.
    spool: S,
    takeoff_altitude: Option<f32>,
    yaw: S,
    tension: S,
    tension_target: S,
    smoothed: Option<Smoothed<S>>,
    position: PositionState<S>,
    climb: ClimbState<S>,
    attitude: AttitudeCommand<S>,
    reference: Option<FlightReference<S>>,
    /// Under way; `None` once done.
    slack_hover: Option<SlackHover<S>>,
    /// A parameter that the vehicle changed by itself, for the ground station.
    echo: Option<usize>,
    taut: TautEstimatorState<S>,
    /// In the taut-link modes.
    taut_flight: Option<TautFlight<S>>,
    /// In Tether Angle.
    angle_flight: Option<AngleFlight<S>>,
    /// While a rod on top is seen.
    rod: Option<RodWatch<S>>,
    /// In Pendulum.
    pendulum_flight: Option<PendulumFlight<S>>,

    rate: RateState<S>,
    mixer: MixerReport,
    wrench: Wrench<S>,
    actuation: Actuation<S>,
}

/// The outer loop's work, a part in each millisecond after the filter's own, so that none is much dearer than
/// another.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum OuterPhase {
    /// Until the filter's next step.
    #[default]
    Idle,
    /// The observers beside it.
    Observe,
    /// Supervisor, guidance, attitude.
    Fly,
}

/// What moves in a taut-link mode.
#[derive(Clone, Copy, Debug)]
struct TautFlight<S: Scalar> {
    pilot: TautPilotState<S>,
    plan: TautPlan<S>,
    /// Elevation that the observer sees too much of, by the altimeter, rad.
    correction: S,
    /// How long the link has pulled less than it should, s.
    slack: S,
}

/// Estimate behind the position loop's low-pass.
#[derive(Clone, Copy, Debug)]
struct Smoothed<S: Scalar> {
    position: World<V3<S>>,
    velocity: World<V3<S>>,
    tension: S,
}

impl<S: Scalar> Vehicle<S> {
    /// On the ground, disarmed, nothing measured yet. `scale` is how the driver set the sensor up.
    #[must_use]
    pub fn new(params: Params, scale: ImuScale) -> Self {
        let config = Config::new(&params, scale);
        let estimator = config.estimator.start();
        let estimate = config.estimator.estimate(&estimator);
        let still = Body(V3::zeros());
        let state = State {
            sense: SenseState::default(),
            estimator,
            estimate,
            specific_force: S::zero(),
            mode: Mode::default(),
            armed_at: None,
            is_armable: false,
            phase: OuterPhase::Idle,
            ground: GroundState::OnGround,
            landed_at: None,
            failsafe: FailsafeState::default(),
            touch_down: TouchDownState::default(),
            contact_ramp: S::one(),
            link_at: None,
            sticks: None,
            plan: Plan::stay(World(V3::zeros())),
            spool: S::zero(),
            takeoff_altitude: None,
            yaw: S::from_f32(params.start_heading),
            tension: config.tension_low,
            tension_target: S::from_f32(params.tension),
            smoothed: None,
            position: PositionState::default(),
            climb: ClimbState::default(),
            attitude: AttitudeCommand::idle(),
            reference: None,
            slack_hover: None,
            echo: None,
            taut: TautEstimatorState::default(),
            taut_flight: None,
            angle_flight: None,
            rod: None,
            pendulum_flight: None,
            rate: RateState::default(),
            mixer: MixerReport::default(),
            wrench: Wrench { thrust: S::zero(), torque: still },
            actuation: Actuation {
                thrusts: [S::zero(); ROTORS],
                throttle: [S::zero(); ROTORS],
                is_armed: false,
                winch: WinchCommand { tension: config.tension_low },
            },
        };
        Self { params, scale, config, state }
    }

    /// All settings.
    #[must_use]
    pub fn params(&self) -> &Params {
        &self.params
    }

    /// Tension asked of the winch, N.
    #[must_use]
    pub fn winch_tension(&self) -> S {
        self.state.actuation.winch.tension
    }

    /// One step; call it at every inertial sample, or at the same rate when the sensor is silent.
    pub fn step(&mut self, input: &StepInput) -> StepOutput<S> {
        let mut events = EventQueue::default();
        self.hear(input);
        let cos_tilt = self.state.estimate.attitude.cos_tilt();
        let sensors =
            self.config.sense.step(&mut self.state.sense, input.now, &input.sensors, cos_tilt);
        let phase = core::mem::take(&mut self.state.phase);
        if self.observe(&sensors, &mut events) {
            self.state.phase = OuterPhase::Observe;
        }
        self.see_rod(&sensors);
        let reply: Option<Reply> =
            input.request.map(|request| self.handle(&request, &sensors, input.now, &mut events));
        if phase == OuterPhase::Fly || sensors.imu.is_none() {
            self.supervise(&sensors, input.now, &mut events);
        }
        match phase {
            OuterPhase::Idle => {}
            OuterPhase::Observe => {
                self.observe_rod(input.now);
                self.observe_link();
                self.state.phase = OuterPhase::Fly;
            }
            OuterPhase::Fly => self.fly(&sensors, input.now, &mut events),
        }
        self.actuate(&sensors);
        let reply = reply.or_else(|| self.state.echo.take().map(Reply::echo));
        self.report(input.now, &sensors, reply, events)
    }

    /// Notes when somebody outside last spoke.
    fn hear(&mut self, input: &StepInput) {
        let state = &mut self.state;
        state.link_at = state.link_at.max(input.heartbeat_at);
        if let Some(sticks) = input.sticks {
            let v = &sticks.value;
            if [v.roll, v.pitch, v.yaw, v.throttle].iter().all(|axis| axis.is_finite()) {
                state.sticks = Some(sticks);
            }
        }
    }

    fn observe(&mut self, sensors: &Sensors<S>, events: &mut EventQueue) -> bool {
        let state = &mut self.state;
        let has_landed = state.ground == GroundState::OnGround && state.landed_at.is_some();
        let phase = if state.armed_at.is_none() || has_landed {
            Phase::Resting
        } else if state.contact_ramp < S::one() || state.slack_hover.is_some() {
            Phase::Touching
        } else {
            Phase::Powered
        };
        if let Some(imu) = &sensors.imu {
            state.specific_force = crate::math::so3::norm(&imu.value.accel.0);
        }
        let was_levelled = state.estimate.is_levelled;
        let has_ticked = self.config.estimator.step(
            &mut state.estimator,
            sensors,
            &state.actuation.thrusts,
            phase,
        );
        if has_ticked || !was_levelled {
            state.estimate = self.config.estimator.estimate(&state.estimator);
        } else {
            state.estimate.rate = self.config.estimator.rate(&state.estimator);
        }
        if state.estimate.is_levelled && !was_levelled {
            events.push(crate::signal::Event::info("Levelled, gyro bias taken"));
        }
        has_ticked
    }

    /// Rate loop, mixer and thrust map, at every inertial sample.
    fn actuate(&mut self, sensors: &Sensors<S>) {
        let state = &mut self.state;
        let is_armed = state.armed_at.is_some();
        state.actuation.is_armed = is_armed;
        state.actuation.winch = WinchCommand { tension: state.tension };
        if !is_armed {
            state.actuation.thrusts = [S::zero(); ROTORS];
            state.actuation.throttle = [S::zero(); ROTORS];
            state.mixer = MixerReport::default();
            state.wrench = Wrench { thrust: S::zero(), torque: Body(V3::zeros()) };
            state.rate = RateState::default();
            return;
        }
        let voltage = sensors.battery.map(|battery| battery.voltage);
        if state.ground == GroundState::OnGround {
            let idle = self.config.mixer.min;
            state.actuation.thrusts = [idle; ROTORS];
            state.rate = RateState::default();
        } else if sensors.imu.is_some() {
            let estimate = &state.estimate;
            let pull = match (&estimate.tether, &estimate.position) {
                // The specific force is the thrust, which has no sideways part, and the pull.
                _ if state.mode.flies_taut() => {
                    let force = state.taut.estimate().map_or(V3::zeros(), |taut| taut.accel.0);
                    Body(V3::new(force.x, force.y, S::zero()) * self.config.mass)
                }
                (Some(tether), Some(position))
                    if tether.is_taut && state.estimator.is_airborne() =>
                {
                    let towards = position.0 * (-tether.tension / tether.length.max(S::lit(0.3)));
                    estimate.attitude.to_body(World(towards))
                }
                _ => Body(V3::zeros()),
            };
            let dt = S::lit(INNER_DT);
            let wanted = RateSetpoint::of(&state.attitude);
            let torque = self.config.rate.step(
                &mut state.rate,
                &wanted,
                &estimate.rate,
                &pull,
                state.mixer,
                dt,
            );
            let thrust = state.attitude.thrust * state.contact_ramp / self.config.thrust_scale;
            state.wrench = Wrench { thrust, torque };
            let (thrusts, report) = self.config.mixer.step(&state.wrench);
            state.actuation.thrusts = thrusts;
            state.mixer = report;
        }
        state.actuation.throttle =
            state.actuation.thrusts.map(|thrust| self.config.thrust_map.throttle(thrust, voltage));
    }
}
