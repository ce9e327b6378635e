//! The full-state filter in flight: when it starts, what it is fed in which order, and when it is made anew
//! (`fullstate` sections 6 to 8, 24 and 29).
//!
//! A step is spread over the milliseconds between two means of the inertial samples: `predict`,
//! `feel`, `judge`, `locate`.

mod aids;
mod answer;
mod gyro;
mod health;
mod line;
mod outwards;
mod rows;
mod slack;

pub(super) use aids::Readings;

use super::position::Found;
use crate::estimate::MahonyState;
use crate::estimate::full_state::{
    Densities, FullState, FullStateFilter, FullStateModel, GYRO_BIAS, Load, POSITION, PushDetector,
    SCALARS, Sag, StartDeviation, TILT, VELOCITY,
};
use crate::frames::{V3, World};
use crate::math::filter::{Biquad, Biquad3State, BiquadState};
use crate::math::so3;
use crate::model::{Line, TetherKind};
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::{Imu, PositionSource};
use crate::time::{OUTER_DT, Sample};
use aids::{Aids, AidsState};
use answer::Answer;
use gyro::GyroDoubt;
use health::FullHealth;
use slack::{FixedLine, FixedLineState};

/// A direction from anchor to vehicle needs a line of this length, m.
const LENGTH_FLOOR: f64 = 0.3;
/// Of a fixed length's chord with its stretch moving, m, and at rest, taken on about every other step.
const FIXED_SD: f64 = 0.12;
const FIXED_SD_STILL: f64 = 0.06;
/// How a barometer's height drifts, m/√s.
const BAROMETER_WALK: f64 = 0.02;
/// Share of a new payout rate, at 50 Hz.
const RATE_SHARE: f64 = 0.18;
/// With a line shorter than this, m, what is across it changes fast.
const NEAR: f64 = 5.0;
/// At lift-off, levelled and integrated from standing: place, m, velocity, m/s, tilt, rad.
const START_PLACE_SD: f64 = 0.25;
const START_VELOCITY_SD: f64 = 0.3;
const START_TILT_SD: f64 = 0.008;
/// The gyro's axis along the thrust is steadier than `fullstate` takes it for, and where nothing measures the heading,
/// errors of the other rows turn it the more the noisier it is. Shares of the other axes' noise and of its bias' deviation.
const YAW_SHARE: f64 = 0.2;
const YAW_BIAS_SHARE: f64 = 0.3;
/// After a restart: place, m, and velocity, m/s; least pull, N.
const RESTART_PLACE_SD: f64 = 1.0;
const RESTART_VELOCITY_SD: f64 = 0.5;
const RESTART_TENSION: f64 = 1.0;
/// The gyro may be why, rad/s.
const RESTART_BIAS_SD: f64 = 0.015;
/// So many times the accelerometer's own variance no push can be told from it.
const SHAKEN: f64 = 3.0;
/// A restart counts for so long, s, and so many at once mean that nothing helps.
const HEAT_TIME: f64 = 10.0;
const HEAT_MAX: f64 = 2.0;
/// In which the mean wind's force goes to nothing, s. With the 300 s of `fullstate` a wind that blows for an hour becomes a
/// tilt of two degrees.
const WIND_TIME: f64 = 3e4;
/// Force of the air over mass, m/s², from which gusts are more than the filter believes, and the lateral variance then:
/// `fullstate` sections 25 and 30.
const WINDY: f64 = 0.3;
const WINDY_VARIANCE: f64 = 1.4;

/// Configuration.
#[derive(Clone, Copy, Debug)]
pub(super) struct FullFlight<S: Scalar> {
    filter: FullStateFilter<S>,
    aids: Aids<S>,
    /// The line's weight does not bend it to speak of.
    is_straight: bool,
    start: StartDeviation<S>,
    restart: StartDeviation<S>,
    /// Of accelerometer and thrust alike: what rotors shake looks like a pull that moves.
    low_pass: Biquad<S>,
    altimeter_sd: S,
    /// `None` with a winch.
    fixed_line: Option<FixedLine<S>>,
    fixed_sd: S,
    start_tension: S,
}

