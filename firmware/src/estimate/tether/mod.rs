//! The first simple estimator, whole: attitude (Mahony), position and tension (4-state EKF),
//! velocity (complementary), with its start-up. `fullstate` sections 6 and 10.

mod free;

use super::capture::{CaptureFilter, CaptureState};
use super::{
    Ekf4, Ekf4Measurement, Ekf4State, Innovations, LevelState, Leveller, Mahony, MahonyState,
    ThrustModel, ThrustModelState, VelocityFilter, VelocityState, VerticalFilter, VerticalState,
};
use crate::frames::{Attitude, Body, V3, World};
use crate::math::filter::{Biquad, first_order};
use crate::math::{GRAVITY, so3};
use crate::model::LinkKind;
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::{Estimate, FilterHealth, Imu, ROTORS, Sensors, SphericalPoint, TetherState};
use crate::time::{DECIMATION, Micros, OUTER_DT, Sample};

/// Height over the ground at which the filter starts, m.
const START_HEIGHT: f64 = 0.12;
/// Or this long after thrust exceeded weight, in filter steps (0.25 s).
const START_STEPS: u16 = 62;
/// Pull that ends slackness, N, and for how many steps it, or its lack, must last.
const TAUT_TENSION: f64 = 1.6;
const TAUT_STEPS: u16 = 15;
const SLACK_STEPS: u16 = 38;

/// What the vehicle is doing, as far as the estimator must know.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// On the ground, motors off.
    Resting,
    /// Motors turn; perhaps still on the ground.
    Powered,
    /// The feet touch after a flight: the ground's push is in no model, so the position stands still.
    Touching,
}

/// Configuration.
#[derive(Clone, Copy, Debug)]
pub struct TetherEstimator<S: Scalar> {
    mahony: Mahony<S>,
    ekf: Ekf4<S>,
    velocity: VelocityFilter<S>,
    /// Instead of the two above, without a tether.
    capture: Option<CaptureFilter<S>>,
    vertical: VerticalFilter<S>,
    thrust: ThrustModel<S>,
    leveller: Leveller<S>,
    start: World<V3<S>>,
    start_tension: S,
    has_winch: bool,
    /// Always taut, and tension may be negative.
    is_rigid: bool,
    fixed_length: S,
    ground_height: S,
    slack_tension: S,
    divergence_ratio: S,
    divergence_steps: u16,
}

/// Sums over the IMU samples of one filter step.
#[derive(Clone, Copy, Debug)]
struct Decimator<S: Scalar> {
    count: u8,
    gyro: V3<S>,
    accel: V3<S>,
    thrust: S,
}

impl<S: Scalar> Default for Decimator<S> {
    fn default() -> Self {
        Self { count: 0, gyro: V3::zeros(), accel: V3::zeros(), thrust: S::zero() }
    }
}

/// What finds the position in the air.
#[derive(Clone, Copy, Debug)]
enum Airborne<S: Scalar> {
    /// The tether.
    Tether(Ekf4State<S>, VelocityState<S>),
    /// Motion capture, which runs on the ground too.
    Free,
}

/// What moves.
#[derive(Clone, Copy, Debug)]
pub struct TetherEstimatorState<S: Scalar> {
    decimator: Decimator<S>,
    thrust: ThrustModelState<S>,
    level: LevelState<S>,
    /// `None` until levelled.
    attitude: Option<MahonyState<S>>,
    vertical: VerticalState<S>,
    altitude_at: Option<Micros>,
    /// `None` until lift-off.
    filter: Option<Airborne<S>>,
    /// `None` until the first sample.
    capture: Option<CaptureState<S>>,
    now: Micros,
    place: World<V3<S>>,
    lift_steps: u16,
    pending_altitude: Option<S>,
    pending_length: Option<S>,
    is_taut: bool,
    taut_steps: u16,
    health: FilterHealth<S>,
    failed_steps: u16,
    rate: V3<S>,
    last_thrust: S,
    average: Imu<S>,
}

