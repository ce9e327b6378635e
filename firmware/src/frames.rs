//! In which axes is this vector?
//!
//! World: NED, origin at the anchor. Body: FRD. `docs/frames.md` draws both.

use crate::math::so3;
use crate::scalar::Scalar;

/// Three components.
pub type V3<S> = nalgebra::Vector3<S>;
/// Three by three.
pub type M3<S> = nalgebra::Matrix3<S>;

/// A vector in world axes (NED, origin at the anchor).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct World<T>(pub T);

/// A vector in body axes (FRD).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body<T>(pub T);

/// Rotation from body to world axes, `R_WB`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attitude<S: Scalar>(pub M3<S>);

impl<S: Scalar> Attitude<S> {
    /// Level, nose at `yaw` rad from North.
    #[must_use]
    pub fn level(yaw: S) -> Self {
        Self::from_euler(S::zero(), S::zero(), yaw)
    }

    /// From roll, pitch, yaw, rad, in the order yaw-pitch-roll (ZYX).
    #[must_use]
    pub fn from_euler(roll: S, pitch: S, yaw: S) -> Self {
        let ((sr, cr), (sp, cp), (sy, cy)) = (roll.sin_cos(), pitch.sin_cos(), yaw.sin_cos());
        Self(M3::new(
            cy * cp,
            cy * sp * sr - sy * cr,
            cy * sp * cr + sy * sr,
            sy * cp,
            sy * sp * sr + cy * cr,
            sy * sp * cr - cy * sr,
            -sp,
            cp * sr,
            cp * cr,
        ))
    }

    /// Roll, pitch, yaw, rad. Yaw takes the whole rotation when the nose points straight up or down.
    #[must_use]
    pub fn euler(&self) -> (S, S, S) {
        let r = &self.0;
        let horizontal = (r.m11 * r.m11 + r.m21 * r.m21).sqrt();
        (r.m32.atan2(r.m33), (-r.m31).atan2(horizontal), r.m21.atan2(r.m11))
    }

    /// Unit quaternion `[w, x, y, z]`, body to world, w >= 0.
    #[must_use]
    pub fn quaternion(&self) -> [S; 4] {
        so3::quaternion(&self.0)
    }

    /// Rotates a body vector to world axes.
    #[must_use]
    pub fn to_world(&self, v: Body<V3<S>>) -> World<V3<S>> {
        World(self.0 * v.0)
    }

    /// Rotates a world vector to body axes.
    #[must_use]
    pub fn to_body(&self, v: World<V3<S>>) -> Body<V3<S>> {
        Body(so3::transpose_mul(&self.0, &v.0))
    }

    /// Cosine of the angle between the body's down axis and the world's.
    #[must_use]
    pub fn cos_tilt(&self) -> S {
        self.0.m33
    }
}
