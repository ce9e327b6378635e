//! The tether from its ground end to the vehicle: a straight link or a chain that weighs, on a winch or at a fixed
//! length; cut, caught, twisted.

mod chain;
mod drag;
mod station;
mod straight;

pub use chain::{Chain, End, Material};
pub use station::{Drum, WinchModel};

use super::{DT, SUBSTEPS, TICK, V3, uniform};
use crate::scenario::{LineModel, TetherKind, TetherSection, VehicleSection};
pub(super) use drag::drag;
use rand_pcg::Pcg64Mcg;
use std::f64::consts::{PI, TAU};
use straight::{Air, straight};
pub(super) use straight::{DRAG_SHARE, SHORTEST, Straight};

/// The line.
#[derive(Clone, Debug)]
pub struct TetherModel {
    /// `None`: fixed length.
    pub winch: Option<WinchModel>,
    /// Unstretched length when fixed, m.
    pub length: f64,
    /// Axial stiffness EA, N.
    pub stiffness: f64,
    /// Damping ratio of the vehicle on the line.
    pub damping_ratio: f64,
    /// kg that the damping ratio refers to.
    pub reference_mass: f64,
    /// kg/m.
    pub line_density: f64,
    /// m.
    pub diameter: f64,
    /// Attachment from the centre of mass, body axes, m.
    pub attachment: V3,
    /// A cable pulls.
    pub pulls: bool,
    /// A strut or bar pushes.
    pub pushes: bool,
    /// Cut: nothing pulls.
    pub is_broken: bool,
    /// Share of its length from the station where it was cut; a straight one is gone anyway.
    pub broken_at: f64,
    /// Of a line that weighs; `None`: straight.
    pub segments: Option<usize>,
}

/// A segment is about this long where the scenario does not say, m.
const SEGMENT: f64 = 6.0;
/// Fewest and most segments then.
const SEGMENTS: (f64, f64) = (5.0, 20.0);

impl TetherModel {
    /// As the scenario describes it, for that vehicle.
    #[must_use]
    pub fn new(tether: &TetherSection, vehicle: &VehicleSection) -> Self {
        let kind = tether.kind;
        let is_free = kind == TetherKind::None;
        let longest =
            if kind == TetherKind::Winch { tether.winch_length_max } else { tether.length };
        let by_length = (longest / SEGMENT).ceil().clamp(SEGMENTS.0, SEGMENTS.1) as usize;
        let ([x, y], [forward, right]) = (tether.attachment_aside, vehicle.centre);
        let segments = if tether.segments == 0 { by_length } else { tether.segments as usize };
        Self {
            winch: (kind == TetherKind::Winch).then(|| WinchModel::new(tether)),
            length: tether.length,
            stiffness: tether.stiffness,
            damping_ratio: tether.damping_ratio,
            reference_mass: vehicle.mass,
            // No line hangs on a vehicle without one.
            line_density: if is_free { 0.0 } else { tether.line_density },
            diameter: if is_free { 0.0 } else { tether.diameter },
            attachment: V3::new(x - forward, y - right, tether.attachment),
            pulls: !matches!(kind, TetherKind::Strut | TetherKind::None),
            pushes: matches!(kind, TetherKind::Strut | TetherKind::Bar),
            is_broken: false,
            broken_at: 0.0,
            segments: (tether.model == LineModel::Chain).then_some(segments),
        }
    }

    /// What a line of `length` m is made of.
    fn material(&self, length: f64) -> Material {
        // Damping of the vehicle on the whole line, per stiffness.
        let whole = self.reference_mass * length / self.stiffness;
        Material {
            density: self.line_density,
            stiffness: self.stiffness,
            relaxation: 2.0 * self.damping_ratio * whole.sqrt(),
            diameter: self.diameter,
        }
    }
}

/// State.
#[derive(Clone, Debug)]
pub struct Tether {
    /// What a straight link does now.
    link: Straight,
    air: Air,
    /// Turns that the vehicle has put into it, nose over the right wing.
    pub twist: f64,
    chain: Option<Chain>,
    /// Of a straight link: where it is caught and its length from there.
    caught: Option<(V3, f64)>,
    /// Of a straight link on a drum that turns whatever it is asked, m.
    paid_out: Option<f64>,
    /// Of nose from azimuth at the last look, rad.
    turned: f64,
    /// Physics steps since the chain's last one, or since a straight link felt the air.
    since: u32,
    set_point: f64,
    /// Tension that the drum's controller wants, N.
    drum: f64,
    error: f64,
    phase: f64,
}

/// Physics steps per step of the chain: 2 kHz.
const CHAIN_EVERY: u32 = 2;
const RIPPLE_RATE: f64 = 40.0;

/// What the tether does to the vehicle.
#[derive(Clone, Copy, Debug)]
pub struct Grip {
    /// On the attachment, world axes, N.
    pub force: V3,
    /// Mass of line that moves with the vehicle beside that, kg.
    pub mass: f64,
}

impl Tether {
    /// Laid out from `base` to `end`, m from there.
    #[must_use]
    pub fn new(model: &TetherModel, base: &V3, end: &V3, rng: &mut Pcg64Mcg) -> Self {
        let error = model.winch.as_ref().map_or(0.0, |winch| winch.error);
        let mut tether = Self {
            link: Straight::default(),
            air: Air::default(),
            twist: 0.0,
            chain: None,
            caught: None,
            paid_out: None,
            turned: 0.0,
            since: 0,
            set_point: 0.0,
            drum: 0.0,
            error: uniform(rng) * error,
            phase: uniform(rng) * TAU,
        };
        tether.lay(model, base, end);
        tether
    }