impl<S: Scalar> TetherEstimator<S> {
    /// From the parameters and the accelerometer's filter at the IMU's rate.
    #[must_use]
    #[inline(never)]
    pub fn new(p: &Params, accel_filter: Biquad<S>, imu_rate_hz: f32) -> Self {
        let kind = LinkKind::from_parameter(p.tether_kind);
        let has_winch = kind.has_winch();
        let ground = p.ground_height;
        let distance = if has_winch {
            p.start_distance
        } else {
            // Also from a slack start: the filter begins when the link has become taut.
            libm::sqrtf((p.tether_length * p.tether_length - ground * ground).max(0.01))
        };
        let (sin, cos) = S::from_f32(p.start_heading).sin_cos();
        let out = S::from_f32(distance);
        Self {
            mahony: Mahony { kp: S::from_f32(p.mahony_kp), ki: S::from_f32(p.mahony_ki) },
            ekf: Ekf4 {
                mass: S::from_f32(p.mass),
                q_position: S::from_f32(p.ekf_q_position),
                q_tension: S::from_f32(p.ekf_q_tension),
                r_accel: S::from_f32(p.ekf_r_accel),
                r_altitude: S::from_f32(p.ekf_r_altitude),
                r_length: S::from_f32(p.ekf_r_length),
            },
            velocity: VelocityFilter { gain: S::from_f32(p.velocity_gain) },
            capture: kind.is_free().then(|| CaptureFilter::new(p)),
            vertical: VerticalFilter { bandwidth: S::lit(3.0), fade: S::lit(5.0) },
            thrust: ThrustModel {
                lag: first_order(p.motor_tau, 1.0 / imu_rate_hz),
                scale: S::from_f32(p.thrust_scale),
                filter: accel_filter,
            },
            leveller: Leveller {
                samples: (p.levelling_time * imu_rate_hz) as u32,
                heading: S::from_f32(p.start_heading),
            },
            start: World(V3::new(out * cos, out * sin, -S::from_f32(ground))),
            start_tension: S::from_f32(p.tension_low),
            has_winch,
            is_rigid: kind.is_rigid(),
            fixed_length: S::from_f32(p.tether_length),
            ground_height: S::from_f32(ground),
            slack_tension: S::from_f32(p.slack_tension),
            divergence_ratio: S::from_f32(p.divergence_ratio),
            divergence_steps: (p.divergence_time / OUTER_DT as f32) as u16,
        }
    }

    /// Nothing known but the place to start from.
    #[must_use]
    pub fn start(&self) -> TetherEstimatorState<S> {
        TetherEstimatorState {
            decimator: Decimator::default(),
            thrust: ThrustModelState::default(),
            level: LevelState::default(),
            attitude: None,
            vertical: VerticalState { height: self.ground_height, climb: S::zero() },
            altitude_at: None,
            filter: None,
            capture: None,
            now: Micros::default(),
            place: self.start,
            lift_steps: 0,
            pending_altitude: None,
            pending_length: None,
            is_taut: true,
            taut_steps: 0,
            health: FilterHealth::default(),
            failed_steps: 0,
            rate: V3::zeros(),
            last_thrust: S::zero(),
            average: Imu { gyro: Body(V3::zeros()), accel: Body(V3::zeros()) },
        }
    }

    /// One step with what arrived; true when the 250 Hz part ran.
    pub fn step(
        &self,
        state: &mut TetherEstimatorState<S>,
        sensors: &Sensors<S>,
        commanded: &[S; ROTORS],
        phase: Phase,
    ) -> bool {
        if let Some(altitude) = sensors.altitude {
            let dt = state.altitude_at.map_or(0.02, |at| altitude.at.seconds_since(at).min(0.1));
            self.vertical.correct(&mut state.vertical, altitude.value, S::from_f32(dt));
            state.altitude_at = Some(altitude.at);
            state.pending_altitude = Some(altitude.value);
        }
        if let Some(length) = sensors.tether_length {
            state.pending_length = Some(length.value);
        }
        if let (Some(capture), Some(sample)) = (&self.capture, &sensors.capture) {
            match &mut state.capture {
                Some(known) => capture.correct(known, sample),
                slot => *slot = Some(capture.start(sample)),
            }
            if let Some(heading) = sample.value.heading {
                self.turn(state, heading);
            }
        }
        let Some(Sample { at, value: imu }) = sensors.imu else {
            return false;
        };
        state.now = at;
        let thrust = self.thrust.step(&mut state.thrust, commanded);
        let Some(attitude) = &mut state.attitude else {
            if phase == Phase::Resting {
                state.attitude = self.leveller.step(&mut state.level, &imu);
            }
            return false;
        };
        state.rate = imu.gyro.0 - attitude.gyro_bias.0;
        let sums = &mut state.decimator;
        sums.count += 1;
        sums.gyro += imu.gyro.0;
        sums.accel += imu.accel.0;
        sums.thrust += thrust;
        if sums.count < DECIMATION {
            return false;
        }
        let mean = S::lit(1.0 / DECIMATION as f64);
        let imu = Imu { gyro: Body(sums.gyro * mean), accel: Body(sums.accel * mean) };
        state.last_thrust = sums.thrust * mean;
        state.average = imu;
        state.decimator = Decimator::default();
        self.filter_step(state, &imu, sensors, phase);
        true
    }

