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

mod actuate;
mod arbiter;
mod authority;
mod felt;
mod fly;
mod output;
mod radio;
mod requests;
mod tell;

pub use crate::mode::PendulumReport;
pub use output::{StepInput, StepOutput};

use output::News;

use crate::config::{Config, Stale};
use crate::control::{AttitudeCommand, ClimbState, DitherState, PositionState, RateState};
use crate::estimate::taut::{TautEstimatorState, TautInput};
use crate::frames::{Body, V3, World};
use crate::mode::{ActiveMode, Context, Handover, Setpoints, Situation};
use crate::navigation::{Intent, Phase, Stage};
use crate::param::{Params, broken};
use crate::scalar::Scalar;
use crate::sense::{ImuScale, Motion, SenseState};
use crate::signal::{
    Actuation, AltimeterReport, Event, EventQueue, MAX_ROTORS, MixerReport, Reply, Request,
    Sensors, Ticket, WinchCommand, Wrench,
};
use crate::supervisor::{
    FailsafeState, GroundState, LineFault, LineWatch, RotorWatchState, TouchDownState,
};
use crate::time::Micros;
use crate::trajectory::Plan;
use actuate::MotorTest;
use felt::Felt;
use heapless::Deque;
use radio::RadioState;
use tell::Told;

/// Requests that may wait for the parameters.
const WAITING: usize = 4;

/// One autopilot.
#[derive(Clone, Debug)]
pub struct Vehicle<S: Scalar = f32> {
    params: Params,
    scale: ImuScale,
    /// Of the board, for motors.
    outputs: usize,
    config: Config<S>,
    /// What of it does not follow the parameters yet.
    stale: Stale,
    mode: ActiveMode<S>,
    situation: Situation<S>,
    state: State<S>,
    /// What the last step said; filled in place, each group when it has changed.
    output: StepOutput,
}

/// What moves and concerns no mode.
#[derive(Clone, Debug)]
struct State<S: Scalar> {
    sense: SenseState<S>,
    felt: Felt<S>,
    /// All arming checks passed when they were last looked at.
    is_armable: bool,
    /// The parameters go together.
    is_consistent: bool,
    /// Since the estimators moved on.
    phase: OuterPhase,
    landed_at: Option<Micros>,
    /// Since when the position filter is well again that had diverged: it must prove itself.
    doubt: Option<Micros>,
    /// No inertial reading since a while.
    is_blind: bool,
    told: Told,
    /// Which altimeter is not believed.
    altimeters: AltimeterReport,
    failsafe: FailsafeState,
    touch_down: TouchDownState<S>,
    line_watch: LineWatch<S>,
    line: LineFault,
    rotor_watch: RotorWatchState<S>,
    /// Gives no thrust any more, until power-down.
    lost_rotor: Option<usize>,
    /// 1 in flight, runs down to 0 on ground contact.
    contact_ramp: S,
    link_at: Option<Micros>,
    /// Ground station that may ask, in flight.
    commander: Option<u8>,
    motor_test: Option<MotorTest<S>>,
    radio: RadioState,
    /// When a refusal that repeats was last told.
    refusal_told: Option<Micros>,
    /// A parameter that the vehicle changed by itself, for the ground station.
    echo: Option<usize>,
    /// Whose command the mode still considers.
    considered: Option<Ticket>,
    /// Asked on the ground while the blocks still follow the parameters.
    waiting: Deque<Request, WAITING>,
    /// The battery's, as the motors are driven by it, V.
    voltage: Option<S>,
    rate: RateState<S>,
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
    /// The observers beside it; the full-state filter's prediction.
    Observe,
    /// Its accelerometer.
    Feel,
    /// Supervisor, guidance, attitude.
    Fly,
    /// The rest of the full-state filter, beside the next step's beginning.
    Locate,
}

/// Now, and what the sensors say now.
#[derive(Clone, Copy, Debug)]
struct Moment<'a, S: Scalar> {
    now: Micros,
    sensors: &'a Sensors<S>,
    /// The full-state filter takes most of this millisecond: what can wait for the next one does.
    is_full: bool,
}

/// What a mode may read, while the mode itself may change.
macro_rules! context {
    ($vehicle:expr, $at:expr) => {
        $crate::mode::Context {
            now: $at.now,
            params: &$vehicle.params,
            config: &$vehicle.config,
            sensors: $at.sensors,
            situation: &$vehicle.situation,
        }
    };
}
use context;