/// What moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct FullFlightState<S: Scalar> {
    pub state: FullState<S>,
    line: FixedLineState<S>,
    aids: AidsState<S>,
    health: FullHealth<S>,
    gyro: GyroDoubt<S>,
    /// Since lift-off.
    pub restarts: u16,
    /// The feet touch: the state stands still.
    pub is_touching: bool,
    answer: Answer<S>,
    /// The line does not hold the vehicle any more.
    is_gone: bool,
    push: PushDetector<S>,
    accel: Biquad3State<S>,
    thrust: Option<BiquadState<S>>,
    altitude: Option<Height<S>>,
    /// The height comes from the barometer.
    is_barometric: bool,
    payout: Option<Payout<S>>,
    /// The length has had its turn.
    is_rate_next: bool,
    /// Restarts lately.
    heat: S,
    load: Load<S>,
    /// Of the accelerometer, behind the low-pass.
    reading: V3<S>,
    /// It is not believed.
    pub is_numb: bool,
    /// Along the line, low-passed, N.
    pull: S,
    /// Variance of what shakes it behind the low-pass, m²/s⁴.
    pub shake: S,
    /// Counts steps, for rows that do not come at each.
    tick: u8,
    /// A part of the step was refused.
    has_failed: bool,
}

/// Over the anchor.
#[derive(Clone, Copy, Debug)]
pub(super) struct Height<S> {
    /// m.
    pub value: S,
    /// By the rangefinder, not by the barometer.
    pub is_ranged: bool,
}

/// Line that is out of a winch.
#[derive(Clone, Copy, Debug)]
struct Payout<S> {
    last: Sample<S>,
    /// m/s.
    rate: S,
    is_new: bool,
}

/// What the vehicle wants and the filter believes without a measurement.
#[derive(Clone, Copy, Debug)]
pub struct Intent<S: Scalar> {
    /// Of the winch, N.
    pub tension: S,
    /// By which the tension is moved now, N.
    pub dither: S,
    /// Of the reference, m/s.
    pub velocity: World<V3<S>>,
}

/// What is known without this filter, to begin from.
pub(super) struct Known<'a, S: Scalar> {
    pub position: V3<S>,
    pub velocity: V3<S>,
    pub tension: S,
    pub sit: &'a MahonyState<S>,
}

impl<S: Scalar> FullFlight<S> {
    /// From the parameters; `None` where the link pushes, the pilot wants the simple filter, or numbers are fixed-point:
    /// the covariance asks for more range.
    #[inline(never)]
    pub fn new(p: &Params, kind: TetherKind) -> Option<Self> {
        let is_wanted = p.estimator_kind > 0.5;
        if !S::IS_FLOATING || !is_wanted || kind.is_free() || kind.is_rigid() {
            return None;
        }
        let f = S::from_f32;
        let aids = Aids::new(p);
        let is_straight = Line::is_straight(p, kind);
        let sag = match kind {
            // To a direction even a light line's weight counts.
            _ if is_straight && aids.end().is_none() => Sag::None,
            _ if kind.has_winch() || Line::has_cell(p) => Sag::OfEstimate,
            _ => Sag::OfSetpoint(f(p.tension)),
        };
        let model = FullStateModel {
            mass: f(p.mass),
            attachment: f(p.attachment),
            drag: f(p.drag),
            line: Line::new(p),
            stiffness: f(p.line_stiffness),
            length_floor: S::lit(LENGTH_FLOOR),
            sag,
            bow: f(p.line_bow),
        };
        let (yaw, yaw_bias) =
            if aids.sees_azimuth() { (1.0, 1.0) } else { (YAW_SHARE, YAW_BIAS_SHARE) };
        let [gyro_x, gyro_y, gyro_z] = Densities::STANDARD.gyro;
        let [walk_x, walk_y, walk_z] = Densities::STANDARD.gyro_bias;
        let densities = Densities {
            velocity: f64::from(p.full_velocity_noise),
            gyro: [gyro_x, gyro_y, gyro_z * yaw],
            gyro_bias: [walk_x, walk_y, walk_z * yaw],
            wind_time: WIND_TIME,
            ..Densities::STANDARD
        };
        // Its rows come at half the rate.
        let accel_sd = f64::from(p.full_accel_sd) * core::f64::consts::FRAC_1_SQRT_2;
        let mut standard = StartDeviation::standard();
        standard.gyro_bias.z *= S::lit(yaw_bias);
        let fixed_sd = if Line::dither(p, kind) > 0.0 { FIXED_SD } else { FIXED_SD_STILL };
        let bias = S::lit(RESTART_BIAS_SD);
        standard.offset = aids.offset_sd();
        let has_offset = aids.end().is_some();
        Some(Self {
            filter: FullStateFilter::new(model, &densities, accel_sd, has_offset, OUTER_DT),
            aids,
            is_straight,
            start: StartDeviation {
                position: S::lit(START_PLACE_SD),
                velocity: S::lit(START_VELOCITY_SD),
                tilt: S::lit(START_TILT_SD),
                ..standard
            },
            restart: StartDeviation {
                position: S::lit(RESTART_PLACE_SD),
                velocity: S::lit(RESTART_VELOCITY_SD),
                gyro_bias: V3::new(bias, bias, standard.gyro_bias.z),
                ..standard
            },
            low_pass: Biquad::low_pass(p.full_cutoff, 1.0 / OUTER_DT as f32),
            altimeter_sd: f(p.full_altimeter_sd),
            fixed_line: (!kind.has_winch()).then(|| FixedLine::new(p)),
            fixed_sd: S::lit(fixed_sd),
            start_tension: f(p.tension_low),
        })
    }