    fn filter_step(
        &self,
        state: &mut TetherEstimatorState<S>,
        imu: &Imu<S>,
        sensors: &Sensors<S>,
        phase: Phase,
    ) {
        let dt = S::lit(OUTER_DT);
        let on_ground = state.filter.is_none();
        let Some(attitude) = &mut state.attitude else {
            return;
        };
        let mahony =
            Mahony { ki: if on_ground { S::zero() } else { self.mahony.ki }, ..self.mahony };
        // A refused step keeps the attitude; the IMU's own checks raise the fault.
        let _ = mahony.step(attitude, &imu.gyro, &imu.accel, dt);
        let attitude = attitude.attitude;
        let force = attitude.to_world(imu.accel);
        let accel_up = -(force.0.z + S::lit(GRAVITY));
        self.vertical.predict(&mut state.vertical, accel_up, dt, sensors.altitude_is_fresh);

        if let (Some(capture), Some(known)) = (&self.capture, &mut state.capture) {
            capture.predict(known, &force);
        }

        match phase {
            Phase::Resting => self.rest(state),
            Phase::Powered if on_ground => self.watch_lift_off(state),
            Phase::Powered => {}
            Phase::Touching => return,
        }
        let altitude = state.pending_altitude.take();
        let length = state.pending_length.take();
        let Some(Airborne::Tether(ekf, velocity)) = &mut state.filter else {
            return;
        };
        let z = Ekf4Measurement {
            attitude,
            accel: imu.accel,
            thrust: state.last_thrust,
            altitude,
            length: if self.has_winch {
                length
            } else {
                state.is_taut.then_some(self.fixed_length)
            },
        };
        if let Ok(nu) = self.ekf.step(ekf, &z) {
            let position = World(ekf.position());
            self.velocity.step(velocity, &force, &position, dt);
            let (tension, distance) = (ekf.tension(), so3::norm(&position.0));
            self.judge(state, &nu, tension, distance);
        } else {
            state.failed_steps = state.failed_steps.saturating_add(1);
        }
    }

    /// On the ground the place is known: where the vehicle was put, or where it landed.
    fn rest(&self, state: &mut TetherEstimatorState<S>) {
        if let Some(Airborne::Tether(ekf, _)) = state.filter.take() {
            let landed = ekf.position();
            state.place = World(V3::new(landed.x, landed.y, -self.ground_height));
        }
        state.lift_steps = 0;
        state.is_taut = true;
        state.taut_steps = 0;
        state.failed_steps = 0;
        state.health = FilterHealth::default();
        state.vertical.climb = S::zero();
    }

    /// Ground contact is not in the model: the filter starts when the vehicle has left it.
    fn watch_lift_off(&self, state: &mut TetherEstimatorState<S>) {
        let rising = state.vertical.height > self.ground_height + S::lit(START_HEIGHT);
        if state.last_thrust > self.ekf.mass * S::lit(GRAVITY) + self.start_tension * S::lit(0.5) {
            state.lift_steps += 1;
        }
        if rising || state.lift_steps > START_STEPS {
            if self.capture.is_some() {
                state.filter = Some(Airborne::Free);
                return;
            }
            let mut place = state.place;
            place.0.z = -state.vertical.height;
            if !self.has_winch {
                // On the sphere, whatever the height at which the link became taut.
                let side = so3::norm(&V3::new(place.0.x, place.0.y, S::zero()));
                let square = self.fixed_length * self.fixed_length - place.0.z * place.0.z;
                let share = square.sqrt() / side.max(S::lit(0.1));
                place.0.x *= share;
                place.0.y *= share;
            }
            state.filter = Some(Airborne::Tether(
                Ekf4State::at(place.0, self.start_tension),
                VelocityState::at(place),
            ));
        }
    }

