//! A line that weighs: segments with mass, stretch, damping and drag, from a drum or a fixed point to the vehicle.
//!
//! The mesh follows the line: whatever is paid out, there are `n` segments of the same unstretched length, and the
//! nodes move along the line at `(1 - i/n)` of the drum's speed. So no segment appears or disappears, and nothing
//! jumps. A node's velocity is that of the matter at it; what flows past it brings its momentum along.

mod step;

use crate::plant::{GRAVITY, V3};

/// What the line is made of.
#[derive(Clone, Copy, Debug)]
pub struct Material {
    /// kg/m.
    pub density: f64,
    /// Axial stiffness EA, N.
    pub stiffness: f64,
    /// Damping per stiffness, s.
    pub relaxation: f64,
    /// m.
    pub diameter: f64,
}

/// The vehicle's end, and what the line can move there.
#[derive(Clone, Copy, Debug)]
pub struct End {
    /// Of the attachment, world axes, m.
    pub position: V3,
    /// Of the attachment, world axes, m/s.
    pub velocity: V3,
    /// On the vehicle but for weight and line, world axes, N.
    pub force: V3,
    /// Of the vehicle, kg; infinite: it does not give way.
    pub mass: f64,
    /// What a pull across `down` turns: arm squared per moment of inertia, 1/kg.
    pub turns: f64,
    /// The attachment from the centre of mass, unit vector.
    pub down: V3,
}

/// A point of the line.
#[derive(Clone, Copy, Debug)]
struct Node {
    position: V3,
    velocity: V3,
    /// By weight, air and flow of the line, m/s².
    acceleration: V3,
    /// What a force along the line does to it within a step, m/s per N; zero: it does not give way.
    gives: f64,
}

/// Between two nodes.
#[derive(Clone, Copy, Debug, Default)]
struct Segment {
    /// Towards the vehicle.
    along: V3,
    /// Cosine of the bend from the one below.
    bend: f64,
    tension: f64,
    is_taut: bool,
    // Of the elimination: right side before it, what the row below takes of this tension, right side after it.
    wanted: f64,
    carry: f64,
    right: f64,
}

/// The whole line.
#[derive(Clone, Debug)]
pub struct Chain {
    /// The first at the station, the last at the vehicle.
    nodes: Vec<Node>,
    segments: Vec<Segment>,
    /// Unstretched length paid out, m.
    length: f64,
    /// Its rate, m/s.
    pay_out: f64,
    /// At the drum or the fixed end, N.
    station_tension: f64,
    /// What the loop over the load cell adds, N.
    trim: f64,
    /// Direction in which it leaves there.
    leaves: V3,
    /// Half of the drag of the last segment, N.
    end_drag: V3,
    /// The next step looks anew; the one after it goes on under the forces found.
    looks: bool,
    /// The lower end hangs free.
    is_cut: bool,
    /// A node that is caught on something.
    caught: Option<usize>,
}

/// A segment of a line that is all reeled in, m.
const SHORTEST_SEGMENT: f64 = 0.01;
impl Chain {
    /// Laid out at rest with `length` m paid out; `place` of a share of it from the station, world axes, m.
    #[must_use]
    pub fn new(segments: usize, length: f64, place: impl Fn(f64) -> V3) -> Self {
        let node = |i: usize| Node {
            position: place(i as f64 / segments as f64),
            velocity: V3::zeros(),
            acceleration: V3::zeros(),
            gives: 0.0,
        };
        Self {
            nodes: (0..=segments).map(node).collect(),
            segments: vec![Segment::default(); segments],
            length,
            pay_out: 0.0,
            station_tension: 0.0,
            trim: 0.0,
            leaves: V3::zeros(),
            end_drag: V3::zeros(),
            looks: true,
            is_cut: false,
            caught: None,
        }
    }

    /// Unstretched length from the station or the cut to the vehicle, m.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.length
    }

    /// How fast the drum pays out, m/s.
    #[must_use]
    pub fn pay_out(&self) -> f64 {
        self.pay_out
    }

    /// At the station, N.
    #[must_use]
    pub fn station_tension(&self) -> f64 {
        if self.is_cut { 0.0 } else { self.station_tension }
    }

    /// At the vehicle, N.
    #[must_use]
    pub fn tension(&self) -> f64 {
        self.segments.last().map_or(0.0, |segment| segment.tension)
    }

    /// Direction in which the line leaves the station; zero: nothing is there.
    #[must_use]
    pub fn leaves(&self) -> V3 {
        if self.is_cut { V3::zeros() } else { self.leaves }
    }

    /// Direction in which it arrives at the vehicle.
    #[must_use]
    pub fn arrives(&self) -> V3 {
        self.segments.last().map_or(V3::zeros(), |segment| segment.along)
    }

    /// Mass that moves with the vehicle, kg: half of the last segment.
    #[must_use]
    pub fn end_mass(&self, density: f64) -> f64 {
        0.5 * density * self.segment_length()
    }

    /// Force of the last segment on the vehicle but for the weight and inertia of [`Self::end_mass`], N.
    #[must_use]
    pub fn end_force(&self) -> V3 {
        self.segments.last().map_or(V3::zeros(), |last| self.end_drag - last.along * last.tension)
    }

    /// World axes, m, from the station to the vehicle.
    pub fn points(&self) -> impl Iterator<Item = V3> {
        self.nodes.iter().map(|node| node.position)
    }

    /// Kinetic, elastic and potential energy, J; what moves with the vehicle is its own.
    #[must_use]
    pub fn energy(&self, material: &Material) -> f64 {
        let rest = self.segment_length();
        let mass = material.density * rest;
        let inner = self.nodes.get(1..self.segments.len()).unwrap_or(&[]);
        let moved: f64 = inner
            .iter()
            .map(|n| mass * (0.5 * n.velocity.norm_squared() - GRAVITY * n.position.z))
            .sum();
        let spring = 0.5 * material.stiffness / rest;
        let stretch = |[a, b]: &[Node; 2]| ((b.position - a.position).norm() - rest).max(0.0);
        let stretched: f64 =
            self.nodes.array_windows().map(|ends| spring * stretch(ends).powi(2)).sum();
        moved + stretched
    }

    /// Cuts it at a `share` of its length from the station: what hangs on the vehicle is left.
    pub fn cut(&mut self, share: f64) {
        if self.is_cut {
            return;
        }
        let lost = self.index(share, self.segments.len().saturating_sub(1));
        let rest = self.segment_length();
        self.nodes.drain(..lost);
        self.segments.drain(..lost);
        self.length = rest * self.segments.len() as f64;
        self.caught = self.caught.and_then(|node| node.checked_sub(lost));
        self.pay_out = 0.0;
        self.is_cut = true;
    }

    /// Catches it on something where it is now, at a `share` of its length from the station.
    pub fn catch(&mut self, share: f64) {
        if self.caught.is_none() {
            self.caught = Some(self.index(share, self.segments.len().saturating_sub(1)).max(1));
        }
    }

    /// Whatever caught it lets go.
    pub fn release(&mut self) {
        self.caught = None;
    }

    fn index(&self, share: f64, most: usize) -> usize {
        ((share.clamp(0.0, 1.0) * self.segments.len() as f64).round() as usize).min(most)
    }

    fn segment_length(&self) -> f64 {
        (self.length / self.segments.len().max(1) as f64).max(SHORTEST_SEGMENT)
    }
}