    /// Lays it out straight and slack from `base` to `end`, m from there.
    pub fn lay(&mut self, model: &TetherModel, base: &V3, end: &V3) {
        let length = if model.winch.is_some() { end.norm() } else { model.length };
        let laid = |segments| Chain::new(segments, length, |share| base + end * share);
        self.chain = model.segments.map(laid);
    }

    /// The winch's controller, once per millisecond: lag, slow error, ripple.
    pub fn drive(&mut self, model: &TetherModel, wanted: f64, time: f64) {
        if let Some(winch) = &model.winch {
            self.set_point += (wanted - self.set_point) * (TICK / winch.lag).min(1.0);
            self.drum = self.set_point * (1.0 + self.error)
                + winch.ripple * (RIPPLE_RATE * time + self.phase).sin();
        }
    }

    /// A physics step. `base`: the ground end's place and velocity. `wind`: air velocity at a height.
    #[inline]
    pub fn step(
        &mut self,
        model: &TetherModel,
        base: (V3, V3),
        end: &End,
        wind: &impl Fn(f64) -> V3,
    ) -> Grip {
        let wanted = self.drum;
        let drum = model.winch.as_ref().map(|model| Drum { model, wanted });
        let Some(chain) = &mut self.chain else {
            if self.since == 0 {
                self.air.wind = Some(wind(-end.position.z));
            }
            self.since = (self.since + 1) % SUBSTEPS;
            let turns = model.winch.as_ref().and_then(|winch| winch.turns);
            self.paid_out = turns
                .map(|speed| (self.paid_out.unwrap_or(self.link.length) + speed * DT).max(0.2));
            let (drum, length, base) = match (self.caught, self.paid_out) {
                (None, None) => (drum, model.length, base),
                (None, Some(length)) => (None, length, base),
                (Some((point, length)), _) => (None, length, (point, V3::zeros())),
            };
            let (link, force) = straight(model, drum, length, base, end, &mut self.air);
            self.link = link;
            return Grip { force, mass: 0.0 };
        };
        if self.since == 0 {
            if model.is_broken {
                chain.cut(model.broken_at);
            }
            let material = model.material(chain.length());
            chain.step(&material, drum, base, end, wind, DT * f64::from(CHAIN_EVERY));
        }
        self.since = (self.since + 1) % CHAIN_EVERY;
        Grip { force: chain.end_force(), mass: chain.end_mass(model.line_density) }
    }

    /// Nothing but the drum holds a straight line that is whole: what it wants, N.
    pub(super) fn on_drum(&self, model: &TetherModel) -> Option<f64> {
        let winch = model.winch.as_ref()?;
        let is_free = self.chain.is_none() && self.caught.is_none() && self.paid_out.is_none();
        let is_plain = model.pulls && !model.pushes && !model.is_broken && winch.turns.is_none();
        (is_free && is_plain && self.since == 0).then_some(self.drum)
    }

    /// After a millisecond that was computed elsewhere.
    pub(super) fn take(&mut self, link: Straight, drag: V3) {
        self.link = link;
        self.air = Air { drag, wind: None };
    }

    /// Lies straight, with the length, m, and the tension, N, that another simulator reported last.
    pub fn follow(&mut self, along: V3, line: Option<(f64, f64)>) {
        self.chain = None;
        let (length, tension) = line.unwrap_or((self.link.length, self.link.tension));
        self.link = Straight { along, tension, half_weight: 0.0, length };
    }

    /// The line catches on something at a `share` of its length from the station, where it is now.
    pub fn catch(&mut self, base: &V3, share: f64) {
        if let Some(chain) = &mut self.chain {
            chain.catch(share);
        } else if self.caught.is_none() {
            let point = base + self.link.along * (self.link.length * share);
            self.caught = Some((point, self.link.length * (1.0 - share)));
        }
    }

    /// Whatever caught it lets go.
    pub fn release(&mut self) {
        self.caught = None;
        if let Some(chain) = &mut self.chain {
            chain.release();
        }
    }

    /// Points of the line, world axes, m, if it has more than its ends.
    pub fn points(&self) -> impl Iterator<Item = V3> {
        self.chain.iter().flat_map(Chain::points)
    }

    /// The vehicle's nose is `turned` rad from the line's azimuth.
    pub fn turn(&mut self, turned: f64) {
        let by = (turned - self.turned + PI).rem_euclid(TAU) - PI;
        self.twist += by / TAU;
        self.turned = turned;
    }

    /// At the vehicle, N; negative where a bar pushes.
    #[must_use]
    pub fn tension(&self) -> f64 {
        self.chain.as_ref().map_or_else(|| self.link.end_tensions()[1], Chain::tension)
    }

    /// At the ground station, N.
    #[must_use]
    pub fn station_tension(&self) -> f64 {
        self.chain.as_ref().map_or_else(|| self.link.end_tensions()[0], Chain::station_tension)
    }

    /// Direction of the pull on the vehicle, NED; zero: nothing pulls.
    #[must_use]
    pub fn pull(&self) -> V3 {
        -self.chain.as_ref().map_or(self.link.along, Chain::arrives)
    }

    /// Direction in which the line leaves the station, NED; zero: nothing is there.
    #[must_use]
    pub fn leaves(&self) -> V3 {
        self.chain.as_ref().map_or(self.link.along, Chain::leaves)
    }

    /// Unstretched length between station and vehicle, m; of a straight line on a winch, as far as it reaches.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.chain.as_ref().map_or(self.link.length, Chain::length)
    }
}

#[cfg(test)]
mod tests;
