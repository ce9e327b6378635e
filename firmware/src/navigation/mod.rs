//! Where is the vehicle, how does it sit, how hard does the tether pull? A question a file: `alignment`
//! (attitude), `lift_off`, `position` (the filter in the air; `tethered`,
//! `full_state`), `slackness`, `divergence`. Sensors in, an
//! [`Estimate`] out; the filters themselves stand in [`crate::estimate`].

mod alignment;
mod compass;
mod decimator;
mod divergence;
mod drift;
mod full_state;
mod heading;
mod lift_off;
mod payout;
mod position;
mod shake;
mod slackness;
mod state;
mod tethered;

pub use full_state::Intent;
pub use tethered::Stage;

use crate::estimate::{ThrustModel, ThrustModelState, VerticalFilter, VerticalState};
use crate::frames::{Body, V3, World};
use crate::math::GRAVITY;
use crate::math::filter::{Biquad, first_order};
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::{AidReport, Capture, Estimate, FilterHealth, Imu, PositionSource, Sensors};
use crate::time::{Micros, OUTER_DT, Sample};
use alignment::{Alignment, AlignmentState, Stance};
use compass::Compass;
use decimator::Decimator;
use drift::Drift;
use full_state::Height;
use heading::HeadingDrift;
use lift_off::{LiftOff, LiftOffState};
use payout::{Inertia, PayoutState};
use position::{PositionFilter, PositionFilterState};
use shake::Shake;
use tethered::{StageInput, TetheredInput};

/// Over this height the feet can't touch, m.
pub(crate) const CLEAR: f64 = 0.3;
/// From one count of the heading's drift to the next: 1 s.
const HEADING_STEPS: u8 = 250;
/// Of a compass at rest, at 250 Hz, rad, and of what an operator says.
const RESTING_COMPASS_SD: f64 = 0.5;
const TOLD_SD: f64 = 0.05;

/// What the vehicle is doing, as far as the filters must know.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// On the ground, motors off.
    Resting,
    /// Motors turn; perhaps still on the ground.
    Powered,
    /// The feet touch after a flight: the ground's push is in no model, so the position stands still.
    Touching,
}

/// Share of a step of the specific force that tells the vertical: an eighth of a second.
const SLOW_SHARE: f64 = 0.03;
/// Share of a step of what acts beside the thrust: a second.
const BESIDE_SHARE: f64 = 0.004;

/// Configuration.
#[derive(Clone, Copy, Debug)]
pub struct Navigation<S: Scalar> {
    alignment: Alignment<S>,
    compass: Compass<S>,
    vertical: VerticalFilter<S>,
    steady: VerticalFilter<S>,
    thrust: ThrustModel<S>,
    lift_off: LiftOff<S>,
    position: PositionFilter<S>,
    ground_height: S,
    /// 1/kg.
    per_mass: S,
}

/// What moves.
#[derive(Clone, Copy, Debug)]
pub struct NavigationState<S: Scalar> {
    decimator: Decimator<S>,
    thrust: ThrustModelState<S>,
    alignment: AlignmentState<S>,
    vertical: VerticalState<S>,
    lift_off: LiftOffState<S>,
    position: PositionFilterState<S>,
    /// What is not seen of the azimuth, and steps until it is counted again.
    heading: HeadingDrift<S>,
    heading_steps: u8,
    now: Micros,
    altitude_at: Option<Micros>,
    pending_altitude: Option<S>,
    payout: PayoutState<S>,
    /// Of the encoder, until the filter's next step: no other millisecond has the time for it.
    shown_length: Option<Sample<S>>,
    pending_length: Option<Sample<S>>,
    pending_place: Option<Sample<Capture<S>>>,
    pending_velocity: Option<Sample<Body<V3<S>>>>,
    rate: V3<S>,
    last_thrust: S,
    average: Imu<S>,
    /// Specific force beside the thrust's, low-passed, body axes, m/s².
    beside_thrust: V3<S>,
    drift: Drift<S>,
    shake: Shake<S>,
    /// Specific force, world axes, low-passed, m/s².
    slow_force: Option<V3<S>>,
    /// The position filter has diverged and not proven itself since: its attitude is not flown by.
    is_doubted: bool,
    /// By the accelerometer, m/s².
    accel_up: S,
    /// What the altimeter alone says.
    steady: VerticalState<S>,
    /// Asked of the winch in the last step, N.
    asked_tension: S,
    is_numb: bool,
}

