//! Where is the vehicle, and how hard does the tether pull? One filter of several answers, chosen by the parameters.

use super::payout::Outwards;
use super::tethered::{Stage, StageInput, Tethered, TetheredInput, TetheredState};
use crate::estimate::MahonyState;
use crate::estimate::capture::{CaptureFilter, CaptureState};
use crate::feature;
use crate::frames::{Attitude, V3, World};
use crate::model::{Line, TetherKind};
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::{
    AidReport, Capture, Estimate, FilterHealth, PositionSource, SphericalPoint, TetherState,
};
use crate::time::{Micros, Sample};

/// One standard deviation of the place on the ground, m.
const PLACE_SD: f64 = 0.3;

/// Configuration.
#[derive(Clone, Copy, Debug)]
pub(super) struct PositionFilter<S: Scalar> {
    filter: Filter<S>,
    /// Where the vehicle stands at the start.
    start: World<V3<S>>,
    ground_height: S,
    line: Line<S>,
}

/// Which filter it is.
#[derive(Clone, Copy, Debug)]
enum Filter<S: Scalar> {
    /// On a tether.
    Tether(feature::Cable<Tethered<S>>),
    /// In free flight.
    Capture(feature::Capture<CaptureFilter<S>>),
    /// The image has none for this link: there is no position.
    Absent,
}

/// What moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct PositionFilterState<S: Scalar> {
    /// `None` until lift-off.
    airborne: Option<Airborne<S>>,
    /// `None` until the first sample.
    capture: Option<CaptureState<S>>,
    place: World<V3<S>>,
}

/// What runs in the air.
#[derive(Clone, Copy, Debug)]
enum Airborne<S: Scalar> {
    Tether(TetheredState<S>),
    /// Motion capture runs on the ground too; without a filter there is nothing.
    Elsewhere,
}

/// What a filter knows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found<S: Scalar> {
    pub position: World<V3<S>>,
    pub velocity: World<V3<S>>,
    /// Of the line's middle, N.
    pub middle_tension: S,
    pub is_taut: bool,
    pub is_gone: bool,
    pub aids: AidReport,
    pub sd: V3<S>,
    /// Over mass, m/s².
    pub air_force: World<V3<S>>,
    /// Real over modelled thrust.
    pub thrust_scale: S,
    /// Felt along the line, N.
    pub pull: Option<S>,
    pub health: FilterHealth<S>,
    pub restarts: u16,
    pub gyro_changes: u16,
    pub has_diverged: bool,
    pub source: PositionSource,
}

