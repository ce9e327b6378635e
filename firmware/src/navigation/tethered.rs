//! Where the vehicle is on a tether: four-state filter and velocity behind it (`fullstate` section 10), and beside them
//! the full-state filter, which then is what flies and begins anew from them.

use super::divergence::{Divergence, DivergenceState};
use super::full_state::{FullFlight, FullFlightState, Height, Intent, Known, Readings};
use super::payout::Outwards;
use super::position::Found;
use super::slackness::{Slackness, SlacknessState};
use crate::estimate::{
    Ekf4, Ekf4Measurement, Ekf4State, MahonyState, VelocityFilter, VelocityState,
};
use crate::feature;
use crate::frames::{Attitude, Body, V3, World};
use crate::math::so3;
use crate::model::{Line, TetherKind};
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::{Capture, Imu, LineSensors, PositionSource};
use crate::time::{OUTER_DT, Sample};

/// Of the variance of what shakes the accelerometer, that passes the full-state filter's low-pass.
const SHAKE_SHARE: f64 = 1.0;

/// Configuration.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tethered<S: Scalar> {
    ekf: Ekf4<S>,
    follower: VelocityFilter<S>,
    slackness: Slackness<S>,
    divergence: Divergence<S>,
    start_tension: S,
    /// m; `None` with a winch.
    fixed_length: Option<S>,
    full: Option<feature::FullState<FullFlight<S>>>,
}

/// What moves, in the air.
#[derive(Clone, Copy, Debug)]
pub(super) struct TetheredState<S: Scalar> {
    ekf: Ekf4State<S>,
    velocity: VelocityState<S>,
    slackness: SlacknessState,
    divergence: DivergenceState<S>,
    full: Option<feature::FullState<FullFlightState<S>>>,
}

/// What one step reads.
pub(super) struct TetheredInput<'a, S: Scalar> {
    pub sit: &'a MahonyState<S>,
    /// Body axes, m/s².
    pub accel: Body<V3<S>>,
    /// The same in world axes.
    pub force: World<V3<S>>,
    /// N.
    pub thrust: S,
    pub altitude: Option<Height<S>>,
    pub length: Option<Sample<S>>,
    /// For the full-state filter.
    pub accel_is_believed: bool,
    /// Variance of what shakes the accelerometer, m²/s⁴.
    pub shake: S,
    pub line: &'a LineSensors<S>,
    pub place: Option<Sample<Capture<S>>>,
    pub velocity: Option<Sample<Body<V3<S>>>>,
}

/// Part of the full-state filter's step, one in each millisecond.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Onwards in time.
    Predict,
    /// The accelerometer.
    Feel,
    /// Whether the line pulls.
    Judge,
    /// Height, length, health.
    Locate,
}

/// What the full-state filter's step reads.
pub(super) struct StageInput<'a, S: Scalar> {
    pub imu: &'a Imu<S>,
    /// Before its scale, N.
    pub thrust: S,
    pub intent: &'a Intent<S>,
    /// Of the ground.
    pub is_clear: bool,
    pub sit: &'a MahonyState<S>,
}

impl<S: Scalar> Tethered<S> {
    pub fn new(p: &Params, kind: TetherKind) -> Self {
        let f = S::from_f32;
        let fixed_length = (!kind.has_winch()).then(|| f(p.tether_length));
        Self {
            ekf: Ekf4 {
                mass: f(p.mass),
                line: Line::new(p),
                q_position: f(p.ekf_q_position),
                q_tension: f(p.ekf_q_tension),
                r_accel: f(p.ekf_r_accel),
                r_altitude: f(p.ekf_r_altitude),
                r_length: f(p.ekf_r_length),
            },
            follower: VelocityFilter { gain: f(p.velocity_gain) },
            slackness: Slackness::new(p, kind.is_rigid()),
            divergence: Divergence::new(p, fixed_length, kind.is_rigid()),
            start_tension: f(p.tension_low),
            fixed_length,
            full: feature::FullState::build(|| FullFlight::new(p, kind)),
        }
    }

    /// The vehicle has left the ground, near a place.
    pub fn lift_off(
        &self,
        place: World<V3<S>>,
        velocity: World<V3<S>>,
        sit: &MahonyState<S>,
    ) -> TetheredState<S> {
        let begin = || self.full.as_ref().map(|full| full.lift_off(&place, &velocity, sit));
        let full = feature::FullState::build(begin);
        let mut place = place;
        if let Some(length) = self.fixed_length {
            // On the sphere, whatever the height at which the link became taut.
            let side = so3::norm(&V3::new(place.0.x, place.0.y, S::zero()));
            let square = length * length - place.0.z * place.0.z;
            let share = square.sqrt() / side.max(S::lit(0.1));
            place.0.x *= share;
            place.0.y *= share;
        }
        TetheredState {
            ekf: Ekf4State::at(place.0, self.start_tension),
            velocity: VelocityState::at(place),
            slackness: SlacknessState::default(),
            divergence: DivergenceState::default(),
            full,
        }
    }

