//! Where is the vehicle, and how hard does the tether pull? One filter of several answers, chosen by the parameters.

use super::divergence::{Divergence, DivergenceState};
use super::slackness::{Slackness, SlacknessState};
use crate::estimate::capture::{CaptureFilter, CaptureState};
use crate::estimate::{Ekf4, Ekf4Measurement, Ekf4State, VelocityFilter, VelocityState};
use crate::feature;
use crate::frames::{Attitude, Body, V3, World};
use crate::math::so3;
use crate::model::{Line, TetherKind};
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::{Estimate, SphericalPoint, TetherState};
use crate::time::{Micros, OUTER_DT};

/// One standard deviation of the place on the ground, m.
const PLACE_SD: f64 = 0.3;

/// Configuration.
#[derive(Clone, Copy, Debug)]
pub(super) struct PositionFilter<S: Scalar> {
    filter: Filter<S>,
    slackness: Slackness<S>,
    divergence: Divergence<S>,
    /// Where the vehicle stands at the start.
    start: World<V3<S>>,
    start_tension: S,
    /// m; `None` with a winch.
    fixed_length: Option<S>,
    ground_height: S,
    line: Line<S>,
}

/// Which filter it is.
#[derive(Clone, Copy, Debug)]
enum Filter<S: Scalar> {
    /// On a tether: four-state filter and velocity behind it, `fullstate` section 10.
    Simple(feature::Cable<Simple<S>>),
    /// In free flight.
    Capture(feature::Capture<CaptureFilter<S>>),
    /// The image has none for this link: there is no position.
    Absent,
}

/// The filter on a tether and the velocity behind it.
#[derive(Clone, Copy, Debug)]
struct Simple<S: Scalar> {
    ekf: Ekf4<S>,
    follower: VelocityFilter<S>,
}

/// What moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct PositionFilterState<S: Scalar> {
    /// `None` until lift-off.
    airborne: Option<Airborne<S>>,
    /// `None` until the first sample.
    capture: Option<CaptureState<S>>,
    place: World<V3<S>>,
    slackness: SlacknessState,
    divergence: DivergenceState<S>,
}

/// What runs in the air.
#[derive(Clone, Copy, Debug)]
enum Airborne<S: Scalar> {
    Simple(Ekf4State<S>, VelocityState<S>),
    /// Motion capture runs on the ground too; without a filter there is nothing.
    Elsewhere,
}

/// What one step reads.
pub(super) struct PositionInput<S: Scalar> {
    pub attitude: Attitude<S>,
    /// Body axes, m/s².
    pub accel: Body<V3<S>>,
    /// The same in world axes.
    pub force: World<V3<S>>,
    /// N.
    pub thrust: S,
    pub altitude: Option<S>,
    pub length: Option<S>,
}

impl<S: Scalar> PositionFilter<S> {
    pub fn new(p: &Params) -> Self {
        let kind = TetherKind::from_parameter(p.tether_kind);
        let f = S::from_f32;
        let ground = p.ground_height;
        let distance = if kind.has_winch() {
            p.start_distance
        } else {
            // Also from a slack start: the filter begins when the link has become taut.
            libm::sqrtf((p.tether_length * p.tether_length - ground * ground).max(0.01))
        };
        let (sin, cos) = f(p.start_heading).sin_cos();
        let out = f(distance);
        let fixed_length = (!kind.has_winch()).then(|| f(p.tether_length));
        let capture = || kind.is_free().then(|| CaptureFilter::new(p));
        let simple = || {
            let ekf = Ekf4 {
                mass: f(p.mass),
                line: Line::new(p),
                q_position: f(p.ekf_q_position),
                q_tension: f(p.ekf_q_tension),
                r_accel: f(p.ekf_r_accel),
                r_altitude: f(p.ekf_r_altitude),
                r_length: f(p.ekf_r_length),
            };
            let follower = VelocityFilter { gain: f(p.velocity_gain) };
            (!kind.is_free()).then_some(Simple { ekf, follower })
        };
        let filter = match (feature::Cable::build(simple), feature::Capture::build(capture)) {
            (Some(simple), _) => Filter::Simple(simple),
            (None, Some(capture)) => Filter::Capture(capture),
            (None, None) => Filter::Absent,
        };
        Self {
            filter,
            slackness: Slackness::new(p, kind.is_rigid()),
            divergence: Divergence::new(p, fixed_length, kind.is_rigid()),
            start: World(V3::new(out * cos, out * sin, -f(ground))),
            start_tension: f(p.tension_low),
            fixed_length,
            ground_height: f(ground),
            line: Line::new(p),
        }
    }

    pub fn start(&self) -> PositionFilterState<S> {
        PositionFilterState {
            airborne: None,
            capture: None,
            place: self.start,
            slackness: SlacknessState::default(),
            divergence: DivergenceState::default(),
        }
    }