impl<S: Scalar> Found<S> {
    /// At rest on the ground.
    pub fn standing(position: World<V3<S>>, source: PositionSource) -> Self {
        Self {
            position,
            velocity: World(V3::zeros()),
            middle_tension: S::zero(),
            is_taut: true,
            is_gone: false,
            aids: AidReport::default(),
            sd: V3::repeat(S::lit(PLACE_SD)),
            air_force: World(V3::zeros()),
            thrust_scale: S::one(),
            pull: None,
            health: FilterHealth::default(),
            restarts: 0,
            gyro_changes: 0,
            has_diverged: false,
            source,
        }
    }
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
        let capture = || kind.is_free().then(|| CaptureFilter::new(p));
        let tethered = || (!kind.is_free()).then(|| Tethered::new(p, kind));
        let filter = match (feature::Cable::build(tethered), feature::Capture::build(capture)) {
            (Some(tethered), _) => Filter::Tether(tethered),
            (None, Some(capture)) => Filter::Capture(capture),
            (None, None) => Filter::Absent,
        };
        Self {
            filter,
            start: World(V3::new(out * cos, out * sin, -f(ground))),
            ground_height: f(ground),
            line: Line::new(p),
        }
    }

    pub fn start(&self) -> PositionFilterState<S> {
        PositionFilterState { airborne: None, capture: None, place: self.start }
    }

    /// Takes a motion-capture sample, in free flight; whether it was wanted.
    pub fn receive(&self, state: &mut PositionFilterState<S>, sample: &Sample<Capture<S>>) -> bool {
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

    /// On the ground the place is known: where the vehicle was put, or where it landed. The attitude with which it came
    /// down, once, if this filter had one.
    pub fn rest(&self, state: &mut PositionFilterState<S>) -> Option<Attitude<S>> {
        let Some(Airborne::Tether(mut flying)) = state.airborne.take() else {
            return None;
        };
        if let Filter::Tether(filter) = &self.filter {
            let landed = filter.found(&flying).position.0;
            state.place = World(V3::new(landed.x, landed.y, -self.ground_height));
        }
        flying.touch()
    }

    /// The vehicle has left the ground, at this height, m, having slid so far.
    pub fn lift_off(
        &self,
        state: &mut PositionFilterState<S>,
        height: S,
        slid: &V3<S>,
        velocity: World<V3<S>>,
        sit: &MahonyState<S>,
    ) {
        let mut place = World(state.place.0 + slid);
        place.0.z = -height;
        state.airborne = Some(match &self.filter {
            Filter::Tether(filter) => Airborne::Tether(filter.lift_off(place, velocity, sit)),
            Filter::Capture(_) | Filter::Absent => Airborne::Elsewhere,
        });
    }

    /// One step in the air.
    pub fn step(&self, state: &mut PositionFilterState<S>, z: &TetheredInput<'_, S>) {
        if let (Filter::Tether(filter), Some(Airborne::Tether(flying))) =
            (&self.filter, &mut state.airborne)
        {
            filter.step(flying, z);
        }
    }

    /// A part of the full-state filter's step; its attitude, when the simple one may follow it.
    pub fn advance(
        &self,
        state: &mut PositionFilterState<S>,
        stage: Stage,
        z: &StageInput<'_, S>,
    ) -> Option<Attitude<S>> {
        match (&self.filter, &mut state.airborne) {
            (Filter::Tether(filter), Some(Airborne::Tether(flying))) => {
                filter.advance(flying, stage, z)
            }
            _ => None,
        }
    }

    /// Adds what is known to an estimate without a place. `now`: of the last inertial sample.
    pub fn complete(
        &self,
        state: &PositionFilterState<S>,
        estimate: Estimate<S>,
        now: Micros,
    ) -> Estimate<S> {
        if let Filter::Capture(filter) = &self.filter {
            let fresh = |c: &CaptureState<S>| estimate.is_levelled && filter.is_fresh(c, now);
            let known = state.capture.filter(fresh);
            return Estimate {
                position: known.map(|c| c.position),
                velocity: known.map(|c| c.velocity),
                source: known.map_or(PositionSource::None, |_| PositionSource::Capture),
                ..estimate
            };
        }
        let Filter::Tether(filter) = &self.filter else {
            return Estimate { position_sd: V3::repeat(S::lit(PLACE_SD)), ..estimate };
        };
        let (found, growth) = match &state.airborne {
            Some(Airborne::Tether(flying)) => {
                let found = filter.found(flying);
                (found, self.line.growth(-found.position.0.z))
            }
            _ => (Found::standing(state.place, PositionSource::FourState), S::zero()),
        };
        let known = estimate.is_levelled && !found.has_diverged;
        let place = SphericalPoint::from_world(&found.position);
        Estimate {
            position: known.then_some(found.position),
            velocity: known.then_some(found.velocity),
            tether: known.then_some(TetherState {
                elevation: place.elevation,
                azimuth: place.azimuth,
                length: place.length,
                tension: found.middle_tension + growth,
                is_taut: found.is_taut,
            }),
            position_sd: found.sd,
            air_force: found.air_force,
            thrust_scale: found.thrust_scale,
            pull: found.pull,
            restarts: found.restarts,
            gyro_changes: found.gyro_changes,
            tether_is_gone: found.is_gone,
            aids: found.aids,
            source: if known { found.source } else { PositionSource::None },
            has_diverged: found.has_diverged,
            health: found.health,
            ..estimate
        }
    }
}

impl<S: Scalar> PositionFilterState<S> {
    /// Moves the vehicle to the place from which the (new) configuration starts.
    pub fn replace(&mut self, config: &PositionFilter<S>) {
        self.place = config.start;
    }

    /// The feet touch. What the full-state filter knows of the attitude, once, if it flew.
    pub fn touch(&mut self) -> Option<Attitude<S>> {
        match &mut self.airborne {
            Some(Airborne::Tether(flying)) => flying.touch(),
            _ => None,
        }
    }

    /// How well the azimuth or the heading was seen since this was asked, rad.
    pub fn seen(&mut self) -> Option<S> {
        match &mut self.airborne {
            Some(Airborne::Tether(flying)) => flying.seen(),
            _ => None,
        }
    }

    /// Turns what is known about the vertical through the anchor, rad.
    pub fn turn(&mut self, by: S) {
        if let Some(Airborne::Tether(flying)) = &mut self.airborne {
            flying.turn(by);
        }
    }

    /// See [`TetheredState::outwards`].
    pub fn outwards(&self, force: &World<V3<S>>) -> Option<Outwards<S>> {
        match &self.airborne {
            Some(Airborne::Tether(flying)) => flying.outwards(force),
            _ => None,
        }
    }

    /// Of the full-state filter while it flies.
    pub fn attitude(&self) -> Option<Attitude<S>> {
        match &self.airborne {
            Some(Airborne::Tether(flying)) => flying.attitude(),
            _ => None,
        }
    }

    /// The vehicle has left the ground.
    pub fn is_airborne(&self) -> bool {
        self.airborne.is_some()
    }
}
