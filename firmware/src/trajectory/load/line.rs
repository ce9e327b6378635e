//! From rest to rest along a straight line, with five continuous derivatives.

use crate::fault::Invalid;
use crate::frames::{V3, World};
use crate::scalar::Scalar;
use crate::signal::LoadReference;
use crate::trajectory::{SmoothMove, Smoothness};

/// A straight move of the load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadMove<S: Scalar> {
    from: World<V3<S>>,
    to: World<V3<S>>,
    share: SmoothMove<S>,
}

impl<S: Scalar> LoadMove<S> {
    /// From and to in m, world axes; duration in s.
    ///
    /// # Errors
    /// [`Invalid`] naming the setting.
    pub fn try_new(from: World<V3<S>>, to: World<V3<S>>, duration: S) -> Result<Self, Invalid> {
        for (field, place) in [("from", &from), ("to", &to)] {
            if place.0.iter().any(|x| !x.is_finite()) {
                return Err(Invalid { field, must: "finite" });
            }
        }
        let share = SmoothMove::try_new(S::zero(), S::one(), duration, Smoothness::C5)?;
        Ok(Self { from, to, share })
    }

    /// At a time since the start, s; at rest before and after.
    #[must_use]
    pub fn at(&self, time: S) -> LoadReference<S> {
        let way = self.to.0 - self.from.0;
        let mut derivatives = self.share.at::<6>(time).map(|share| way * share);
        if let Some(position) = derivatives.first_mut() {
            *position += self.from.0;
        }
        LoadReference(derivatives)
    }

    /// Where it ends.
    #[must_use]
    pub fn end(&self) -> World<V3<S>> {
        self.to
    }

    /// s.
    #[must_use]
    pub fn duration(&self) -> S {
        self.share.duration()
    }
}
