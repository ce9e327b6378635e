//! What the earth's field says of the heading.

use crate::frames::{Attitude, Body, V3};
use crate::math::wrap_pi;
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::{Aid, AidSet};

/// Configuration.
#[derive(Clone, Copy, Debug)]
pub(super) struct Compass<S> {
    /// How far East of North the field points, rad; `None`: no compass is wanted.
    declination: Option<S>,
}

impl<S: Scalar> Compass<S> {
    pub fn new(p: &Params) -> Self {
        let is_wanted = AidSet::from_parameter(p.aids).contains(Aid::Compass);
        Self { declination: is_wanted.then(|| S::from_f32(p.declination)) }
    }

    /// By how much the true heading is more than an attitude's, rad, from the field in body axes.
    pub fn deviation(&self, attitude: &Attitude<S>, field: Option<Body<V3<S>>>) -> Option<S> {
        let seen = attitude.to_world(field?).0;
        Some(wrap_pi(self.declination? - seen.y.atan2(seen.x)))
    }
}
