//! A simple fence: a radius around the anchor and a height over it.

use super::Params;
use crate::frames::V3;

impl Params {
    /// Whether there is a fence at all.
    #[must_use]
    pub fn has_fence(&self) -> bool {
        self.fence_action > 0.0
    }

    /// Whether a breach is told and nothing else.
    #[must_use]
    pub fn fence_only_warns(&self) -> bool {
        self.fence_action as i32 == 1
    }

    /// Whether a place, world axes from the anchor, m, at this height over it, m, is inside.
    #[must_use]
    pub fn is_inside_fence(&self, place: V3<f32>, height: f32) -> bool {
        let within = |x: f32, limit: f32| limit <= 0.0 || x <= limit;
        let out = libm::hypotf(place.x, place.y);
        within(out, self.fence_radius) && within(height, self.fence_height)
    }
}