impl<S: Scalar> Vehicle<S> {
    /// On the ground, disarmed, nothing measured yet. `scale` is how the driver set the sensor up.
    #[must_use]
    pub fn new(params: Params, scale: ImuScale) -> Self {
        let config = Config::new(&params, scale);
        let navigation = config.navigation.start();
        let estimate = config.navigation.estimate(&navigation);
        let mode = ActiveMode::at_rest(Handover {
            heading: S::from_f32(params.start_heading),
            tension: S::from_f32(params.tension),
            plan: Plan::stay(World(V3::zeros())),
            position: PositionState::default(),
            climb: ClimbState::default(),
        });
        let situation = Situation {
            navigation,
            estimate,
            smoothed: None,
            taut: TautEstimatorState::default(),
            dither: DitherState::default(),
            rod: None,
            sticks: None,
            setpoint: None,
            armed_at: None,
            mixer: MixerReport::default(),
            has_place: false,
            setpoints: Setpoints {
                attitude: AttitudeCommand::idle(),
                reference: None,
                tension: config.constants.tension_low,
                dither: S::zero(),
                ground: GroundState::OnGround,
                wants_down: false,
                notice: None,
            },
        };
        let state = State {
            sense: SenseState::default(),
            felt: Felt::default(),
            is_armable: false,
            is_consistent: broken(&params).is_none(),
            phase: OuterPhase::Idle,
            landed_at: None,
            doubt: None,
            is_blind: false,
            told: Told::default(),
            altimeters: AltimeterReport::default(),
            failsafe: FailsafeState::default(),
            touch_down: TouchDownState::default(),
            line_watch: LineWatch::default(),
            line: LineFault::default(),
            rotor_watch: RotorWatchState::default(),
            lost_rotor: None,
            contact_ramp: S::one(),
            link_at: None,
            commander: None,
            motor_test: None,
            radio: RadioState::default(),
            refusal_told: None,
            echo: None,
            considered: None,
            waiting: Deque::new(),
            voltage: None,
            rate: RateState::default(),
            wrench: Wrench { thrust: S::zero(), torque: Body(V3::zeros()) },
            actuation: Actuation {
                thrusts: config.mixer.each(S::zero()),
                throttle: config.mixer.each(S::zero()),
                is_armed: false,
                winch: WinchCommand { tension: config.constants.tension_low },
            },
        };
        let output = StepOutput::before(&situation, &state, &mode);
        let outputs = MAX_ROTORS;
        Self {
            params,
            scale,
            outputs,
            config,
            stale: Stale::default(),
            mode,
            situation,
            state,
            output,
        }
    }

    /// How many motors the board can drive; as many as any frame has unless it says so.
    pub fn set_outputs(&mut self, outputs: usize) {
        self.outputs = outputs;
    }

    /// What the last step said.
    #[must_use]
    pub fn output(&self) -> &StepOutput {
        &self.output
    }

    /// All settings.
    #[must_use]
    pub fn params(&self) -> &Params {
        &self.params
    }

    /// One that runs beside another, on the same inputs, learns what that one's motors do: its own nobody flies.
    pub fn follow(&mut self, flown: &Self) {
        self.state.actuation = flown.state.actuation;
        self.state.wrench = flown.state.wrench;
    }

    /// Tension asked of the winch, N.
    #[must_use]
    pub fn winch_tension(&self) -> S {
        self.state.actuation.winch.tension
    }

    fn context<'a>(&'a self, at: Moment<'a, S>) -> Context<'a, S> {
        context!(self, at)
    }

    /// Call it after each step, when the pulses are out: makes one block anew that a changed parameter concerns. It
    /// may take as long as a step, but no millisecond has two.
    #[inline(never)]
    pub fn maintain(&mut self) {
        if !self.stale.is_empty() {
            self.state.is_consistent = broken(&self.params).is_none();
        }
        let has_renewed = self.config.renew(&mut self.stale, &self.params, self.scale);
        if has_renewed && let Some(rotor) = self.state.lost_rotor {
            let _ = self.config.mixer.lose(rotor, &self.params);
        }
        if has_renewed && self.situation.armed_at.is_none() {
            // The place to start from follows from the parameters.
            self.situation.navigation.replace(&self.config.navigation);
        }
    }

    /// One step; call it at every inertial sample, or at the same rate when the sensor is silent.
    /// What it says stays readable as [`Self::output`].
    pub fn step(&mut self, input: &StepInput) -> &StepOutput {
        let mut events = EventQueue::default();
        self.receive(input);
        let motion = Motion {
            cos_tilt: self.situation.estimate.attitude.cos_tilt(),
            accel_up: self.situation.navigation.accel_up(),
            rests: self.situation.setpoints.ground == GroundState::OnGround,
        };
        let sensors =
            self.config.sense.step(&mut self.state.sense, input.now, &input.sensors, &motion);
        self.state.altimeters = sensors.altimeters;
        let phase = core::mem::take(&mut self.state.phase);
        let is_full = phase == OuterPhase::Feel && self.situation.navigation.is_full();
        let at = Moment { now: input.now, sensors: &sensors, is_full };
        let was_levelled = self.situation.estimate.is_levelled;
        let has_ticked = self.estimate(&sensors, &mut events);
        if has_ticked {
            self.state.phase = OuterPhase::Observe;
        }
        self.receive_rod(&sensors);
        let has_estimated = self.advance(phase);
        let reply = self.take_up(input.request.as_ref(), at, &mut events);
        let radio = input.sensors.radio.as_ref();
        let has_switched = radio.is_some_and(|frame| self.hear(frame, at, &mut events));
        if phase == OuterPhase::Fly || sensors.imu.is_none() {
            self.supervise(at, &mut events);
        }
        match phase {
            OuterPhase::Idle | OuterPhase::Locate => {}
            OuterPhase::Observe => {
                self.observe_rod(input.now);
                self.observe_link();
                self.state.phase = OuterPhase::Feel;
            }
            OuterPhase::Feel => self.state.phase = OuterPhase::Fly,
            OuterPhase::Fly => {
                self.tell(input.now, &mut events);
                self.fly(at, &mut events);
                self.state.phase = OuterPhase::Locate;
            }
        }
        self.actuate(input.now, &sensors, &mut events);
        let reply = reply.or_else(|| self.state.echo.take().map(Reply::echo));
        // A request or a silent sensor may change anything.
        let is_asked = input.request.is_some() || has_switched;
        let is_whole = is_asked || reply.is_some() || sensors.imu.is_none();
        let news = News {
            estimate: has_ticked || has_estimated || !was_levelled || is_whole,
            observers: phase == OuterPhase::Observe || sensors.rod.is_some() || is_whole,
            guidance: phase == OuterPhase::Fly || is_whole,
        };
        self.report(input.now, &sensors, reply, events, news)
    }