impl<S: Scalar> Navigation<S> {
    /// From the parameters and the accelerometer's filter at the IMU's rate.
    #[inline(never)]
    #[must_use]
    pub fn new(p: &Params, accel_filter: Biquad<S>, imu_rate_hz: f32) -> Self {
        Self {
            alignment: Alignment::new(p, imu_rate_hz),
            compass: Compass::new(p),
            vertical: VerticalFilter { bandwidth: S::lit(3.0), fade: S::lit(5.0) },
            steady: VerticalFilter { bandwidth: S::lit(2.5), fade: S::lit(5.0) },
            thrust: ThrustModel {
                lag: first_order(p.motor_tau, 1.0 / imu_rate_hz),
                scale: S::from_f32(p.thrust_scale),
                filter: accel_filter,
            },
            lift_off: LiftOff::new(p),
            position: PositionFilter::new(p),
            ground_height: S::from_f32(p.ground_height),
            per_mass: S::from_f32(1.0 / p.mass),
        }
    }

    /// Nothing known but the place to start from.
    #[must_use]
    pub fn start(&self) -> NavigationState<S> {
        NavigationState {
            decimator: Decimator::default(),
            thrust: ThrustModelState::default(),
            alignment: AlignmentState::default(),
            vertical: VerticalState { height: self.ground_height, ..VerticalState::default() },
            lift_off: LiftOffState::default(),
            position: self.position.start(),
            heading: HeadingDrift::new(S::zero()),
            heading_steps: HEADING_STEPS,
            now: Micros::default(),
            altitude_at: None,
            pending_altitude: None,
            payout: PayoutState::new(),
            shown_length: None,
            pending_length: None,
            pending_place: None,
            pending_velocity: None,
            rate: V3::zeros(),
            last_thrust: S::zero(),
            average: Imu { gyro: Body(V3::zeros()), accel: Body(V3::zeros()) },
            beside_thrust: V3::zeros(),
            drift: Drift::default(),
            shake: Shake::default(),
            slow_force: None,
            is_doubted: false,
            accel_up: S::zero(),
            steady: VerticalState::default(),
            asked_tension: S::zero(),
            is_numb: false,
        }
    }

    /// One step with what arrived; true when the 250 Hz part ran.
    pub fn step(
        &self,
        state: &mut NavigationState<S>,
        sensors: &Sensors<S>,
        commanded: &[S],
        phase: Phase,
    ) -> bool {
        self.receive(state, sensors);
        let Some(Sample { at, value: imu }) = sensors.imu else {
            return false;
        };
        state.now = at;
        let thrust = self.thrust.step(&mut state.thrust, commanded);
        let Some(attitude) = &state.alignment.attitude else {
            if phase == Phase::Resting {
                self.alignment.level(&mut state.alignment, &imu);
                state.heading = HeadingDrift::new(S::from_f32(sensors.imu_temperature));
                let field = sensors.line.magnetic;
                if let Some(levelled) = &mut state.alignment.attitude
                    && let Some(off) = self.compass.deviation(&levelled.attitude, field)
                {
                    alignment::turn(levelled, off);
                }
            }
            return false;
        };
        state.rate = imu.gyro.0 - attitude.gyro_bias.0;
        let Some((mean, thrust)) = state.decimator.add(&imu, thrust) else {
            return false;
        };
        (state.average, state.last_thrust) = (mean, thrust);
        self.filter(state, sensors, phase);
        true
    }