    fn judge(
        &self,
        state: &mut TetherEstimatorState<S>,
        nu: &Innovations<S>,
        tension: S,
        distance: S,
    ) {
        let follow = |mean: &mut S, k: f64, sample: S| *mean += (sample - *mean) * S::lit(k);
        if let Some(accel) = nu.accel {
            follow(&mut state.health.accel, 0.004, accel);
        }
        if let Some(altitude) = nu.altitude {
            follow(&mut state.health.altitude, 0.02, altitude);
        }
        if let Some(length) = nu.length {
            follow(&mut state.health.length, 0.008, length);
        }
        let h = &state.health;
        let far = !self.has_winch && distance > self.fixed_length * S::lit(1.5);
        let failed = nu.accel.is_none()
            || h.accel > self.divergence_ratio
            || h.altitude > self.divergence_ratio
            || h.length > self.divergence_ratio
            || (tension < S::lit(-3.0) && !self.is_rigid)
            || far;
        state.failed_steps = if failed { state.failed_steps.saturating_add(1) } else { 0 };

        let (crossed, needed) = if state.is_taut {
            (tension < self.slack_tension && !self.is_rigid, SLACK_STEPS)
        } else {
            (tension > S::lit(TAUT_TENSION), TAUT_STEPS)
        };
        state.taut_steps = if crossed { state.taut_steps + 1 } else { 0 };
        if state.taut_steps >= needed {
            state.is_taut = !state.is_taut;
            state.taut_steps = 0;
        }
    }

    /// Angular rate with the bias removed, as of the last inertial sample.
    #[must_use]
    pub fn rate(&self, state: &TetherEstimatorState<S>) -> Body<V3<S>> {
        Body(state.rate)
    }

    /// Acting over modelled thrust.
    pub fn set_thrust_scale(&mut self, scale: S) {
        self.thrust.scale = scale;
    }

    /// What is known now.
    #[must_use]
    pub fn estimate(&self, state: &TetherEstimatorState<S>) -> Estimate<S> {
        let level = MahonyState::new(Attitude::level(self.leveller.heading), Body(V3::zeros()));
        let attitude = state.attitude.unwrap_or(level);
        let has_diverged = state.failed_steps > self.divergence_steps;
        let known = state.attitude.is_some() && !has_diverged;
        if let Some(capture) = &self.capture {
            return self.free_estimate(capture, state, attitude);
        }
        let (position, velocity, tension, sd) = match &state.filter {
            Some(Airborne::Tether(ekf, velocity)) => {
                let c = &ekf.covariance;
                let sd = V3::new(c.m11.sqrt(), c.m22.sqrt(), c.m33.sqrt());
                (World(ekf.position()), velocity.velocity, ekf.tension(), sd)
            }
            _ => {
                let sd = V3::repeat(S::lit(0.3));
                (state.place, World(V3::zeros()), S::zero(), sd)
            }
        };
        let place = SphericalPoint::from_world(&position);
        Estimate {
            position: known.then_some(position),
            velocity: known.then_some(velocity),
            tether: known.then_some(TetherState {
                elevation: place.elevation,
                azimuth: place.azimuth,
                length: place.length,
                tension,
                is_taut: state.is_taut,
            }),
            position_sd: sd,
            has_diverged,
            ..self.without_place(state, attitude)
        }
    }

    fn without_place(
        &self,
        state: &TetherEstimatorState<S>,
        attitude: MahonyState<S>,
    ) -> Estimate<S> {
        Estimate {
            attitude: attitude.attitude,
            rate: Body(state.rate),
            gyro_bias: attitude.gyro_bias,
            height: state.vertical.height,
            climb: state.vertical.climb,
            position: None,
            velocity: None,
            tether: None,
            position_sd: V3::zeros(),
            thrust: state.last_thrust,
            health: state.health,
            is_levelled: state.attitude.is_some(),
            has_diverged: false,
        }
    }
}

impl<S: Scalar> TetherEstimatorState<S> {
    /// Forgets level and bias, so that they are taken again.
    pub fn relevel(&mut self) {
        self.attitude = None;
        self.level = LevelState::default();
    }
    /// Moves the vehicle to the place from which the (new) configuration starts.
    pub fn replace(&mut self, config: &TetherEstimator<S>) {
        self.place = config.start;
    }
    /// Inertial reading averaged over the last 250 Hz step, gyro bias not removed.
    #[must_use]
    pub fn average(&self) -> &Imu<S> {
        &self.average
    }
    /// Whether the position filter runs: the vehicle has left the ground.
    #[must_use]
    pub fn is_airborne(&self) -> bool {
        self.filter.is_some()
    }
}
