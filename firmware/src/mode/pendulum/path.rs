//! Where the load shall be: at the place of entry, on a straight way to another, or on a circle around it.

use crate::estimate::pendulum::PendulumEstimate;
use crate::frames::{V3, World};
use crate::math::so3;
use crate::mode::plan::SAME_PLACE;
use crate::mode::{Refusal, rejected};
use crate::scalar::Scalar;
use crate::signal::LoadReference;
use crate::trajectory::load::{FadeIn, LoadMove, TiltedCircle};

/// Peak slope of the C5 step: peak speed is this times distance over duration.
const PEAK_SLOPE: f64 = 2.707;
/// Peak speed of a move, m/s, and its shortest duration, s.
const SPEED: f64 = 0.5;
const SHORTEST: f64 = 4.0;

#[derive(Clone, Copy, Debug)]
enum Shape<S: Scalar> {
    Stay(World<V3<S>>),
    Move(LoadMove<S>),
    /// With the angle.
    Circle(TiltedCircle<S>, S),
}

/// A reference under way.
#[derive(Clone, Copy, Debug)]
pub(super) struct LoadPath<S: Scalar> {
    shape: Shape<S>,
    fade: FadeIn<S>,
    /// Since the shape began and since entry, s.
    time: S,
    flown: S,
}

impl<S: Scalar> LoadPath<S> {
    /// From where the load is: stays there, or takes up the circle around it.
    pub fn enter(x: &PendulumEstimate<S>, circle: &TiltedCircle<S>, speed: S, soft: S) -> Self {
        let shape = if speed > S::zero() {
            Shape::Circle(circle.around(x.position), S::zero())
        } else {
            Shape::Stay(x.position)
        };
        let o = S::zero();
        Self { shape, fade: FadeIn::new(&x.position, &x.velocity, soft), time: o, flown: o }
    }

    /// Whether the soft start is over.
    pub fn has_settled(&self) -> bool {
        self.flown > self.fade.duration()
    }

    /// As it is.
    pub fn now(&self) -> LoadReference<S> {
        self.fade.apply(&shape_at(&self.shape, self.time), self.flown)
    }

    /// `dt` s later.
    pub fn step(&mut self, dt: S) -> LoadReference<S> {
        self.time += dt;
        self.flown += dt;
        match &mut self.shape {
            Shape::Circle(circle, angle) => *angle = circle.advance(*angle, dt),
            Shape::Move(way) if self.time >= way.duration() => {
                self.shape = Shape::Stay(way.end());
            }
            Shape::Move(_) | Shape::Stay(_) => {}
        }
        self.now()
    }

    /// To another place, m; `None` keeps a coordinate. Only from rest.
    pub fn go(&mut self, ned: [Option<S>; 3]) -> Result<(), Refusal> {
        let from = match &self.shape {
            Shape::Stay(at) => *at,
            Shape::Move(way) => way.end(),
            Shape::Circle(..) => return Err(rejected("Move refused: the load is on a circle")),
        };
        let [north, east, down] = ned;
        let to = World(V3::new(
            north.unwrap_or(from.0.x),
            east.unwrap_or(from.0.y),
            down.unwrap_or(from.0.z),
        ));
        let distance = so3::norm(&(to.0 - from.0));
        // Programs repeat their set-point.
        if distance < S::lit(SAME_PLACE) {
            return Ok(());
        }
        if matches!(self.shape, Shape::Move(_)) {
            return Err(rejected("Move refused: the load is on its way"));
        }
        let duration = (distance * S::lit(PEAK_SLOPE / SPEED)).max(S::lit(SHORTEST));
        if let Ok(way) = LoadMove::try_new(from, to, duration) {
            self.shape = Shape::Move(way);
            self.time = S::zero();
        }
        Ok(())
    }
}

fn shape_at<S: Scalar>(shape: &Shape<S>, time: S) -> LoadReference<S> {
    match shape {
        Shape::Stay(at) => LoadReference::at_rest(*at),
        Shape::Move(way) => way.at(time),
        Shape::Circle(circle, angle) => circle.at(*angle),
    }
}