    /// What comes slower than the inertial samples.
    fn receive(&self, state: &mut NavigationState<S>, sensors: &Sensors<S>) {
        if let Some(altitude) = sensors.altitude {
            let dt = state.altitude_at.map_or(0.02, |at| altitude.at.seconds_since(at).min(0.1));
            let dt = S::from_f32(dt);
            self.vertical.correct(&mut state.vertical, altitude.value, dt);
            // Without inertia.
            state.steady.height += state.steady.climb * dt;
            self.steady.correct(&mut state.steady, altitude.value, dt);
            state.steady.bias = S::zero();
            state.altitude_at = Some(altitude.at);
            state.pending_altitude = Some(altitude.value);
        }
        state.shown_length = sensors.tether_length.or(state.shown_length);
        state.pending_place = sensors.capture.or(state.pending_place);
        state.pending_velocity = sensors.velocity.or(state.pending_velocity);
        if let Some(sample) = &sensors.capture
            && self.position.receive(&mut state.position, sample)
            && let Some(heading) = sample.value.heading
        {
            let on_ground = !state.position.is_airborne();
            self.alignment.turn(&mut state.alignment, heading, on_ground);
        }
    }

    fn filter(&self, state: &mut NavigationState<S>, sensors: &Sensors<S>, phase: Phase) {
        state.count_heading(sensors);
        let dt = S::lit(OUTER_DT);
        let on_ground = !state.position.is_airborne();
        let Some(sit) = &mut state.alignment.attitude else {
            return;
        };
        state.shake.step(&state.average.accel.0);
        // What the thrust does, and what else acted when that was last felt.
        let thrust = V3::new(S::zero(), S::zero(), -state.last_thrust * self.per_mass);
        state.is_numb = !sensors.accel_is_believed;
        if sensors.accel_is_believed {
            let rest = state.average.accel.0 - thrust;
            state.beside_thrust += (rest - state.beside_thrust) * S::lit(BESIDE_SHARE);
        } else {
            state.average.accel = Body(thrust + state.beside_thrust);
        }
        let imu = state.average;
        let stance = match phase {
            _ if !on_ground => Stance::Airborne,
            Phase::Powered if self.lift_off.is_light(state.last_thrust) => Stance::Light,
            _ => Stance::Standing,
        };
        // Its direction is what counts: what shakes two axes at once would lean it, so it is averaged before. One that
        // is not believed says nothing of the attitude, as if it felt the weight alone.
        let rest = World(V3::new(S::zero(), S::zero(), -S::lit(GRAVITY)));
        let felt = sit.attitude.to_world(imu.accel);
        let slow = state.slow_force.get_or_insert(felt.0);
        *slow += (felt.0 - *slow) * S::lit(SLOW_SHARE);
        let upward = if sensors.accel_is_believed { World(*slow) } else { rest };
        let upright = sit.attitude.to_body(upward);
        self.alignment.step(sit, &Imu { gyro: imu.gyro, accel: upright }, stance, dt);
        let field = sensors.line.magnetic.filter(|_| on_ground);
        if let Some(deviation) = self.compass.deviation(&sit.attitude, field) {
            Alignment::follow(sit, deviation);
            state.heading.see(S::lit(RESTING_COMPASS_SD));
        }
        let force = sit.attitude.to_world(imu.accel);
        let accel_up = -(force.0.z + S::lit(GRAVITY));
        state.drift.step(&force, dt);
        state.accel_up = accel_up;
        self.vertical.predict(&mut state.vertical, accel_up, dt, sensors.altitude_is_fresh);
        self.position.predict(&mut state.position, &force);
        let inertia = Inertia {
            is_known: sensors.accel_is_believed && !sensors.imu_is_held,
            error: sensors.altitude_error,
        };
        state.payout.predict(state.position.outwards(&force), &inertia, dt);
        let paid_out = state.shown_length.take().and_then(|shown| state.payout.step(shown));
        state.pending_length = paid_out.or(state.pending_length);
        match phase {
            Phase::Resting => {
                if let Some(attitude) = self.position.rest(&mut state.position) {
                    sit.attitude = attitude;
                }
                state.lift_off = LiftOffState::default();
                state.vertical.climb = S::zero();
                state.drift = Drift::default();
            }
            Phase::Powered if on_ground => {
                let height = state.vertical.height;
                if self.lift_off.step(&mut state.lift_off, height, state.last_thrust, &force) {
                    let LiftOffState { slid, mut velocity, .. } = state.lift_off;
                    velocity.z = -state.vertical.climb;
                    let velocity = World(velocity);
                    self.position.lift_off(&mut state.position, height, &slid, velocity, sit);
                }
            }
            Phase::Powered => {}
            Phase::Touching => {
                if let Some(attitude) = state.position.touch() {
                    sit.attitude = attitude;
                }
                return;
            }
        }
        let z = TetheredInput {
            sit,
            accel: imu.accel,
            force,
            thrust: state.last_thrust,
            altitude: state
                .pending_altitude
                .take()
                .map(|value| Height { value, is_ranged: sensors.altitude_is_ranged }),
            length: state.pending_length.take(),
            accel_is_believed: sensors.accel_is_believed,
            shake: state.shake.variance,
            line: &sensors.line,
            place: state.pending_place.take(),
            velocity: state.pending_velocity.take(),
        };
        self.position.step(&mut state.position, &z);
    }

