//! What other sensors of the line, and of the place, add (`fullstate` sections 21 and 22): a row at a time, in milliseconds
//! that the accelerometer leaves free. A reading that contradicts the rest is left out; a sensor whose readings do so for a
//! second is told.

use super::super::compass::Compass;
use super::{FullFlight, FullFlightState, Height};
use crate::estimate::Fault;
use crate::estimate::full_state::{DirectionEnd, FullState, TILT};
use crate::frames::{Body, V3, World};
use crate::math::so3;
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::{Aid, AidReport, AidSet, Capture, LineSensors};
use crate::time::Sample;

/// A line shows its direction while it pulls so hard, N, is so long, m, and has done so for so many steps: 0.3 s.
const PULL_MIN: f64 = 1.0;
const LENGTH_MIN: f64 = 1.0;
const TAUT_STEPS: u8 = 75;
/// A line that leaves the vehicle nearly level turns its encoders to their stops: least share downwards.
const DOWN_MIN: f64 = 0.4;
/// What its sensor's mounting is known to, rad.
const MOUNTING_SD: f64 = 0.0136;
const SYSTEMATIC_SD: f64 = 0.01;
/// Of a load cell, N, and of the compass at 8 Hz, rad.
const CELL_SD: f64 = 0.21;
const COMPASS_SD: f64 = 0.1;
/// Of an azimuth that the station or a position shows, rad, beside what the filter knows of it.
const AZIMUTH_SD: f64 = 0.01;
/// A compass that is further off than this, rad, beside three deviations of the heading, is disturbed.
const COMPASS_REJECT: f64 = 0.35;
/// Readings in excess that make a sensor one that contradicts, and squared deviations of a bad one.
const BAD_MOST: u8 = 50;
const BAD_NIS: f64 = 25.0;
/// Steps without a reading that make it silent: 1 s.
const SILENT_STEPS: u16 = 250;

/// Configuration.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aids<S> {
    wanted: AidSet,
    direction_sd: S,
    place_sd: S,
    flow_sd: S,
    compass: Compass<S>,
    capture_delay: S,
}

impl<S: Scalar> Aids<S> {
    pub fn new(p: &Params) -> Self {
        let f = S::from_f32;
        Self {
            wanted: AidSet::from_parameter(p.aids),
            direction_sd: f(p.direction_sd),
            place_sd: f(p.place_sd),
            flow_sd: f(p.flow_sd),
            compass: Compass::new(p),
            capture_delay: f(p.capture_delay),
        }
    }

    /// The end at which the line's direction counts, if one is wanted.
    pub fn end(&self) -> Option<DirectionEnd> {
        match self.wanted {
            wanted if wanted.contains(Aid::Fairlead) => Some(DirectionEnd::Ground),
            wanted if wanted.contains(Aid::Angles) => Some(DirectionEnd::Vehicle),
            _ => None,
        }
    }

    /// What a direction's sensor may be wrong by all the time, beyond its noise, by the distance: hysteresis, bow.
    pub fn systematic(&self) -> S {
        if self.end().is_some() { S::lit(SYSTEMATIC_SD) } else { S::zero() }
    }

    /// Something holds the azimuth.
    pub fn sees_azimuth(&self) -> bool {
        [Aid::Fairlead, Aid::Compass, Aid::Position]
            .into_iter()
            .any(|aid| self.wanted.contains(aid))
    }

    /// Of the direction's offset, rad.
    pub fn offset_sd(&self) -> S {
        if self.end().is_some() { S::lit(MOUNTING_SD) } else { S::zero() }
    }
}

/// What arrived for the full-state filter.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Readings<'a, S: Scalar> {
    pub altitude: Option<Height<S>>,
    /// Of the line out of a winch, m.
    pub payout: Option<Sample<S>>,
    pub line: &'a LineSensors<S>,
    pub place: Option<Sample<Capture<S>>>,
    pub velocity: Option<Sample<Body<V3<S>>>>,
}

/// How often a sensor contradicts.
#[derive(Clone, Copy, Debug, Default)]
struct Gate {
    bad: u8,
    is_shut: bool,
    silent: u16,
}

impl Gate {
    fn take(&mut self, nis: f64) {
        let is_bad = nis > BAD_NIS;
        self.bad = if is_bad { (self.bad + 1).min(BAD_MOST) } else { self.bad.saturating_sub(1) };
        self.is_shut = self.bad == BAD_MOST || (self.is_shut && self.bad > 0);
    }