    /// The vehicle has left the ground at a known place.
    pub fn lift_off(
        &self,
        place: &World<V3<S>>,
        velocity: &World<V3<S>>,
        sit: &MahonyState<S>,
    ) -> FullFlightState<S> {
        let tension = if self.fixed_line.is_some() { S::zero() } else { self.start_tension };
        let bias = sit.gyro_bias.0;
        let state = FullState::at_rest(place.0, sit.attitude, tension, bias, &self.start);
        let state = FullState { velocity: velocity.0, ..state };
        let line = self.fixed_line.as_ref().map_or_else(FixedLineState::taut, FixedLine::start);
        let distance = self.filter.model.distance(&state);
        let length_out = self.fixed_line.as_ref().map_or(distance, |line| line.length);
        FullFlightState {
            state,
            line,
            aids: AidsState::new(),
            health: FullHealth::default(),
            gyro: GyroDoubt::default(),
            restarts: 0,
            is_touching: false,
            answer: Answer::new(),
            is_gone: false,
            push: PushDetector::default(),
            accel: Biquad3State::default(),
            thrust: None,
            altitude: None,
            is_barometric: false,
            payout: None,
            is_rate_next: false,
            heat: S::zero(),
            load: Load { thrust: S::zero(), is_taut: line.slackness.is_taut, length_out },
            reading: V3::zeros(),
            is_numb: false,
            pull: tension,
            shake: S::zero(),
            tick: 0,
            has_failed: false,
        }
    }

    /// Begins anew in flight, from the filters beside.
    pub fn restart(&self, flying: &mut FullFlightState<S>, known: &Known<'_, S>) {
        let tension = known.tension.max(S::lit(RESTART_TENSION));
        let Known { position, sit, .. } = *known;
        let state =
            FullState::at_rest(position, sit.attitude, tension, sit.gyro_bias.0, &self.restart);
        flying.state = FullState { velocity: known.velocity, ..state };
        flying.health = FullHealth::default();
        flying.gyro.begin_anew();
        flying.push = PushDetector::default();
        flying.answer = Answer::new();
        flying.line.drift = S::zero();
        flying.has_failed = false;
        flying.restarts = flying.restarts.saturating_add(1);
        flying.heat += S::one();
    }

    /// The feet have left the ground again.
    pub fn bounce(&self, flying: &mut FullFlightState<S>, sit: &MahonyState<S>) {
        flying.is_touching = false;
        flying.state.attitude = sit.attitude;
        flying.state.velocity = V3::zeros();
    }

    /// Takes what arrived.
    pub fn receive(&self, flying: &mut FullFlightState<S>, z: &Readings<'_, S>) {
        self.hear(flying, z);
        flying.altitude = z.altitude.or(flying.altitude);
        let Some(length) = z.payout else { return };
        let rate = flying.payout.map_or(S::zero(), |before| {
            let dt = length.at.seconds_since(before.last.at).max(1e-3);
            let now = (length.value - before.last.value) / S::from_f32(dt);
            before.rate + (now - before.rate) * S::lit(RATE_SHARE)
        });
        flying.payout = Some(Payout { last: length, rate, is_new: true });
    }

    /// First part of a step: the means of gyro and accelerometer, bias not removed, and the thrust before its scale, N.
    pub fn predict(&self, flying: &mut FullFlightState<S>, imu: &Imu<S>, thrust: S) {
        flying.reading = flying.accel.step(&self.low_pass, imu.accel.0);
        let smooth = flying.thrust.get_or_insert_with(|| self.low_pass.settled(thrust));
        flying.load.thrust = self.low_pass.step(smooth, thrust);
        flying.tick = flying.tick.wrapping_add(1);
        if flying.is_barometric {
            let walk = S::lit(BAROMETER_WALK * BAROMETER_WALK * OUTER_DT);
            let o = S::zero();
            flying.state.covariance.inflate(SCALARS, &V3::new(o, o, walk));
        }
        let done = self.filter.predict(&mut flying.state, &imu.gyro.0, &flying.load);
        flying.has_failed |= done.is_err();
    }