    /// One step in the air: the simple filters, and what arrived for the other.
    pub fn step(&self, state: &mut TetheredState<S>, z: &TetheredInput<'_, S>) {
        let fixed = || state.slackness.is_taut.then_some(self.fixed_length).flatten();
        let payout = z.length.filter(|_| self.fixed_length.is_none());
        let z4 = Ekf4Measurement {
            attitude: z.sit.attitude,
            accel: z.accel,
            thrust: z.thrust,
            altitude: z.altitude.map(|height| height.value),
            length: payout.map(|length| length.value).or_else(fixed),
        };
        if let (Some(config), Some(full)) = (&self.full, &mut state.full) {
            (full.is_numb, full.shake) = (!z.accel_is_believed, z.shake * S::lit(SHAKE_SHARE));
            let (line, place, velocity) = (z.line, z.place, z.velocity);
            config.receive(full, &Readings { altitude: z.altitude, payout, line, place, velocity });
            if full.is_touching {
                config.bounce(full, z.sit);
            }
        }
        match self.ekf.step(&mut state.ekf, &z4) {
            Ok(nu) => {
                let position = World(state.ekf.position());
                self.follower.step(&mut state.velocity, &z.force, &position, S::lit(OUTER_DT));
                let (tension, distance) = (state.ekf.tension(), so3::norm(&position.0));
                self.divergence.step(&mut state.divergence, &nu, tension, distance);
                self.slackness.step(&mut state.slackness, tension, None);
            }
            Err(_) => self.divergence.refused(&mut state.divergence),
        }
    }

    /// A part of the full-state filter's step; its attitude, when the simple one may follow it.
    pub fn advance(
        &self,
        state: &mut TetheredState<S>,
        stage: Stage,
        z: &StageInput<'_, S>,
    ) -> Option<Attitude<S>> {
        let (config, full) = self.full.as_ref().zip(state.full.as_mut())?;
        if full.is_touching {
            return None;
        }
        match stage {
            Stage::Predict => config.predict(full, z.imu, z.thrust),
            Stage::Feel => config.feel(full),
            Stage::Judge => config.judge(full, z.intent, z.sit),
            Stage::Locate => {
                let has_altitude = full.has_altitude();
                if config.locate(full, z.intent, z.sit, z.is_clear) {
                    let known = Known {
                        position: state.ekf.position(),
                        velocity: state.velocity.velocity.0,
                        tension: state.ekf.tension(),
                        sit: z.sit,
                    };
                    config.restart(full, &known);
                } else if self.divergence.has_diverged(&state.divergence) {
                    // What one falls back on follows what holds.
                    let FullFlightState { state: healthy, .. } = &**full;
                    state.ekf = Ekf4State::at(healthy.position, healthy.tension);
                    state.velocity = VelocityState::at(World(healthy.position));
                    state.divergence = DivergenceState::default();
                }
                return has_altitude.then_some(full.state.attitude);
            }
        }
        None
    }

    /// What is known.
    pub fn found(&self, state: &TetheredState<S>) -> Found<S> {
        let has_diverged = self.divergence.has_diverged(&state.divergence);
        if let Some((config, full)) = self.full.as_ref().zip(state.full.as_ref()) {
            return config.found(full, has_diverged);
        }
        let c = &state.ekf.covariance;
        Found {
            position: World(state.ekf.position()),
            velocity: state.velocity.velocity,
            middle_tension: state.ekf.tension(),
            is_taut: state.slackness.is_taut,
            is_gone: false,
            sd: V3::new(c.m11.sqrt(), c.m22.sqrt(), c.m33.sqrt()),
            health: state.divergence.health,
            has_diverged,
            ..Found::standing(World(V3::zeros()), PositionSource::FourState)
        }
    }
}

impl<S: Scalar> TetheredState<S> {
    /// How well the azimuth or the heading was seen since this was asked, rad.
    pub fn seen(&mut self) -> Option<S> {
        self.full.as_mut()?.seen()
    }

    /// Turns what is known about the vertical through the anchor, rad.
    pub fn turn(&mut self, by: S) {
        let (sin, cos) = by.sin_cos();
        let turn = so3::axis_angle(&V3::new(S::zero(), S::zero(), S::one()), sin, cos);
        let tension = self.ekf.tension();
        self.ekf = Ekf4State::at(turn * self.ekf.position(), tension);
        self.velocity = VelocityState::at(World(self.ekf.position()));
        if let Some(full) = &mut self.full {
            full.state.turn_world(&turn);
        }
    }

    /// The feet touch. What the full-state filter knows of the attitude, once, if it flew.
    pub fn touch(&mut self) -> Option<Attitude<S>> {
        let full = self.full.as_mut().filter(|full| !full.is_touching)?;
        full.is_touching = true;
        Some(full.state.attitude)
    }

    /// See [`FullFlightState::outwards`].
    pub fn outwards(&self, force: &World<V3<S>>) -> Option<Outwards<S>> {
        self.full.as_ref()?.outwards(force)
    }

    /// Of the full-state filter while it flies.
    pub fn attitude(&self) -> Option<Attitude<S>> {
        let full = self.full.as_ref().filter(|full| !full.is_touching)?;
        Some(full.state.attitude)
    }
}