    fn hear(&mut self, is_heard: bool) {
        self.silent = if is_heard { 0 } else { (self.silent + 1).min(SILENT_STEPS) };
    }
}

/// What moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct AidsState<S: Scalar> {
    line: LineSensors<S>,
    place: Option<World<V3<S>>>,
    velocity: Option<Body<V3<S>>>,
    gates: [Gate; Aid::ALL.len()],
    /// Of a line that pulls.
    taut_steps: u8,
    /// The azimuth or the heading was seen, to so many rad.
    seen: Option<S>,
}

impl<S: Scalar> AidsState<S> {
    pub fn new() -> Self {
        Self {
            line: LineSensors::default(),
            place: None,
            velocity: None,
            gates: Default::default(),
            taut_steps: 0,
            seen: None,
        }
    }

    fn gate(&mut self, aid: Aid) -> Option<&mut Gate> {
        self.gates.get_mut(aid as usize)
    }
}

impl<S: Scalar> FullFlightState<S> {
    /// How well the azimuth or the heading was seen since this was asked, rad.
    pub(in super::super) fn seen(&mut self) -> Option<S> {
        self.aids.seen.take()
    }
}

impl<S: Scalar> FullFlight<S> {
    /// Takes what arrived, of the sensors that are wanted.
    pub(super) fn hear(&self, flying: &mut FullFlightState<S>, z: &Readings<'_, S>) {
        let wanted = self.aids.wanted;
        if wanted.is_empty() {
            return;
        }
        let velocity = flying.state.velocity;
        let aids = &mut flying.aids;
        aids.line = *z.line;
        if let Some(Sample { value, .. }) = z.place.filter(|_| wanted.contains(Aid::Position)) {
            // Where the vehicle is by now.
            aids.place = Some(World(value.position.0 + velocity * self.aids.capture_delay));
        }
        if wanted.contains(Aid::Velocity) {
            aids.velocity = z.velocity.map(|sample| sample.value).or(aids.velocity);
        }
        let is_taut = flying.load.is_taut && flying.state.tension > S::lit(PULL_MIN);
        aids.taut_steps = if is_taut { (aids.taut_steps + 1).min(TAUT_STEPS) } else { 0 };
        let heard = [
            (Aid::Angles, z.line.direction.is_some()),
            (Aid::Fairlead, z.line.station_direction.is_some()),
            (Aid::Cell, z.line.station_tension.or(z.line.tension).is_some()),
            (Aid::Compass, z.line.magnetic.is_some()),
            (Aid::Position, z.place.is_some()),
            (Aid::Velocity, z.velocity.is_some()),
        ];
        for (gate, (aid, is_heard)) in aids.gates.iter_mut().zip(heard) {
            gate.hear(is_heard || !wanted.contains(aid));
        }
    }

    /// A row of a sensor beside, if one has its turn: 60 times a second one of the line's direction, else in turn.
    pub(super) fn take_aid(&self, flying: &mut FullFlightState<S>) -> Result<bool, Fault> {
        if self.aids.wanted.is_empty() {
            return Ok(false);
        }
        match flying.tick % 4 {
            1 => self.take_direction(flying),
            3 if flying.tick & 4 == 0 => self.take_place(flying),
            3 if flying.tick & 8 == 0 => self.take_velocity(flying),
            3 if flying.tick & 16 == 0 => self.take_compass(flying),
            _ => Ok(false),
        }
    }

    fn take_direction(&self, flying: &mut FullFlightState<S>) -> Result<bool, Fault> {
        let is_long = flying.load.length_out > S::lit(LENGTH_MIN);
        let Some(end) = self.aids.end().filter(|_| is_long) else {
            return Ok(false);
        };
        let FullFlightState { aids, state, load, .. } = flying;
        if aids.taut_steps < TAUT_STEPS {
            return Ok(false);
        }
        let (out, sd) = (load.length_out, self.aids.direction_sd);
        let (aid, nis) = match (end, aids.line.direction, aids.line.station_direction) {
            (DirectionEnd::Vehicle, Some(Body(line)), _) if line.z > S::lit(DOWN_MIN) => {
                let angles = [line.x.atan2(line.z), line.y.atan2(line.z)];
                (Aid::Angles, self.filter.line_direction(state, end, angles, out, sd)?)
            }
            (DirectionEnd::Ground, _, Some(World(line))) => {
                let level = (line.x * line.x + line.y * line.y).sqrt();
                let angles = [line.y.atan2(line.x), (-line.z).atan2(level)];
                (Aid::Fairlead, self.filter.station_direction(state, angles, out, sd)?)
            }
            _ => return Ok(false),
        };
        judge(flying, aid, nis)
    }