    /// Notes when somebody outside last spoke.
    fn receive(&mut self, input: &StepInput) {
        self.state.link_at = self.state.link_at.max(input.heartbeat_at);
        if let Some(sticks) = input.sticks
            && self.admits_joystick(input.now)
        {
            let v = &sticks.value;
            if [v.roll, v.pitch, v.yaw, v.throttle].iter().all(|axis| axis.is_finite()) {
                self.situation.sticks = Some(sticks);
            }
        }
    }

    fn estimate(&mut self, sensors: &Sensors<S>, events: &mut EventQueue) -> bool {
        let (state, situation) = (&mut self.state, &mut self.situation);
        let is_on_ground = situation.setpoints.ground == GroundState::OnGround;
        let has_landed = is_on_ground && state.landed_at.is_some();
        let phase = if situation.armed_at.is_none() || has_landed {
            Phase::Resting
        } else if state.contact_ramp < S::one() || self.mode.climbs_slack() {
            Phase::Touching
        } else {
            Phase::Powered
        };
        if let Some(imu) = &sensors.imu {
            state.felt.step(&imu.value);
        }
        let was_levelled = situation.estimate.is_levelled;
        let navigation = &self.config.navigation;
        let thrusts = &state.actuation.thrusts;
        let has_ticked = navigation.step(&mut situation.navigation, sensors, thrusts, phase);
        let is_full = situation.navigation.is_full();
        if (has_ticked && !is_full) || !was_levelled {
            situation.estimate = navigation.estimate(&situation.navigation);
        } else {
            situation.estimate.rate = navigation.rate(&situation.navigation);
        }
        if situation.estimate.is_levelled && !was_levelled {
            events.push(Event::info("Levelled, gyro bias taken"));
        }
        has_ticked
    }

    /// The full-state filter's part of this millisecond, if it flies; true when the estimate is new.
    fn advance(&mut self, phase: OuterPhase) -> bool {
        let situation = &mut self.situation;
        let stage = match phase {
            _ if !situation.navigation.is_full() => return false,
            OuterPhase::Idle => return false,
            OuterPhase::Observe => Stage::Predict,
            OuterPhase::Feel => Stage::Feel,
            OuterPhase::Fly => Stage::Judge,
            OuterPhase::Locate => Stage::Locate,
        };
        let reference = situation.setpoints.reference;
        let intent = Intent {
            tension: self.state.actuation.winch.tension,
            dither: situation.setpoints.dither,
            velocity: reference.map_or(World(V3::zeros()), |reference| reference.velocity),
        };
        let navigation = &self.config.navigation;
        navigation.advance(&mut situation.navigation, stage, &intent);
        if stage != Stage::Judge {
            return false;
        }
        situation.estimate = navigation.estimate(&situation.navigation);
        true
    }

    fn receive_rod(&mut self, sensors: &Sensors<S>) {
        if let (Some(sample), Some(config)) = (&sensors.rod, &self.config.modes.pendulum) {
            config.receive(&mut self.situation.rod, sample, &self.situation.estimate);
        }
    }

    fn observe_rod(&mut self, now: Micros) {
        let situation = &mut self.situation;
        match &self.config.modes.pendulum {
            Some(config) => config.observe(&mut situation.rod, &situation.estimate, now),
            None => situation.rod = None,
        }
    }

    /// Runs the taut-link observer in the air, whatever the mode, so that it has converged when it is wanted.
    fn observe_link(&mut self) {
        let situation = &mut self.situation;
        let is_airborne = situation.navigation.is_airborne();
        let Some(taut) = self.config.modes.taut.as_ref().filter(|_| is_airborne) else {
            situation.taut = TautEstimatorState::default();
            return;
        };
        let (roll, ..) = situation.estimate.attitude.euler();
        let input = TautInput {
            imu: situation.inertial_mean(),
            thrust: situation.estimate.thrust,
            roll,
            purpose: self.mode.purpose().unwrap_or_default(),
        };
        taut.estimator.step(&mut situation.taut, &input);
    }
}