    /// Second part: the accelerometer; at every other step where the line is long: behind the low-pass, what comes 4 ms later
    /// says little new. Sensors beside have the others.
    pub fn feel(&self, flying: &mut FullFlightState<S>) {
        match self.take_aid(flying) {
            Ok(false) => {}
            Ok(true) => return,
            Err(_) => flying.has_failed = true,
        }
        let is_near = flying.load.length_out < S::lit(NEAR);
        if flying.is_numb {
            return;
        }
        if is_near || flying.tick.is_multiple_of(2) {
            let state = &mut flying.state;
            match self.filter.shaken_accelerometer(
                state,
                &flying.reading,
                &flying.load,
                flying.shake,
            ) {
                Ok(nis) => {
                    flying.health.feel(nis);
                    // What shakes comes in runs, as a push does.
                    let is_shaken = flying.shake > self.filter.accel_variance * S::lit(SHAKEN);
                    for _ in 0..if is_shaken { 0 } else { 2 } {
                        self.filter.boost(state, &mut flying.push, nis);
                    }
                }
                Err(_) => flying.has_failed = true,
            }
        }
    }

    /// Last part: height and length. Whether the filter must begin anew; not `is_clear` of the ground, whose push is in no
    /// model, only if its numbers are spoilt.
    pub fn locate(
        &self,
        flying: &mut FullFlightState<S>,
        intent: &Intent<S>,
        sit: &MahonyState<S>,
        is_clear: bool,
    ) -> bool {
        let has_altitude = flying.altitude.is_some();
        flying.heat = (flying.heat - S::lit(OUTER_DT / HEAT_TIME)).max(S::zero());
        let done = self.try_locate(flying, intent);
        let has_failed = flying.has_failed || done.is_err();
        let jerks = !flying.line.is_settled();
        // The covariance is looked through where there is an altitude: fifty times a second.
        let is_sound = !has_altitude || flying.state.is_sound(self.filter.used());
        let is_ill = flying.health.is_ill(&flying.state, sit, jerks) && is_clear;
        if self.is_straight
            && is_clear
            && !flying.is_numb
            && flying.gyro.step(&flying.state, sit, &intent.velocity.0)
        {
            let blocks = [POSITION, VELOCITY, TILT, GYRO_BIAS];
            flying.state.widen(&blocks, &self.restart);
        }
        // A line that may be gone is not to be forgotten in a new start.
        let is_ill = is_ill && !(self.fixed_line.is_none() && flying.answer.is_doubtful);
        // After so many restarts another one does not help.
        has_failed || !is_sound || (is_ill && flying.heat <= S::lit(HEAT_MAX))
    }

    /// What is known; whether the filters beside it have diverged.
    pub fn found(&self, flying: &FullFlightState<S>, is_alone: bool) -> Found<S> {
        let state = &flying.state;
        let is_lost = flying.heat > S::lit(HEAT_MAX) || (is_alone && flying.heat > S::zero());
        Found {
            position: World(state.position),
            velocity: World(state.velocity),
            middle_tension: state.tension,
            is_taut: flying.line.slackness.is_taut,
            is_gone: flying.is_gone,
            aids: self.report(flying),
            sd: position_sd(state, self.aids.systematic()),
            air_force: World(state.air_force() - state.velocity * self.filter.model.drag),
            thrust_scale: state.thrust_scale,
            pull: Some(flying.pull),
            health: flying.health.means,
            restarts: flying.restarts,
            gyro_changes: flying.gyro.changes,
            has_diverged: is_lost,
            source: PositionSource::FullState,
        }
    }
}

impl<S: Scalar> FullFlightState<S> {
    /// A height waits for the last part of the step.
    pub fn has_altitude(&self) -> bool {
        self.altitude.is_some()
    }
}

/// One standard deviation of the place, m.
fn position_sd<S: Scalar>(state: &FullState<S>, systematic: S) -> V3<S> {
    let variances = state.covariance.variances(POSITION);
    let wind = state.wind;
    let is_windy = wind.x * wind.x + wind.y * wind.y > S::lit(WINDY * WINDY);
    let more = if is_windy { S::lit(WINDY_VARIANCE) } else { S::one() };
    let always = systematic * systematic * so3::dot(&state.position, &state.position);
    let level = |variance: S| (variance * more + always).sqrt();
    V3::new(level(variances.x), level(variances.y), variances.z.sqrt())
}