    fn take_place(&self, flying: &mut FullFlightState<S>) -> Result<bool, Fault> {
        let Some(World(place)) = flying.aids.place.take() else {
            return Ok(false);
        };
        let (state, sd) = (&mut flying.state, self.aids.place_sd);
        let nis = self.filter.level_position(state, [place.x, place.y], sd)?;
        judge(flying, Aid::Position, nis)
    }

    fn take_velocity(&self, flying: &mut FullFlightState<S>) -> Result<bool, Fault> {
        let Some(Body(velocity)) = flying.aids.velocity.take() else {
            return Ok(false);
        };
        let (state, sd) = (&mut flying.state, self.aids.flow_sd);
        let nis = self.filter.body_velocity(state, [velocity.x, velocity.y], sd)?;
        judge(flying, Aid::Velocity, nis)
    }

    fn take_compass(&self, flying: &mut FullFlightState<S>) -> Result<bool, Fault> {
        let state = &mut flying.state;
        let field = flying.aids.line.magnetic;
        let Some(off) = self.aids.compass.deviation(&state.attitude, field) else {
            return Ok(false);
        };
        let variance = azimuth_variance(state);
        let is_near = off.abs() < S::lit(COMPASS_REJECT) + variance.sqrt() * S::lit(3.0);
        let nis = if is_near {
            let (.., yaw) = state.attitude.euler();
            self.filter.heading(state, yaw + off, S::lit(COMPASS_SD))?
        } else {
            S::lit(2.0 * BAD_NIS)
        };
        judge(flying, Aid::Compass, nis)
    }

    /// At the station, or else at the vehicle; and where it is.
    pub(super) fn cell(&self, flying: &FullFlightState<S>) -> Option<(DirectionEnd, S)> {
        let line = &flying.aids.line;
        let at_ground = line.station_tension.map(|tension| (DirectionEnd::Ground, tension));
        let at_vehicle = line.tension.map(|tension| (DirectionEnd::Vehicle, tension));
        at_ground.or(at_vehicle).filter(|_| self.aids.wanted.contains(Aid::Cell))
    }

    pub(super) fn take_cell(
        &self,
        flying: &mut FullFlightState<S>,
        (end, tension): (DirectionEnd, S),
    ) -> Result<(), Fault> {
        let (state, out) = (&mut flying.state, flying.load.length_out);
        let nis = self.filter.end_tension(state, end, tension, out, S::lit(CELL_SD))?;
        judge(flying, Aid::Cell, nis).map(|_| ())
    }

    /// Sensors that should help and do not.
    pub(super) fn report(&self, flying: &FullFlightState<S>) -> AidReport {
        let mut report = AidReport::default();
        for (aid, gate) in Aid::ALL.into_iter().zip(&flying.aids.gates) {
            report.rejected.set(aid, gate.is_shut);
            report.silent.set(aid, gate.silent == SILENT_STEPS);
        }
        report
    }
}

fn judge<S: Scalar>(flying: &mut FullFlightState<S>, aid: Aid, nis: S) -> Result<bool, Fault> {
    let nis = f64::from(nis.to_f32());
    if let Some(gate) = flying.aids.gate(aid) {
        gate.take(nis);
    }
    let sd = match aid {
        Aid::Compass => Some(COMPASS_SD),
        Aid::Fairlead | Aid::Position => Some(AZIMUTH_SD),
        Aid::Angles | Aid::Cell | Aid::Velocity => None,
    };
    flying.aids.seen = sd.filter(|_| nis <= BAD_NIS).map(S::lit).or(flying.aids.seen);
    Ok(true)
}

/// Of the heading, rad².
pub(super) fn azimuth_variance<S: Scalar>(state: &FullState<S>) -> S {
    let down = so3::row_z(&state.attitude.0);
    so3::dot(&down, &(state.covariance.block(TILT, TILT) * down)).max(S::zero())
}