    /// Takes a motion-capture sample, in free flight; whether it was wanted.
    pub fn receive(
        &self,
        state: &mut PositionFilterState<S>,
        sample: &crate::time::Sample<crate::signal::Capture<S>>,
    ) -> bool {
        let Filter::Capture(filter) = &self.filter else {
            return false;
        };
        match &mut state.capture {
            Some(known) => filter.correct(known, sample),
            slot => *slot = Some(filter.start(sample)),
        }
        true
    }

    /// Integrates the specific force, world axes, whatever the vehicle does.
    pub fn predict(&self, state: &mut PositionFilterState<S>, force: &World<V3<S>>) {
        if let (Filter::Capture(filter), Some(known)) = (&self.filter, &mut state.capture) {
            filter.predict(known, force);
        }
    }

    /// On the ground the place is known: where the vehicle was put, or where it landed.
    pub fn rest(&self, state: &mut PositionFilterState<S>) {
        if let Some(Airborne::Simple(ekf, _)) = state.airborne.take() {
            let landed = ekf.position();
            state.place = World(V3::new(landed.x, landed.y, -self.ground_height));
        }
        state.slackness = SlacknessState::default();
        state.divergence = DivergenceState::default();
    }

    /// The vehicle has left the ground, at this height, m.
    pub fn lift_off(&self, state: &mut PositionFilterState<S>, height: S) {
        let Filter::Simple(_) = self.filter else {
            state.airborne = Some(Airborne::Elsewhere);
            return;
        };
        let mut place = state.place;
        place.0.z = -height;
        if let Some(length) = self.fixed_length {
            // On the sphere, whatever the height at which the link became taut.
            let side = so3::norm(&V3::new(place.0.x, place.0.y, S::zero()));
            let square = length * length - place.0.z * place.0.z;
            let share = square.sqrt() / side.max(S::lit(0.1));
            place.0.x *= share;
            place.0.y *= share;
        }
        let ekf = Ekf4State::at(place.0, self.start_tension);
        state.airborne = Some(Airborne::Simple(ekf, VelocityState::at(place)));
    }

    /// One step in the air.
    pub fn step(&self, state: &mut PositionFilterState<S>, z: &PositionInput<S>) {
        let (Filter::Simple(filter), Some(Airborne::Simple(ekf, velocity))) =
            (&self.filter, &mut state.airborne)
        else {
            return;
        };
        let fixed = || state.slackness.is_taut.then_some(self.fixed_length).flatten();
        let z4 = Ekf4Measurement {
            attitude: z.attitude,
            accel: z.accel,
            thrust: z.thrust,
            altitude: z.altitude,
            length: if self.fixed_length.is_none() { z.length } else { fixed() },
        };
        match filter.ekf.step(ekf, &z4) {
            Ok(nu) => {
                let position = World(ekf.position());
                filter.follower.step(velocity, &z.force, &position, S::lit(OUTER_DT));
                let (tension, distance) = (ekf.tension(), so3::norm(&position.0));
                self.divergence.step(&mut state.divergence, &nu, tension, distance);
                self.slackness.step(&mut state.slackness, tension);
            }
            Err(_) => self.divergence.refused(&mut state.divergence),
        }
    }

    /// Adds what is known to an estimate without a place. `now`: of the last inertial sample.
    pub fn complete(
        &self,
        state: &PositionFilterState<S>,
        estimate: Estimate<S>,
        now: Micros,
    ) -> Estimate<S> {
        let health = state.divergence.health;
        if let Filter::Capture(filter) = &self.filter {
            let fresh = |c: &CaptureState<S>| estimate.is_levelled && filter.is_fresh(c, now);
            let known = state.capture.filter(fresh);
            return Estimate {
                position: known.map(|c| c.position),
                velocity: known.map(|c| c.velocity),
                health,
                ..estimate
            };
        }
        let has_diverged = self.divergence.has_diverged(&state.divergence);
        let is_absent = matches!(self.filter, Filter::Absent);
        let known = estimate.is_levelled && !has_diverged && !is_absent;
        let (position, velocity, tension, sd) = match &state.airborne {
            Some(Airborne::Simple(ekf, velocity)) => {
                let c = &ekf.covariance;
                let sd = V3::new(c.m11.sqrt(), c.m22.sqrt(), c.m33.sqrt());
                let position = ekf.position();
                let tension = ekf.tension() + self.line.growth(-position.z);
                (World(position), velocity.velocity, tension, sd)
            }
            _ => {
                let sd = V3::repeat(S::lit(PLACE_SD));
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
                is_taut: state.slackness.is_taut,
            }),
            position_sd: sd,
            has_diverged,
            health,
            ..estimate
        }
    }
}

impl<S: Scalar> PositionFilterState<S> {
    /// Moves the vehicle to the place from which the (new) configuration starts.
    pub fn replace(&mut self, config: &PositionFilter<S>) {
        self.place = config.start;
    }

    /// The vehicle has left the ground.
    pub fn is_airborne(&self) -> bool {
        self.airborne.is_some()
    }
}