    /// A part of the step that the full-state filter does in a later millisecond.
    pub fn advance(&self, state: &mut NavigationState<S>, stage: Stage, intent: &Intent<S>) {
        if stage == Stage::Predict {
            state.ask(intent.tension);
        }
        let Some(sit) = &state.alignment.attitude else {
            return;
        };
        let thrust = state.last_thrust / self.thrust.scale;
        let is_clear = state.vertical.height > self.ground_height + S::lit(CLEAR);
        let z = StageInput { imu: &state.average, thrust, intent, is_clear, sit };
        if let Some(attitude) = self.position.advance(&mut state.position, stage, &z) {
            let (.., yaw) = attitude.euler();
            self.alignment.turn(&mut state.alignment, yaw, false);
        }
    }

    /// Angular rate with the bias removed, as of the last inertial sample.
    #[must_use]
    pub fn rate(&self, state: &NavigationState<S>) -> Body<V3<S>> {
        Body(state.rate)
    }

    /// Acting over modelled thrust.
    pub fn set_thrust_scale(&mut self, scale: S) {
        self.thrust.scale = scale;
    }

    /// What is known now.
    #[must_use]
    pub fn estimate(&self, state: &NavigationState<S>) -> Estimate<S> {
        let attitude = self.alignment.attitude(&state.alignment);
        let placeless = Estimate {
            attitude: state
                .position
                .attitude()
                .filter(|_| !state.is_doubted)
                .unwrap_or(attitude.attitude),
            rate: Body(state.rate),
            gyro_bias: attitude.gyro_bias,
            height: state.vertical.height,
            climb: state.vertical.climb,
            altitude_rate: state.steady.climb,
            vibration: state.shake.variance.sqrt(),
            position: None,
            velocity: None,
            tether: None,
            position_sd: V3::zeros(),
            heading_sd: S::zero(),
            length_jumps: state.payout.jumps,
            length_is_stuck: state.payout.is_stuck,
            air_force: World(V3::zeros()),
            thrust_scale: S::one(),
            pull: None,
            restarts: 0,
            gyro_changes: 0,
            tether_is_gone: false,
            aids: AidReport::default(),
            source: PositionSource::None,
            thrust: state.last_thrust,
            health: FilterHealth::default(),
            is_levelled: state.alignment.attitude.is_some(),
            has_diverged: false,
        };
        let known = self.position.complete(&state.position, placeless, state.now);
        state.unsure_of_heading(known)
    }
}
