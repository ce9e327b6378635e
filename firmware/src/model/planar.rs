//! Vehicle on a taut, straight, massless link in a vertical plane. `planar` sections 1 to 3.
//!
//! Plane: x horizontal away from the anchor's azimuth reference, z up, anchor at the origin. The
//! elevation φ of anchor→vehicle rises from +x; the pitch θ tilts the thrust from straight up towards
//! +x. `docs/frames.md` draws how this plane sits in NED. The link force is positive in tension.

use crate::fault::{Invalid, positive};
use crate::math::wrap_pi;
use crate::scalar::Scalar;

/// Elevation, pitch and their rates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlanarState<S> {
    /// φ, rad.
    pub elevation: S,
    /// φ', rad/s.
    pub elevation_rate: S,
    /// θ, rad.
    pub pitch: S,
    /// θ', rad/s.
    pub pitch_rate: S,
}

/// In other angles than [`super::TiltImu`]: what an accelerometer at the centre of mass and a gyro read in the plane: axes `x = (-cos θ, sin θ)`,
/// `z = (-sin θ, -cos θ)` (down when level), y into the plane's right-handed third.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlanarImu<S> {
    /// Specific force along x, m/s².
    pub x: S,
    /// Along z, m/s²; -g in free hover.
    pub z: S,
    /// θ', rad/s.
    pub rate: S,
}

/// Mass, inertia and link length as the algorithms believe them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarModel<S> {
    /// kg.
    pub(crate) mass: S,
    /// kg m².
    pub(crate) inertia: S,
    /// m.
    pub(crate) length: S,
    /// m/s².
    pub(crate) gravity: S,
    /// -g/l, 1/s². Negative.
    pub(crate) a1: S,
    /// 1/(m l), 1/(kg m).
    pub(crate) a2: S,
}

impl<S: Scalar> PlanarModel<S> {
    /// From mass, kg, moment of inertia about the plane's normal, kg m², link length, m, and gravity, m/s².
    ///
    /// # Errors
    /// [`Invalid`] naming the first that is not finite and positive.
    pub fn try_new(mass: S, inertia: S, length: S, gravity: S) -> Result<Self, Invalid> {
        let mass = positive("mass", mass)?;
        let inertia = positive("inertia", inertia)?;
        let length = positive("length", length)?;
        let gravity = positive("gravity", gravity)?;
        let (a1, a2) = (-gravity / length, S::one() / (mass * length));
        let a1 = -positive("gravity / length", -a1)?;
        let a2 = positive("1 / (mass length)", a2)?;
        Ok(Self { mass, inertia, length, gravity, a1, a2 })
    }

    /// kg.
    #[must_use]
    pub fn mass(&self) -> S {
        self.mass
    }
    /// kg m².
    #[must_use]
    pub fn inertia(&self) -> S {
        self.inertia
    }
    /// m.
    #[must_use]
    pub fn length(&self) -> S {
        self.length
    }

    /// Elevation acceleration, rad/s²: `a1 cos φ + a2 cos(φ+θ) u1`.
    #[must_use]
    pub fn elevation_accel(&self, x: &PlanarState<S>, thrust: S) -> S {
        let (_, cos) = x.elevation.sin_cos();
        let (_, c) = (x.elevation + x.pitch).sin_cos();
        self.a1 * cos + self.a2 * c * thrust
    }

    /// Time derivative of the state under thrust, N, and torque, N m.
    #[must_use]
    pub fn derivative(&self, x: &PlanarState<S>, thrust: S, torque: S) -> PlanarState<S> {
        PlanarState {
            elevation: x.elevation_rate,
            elevation_rate: self.elevation_accel(x, thrust),
            pitch: x.pitch_rate,
            pitch_rate: torque / self.inertia,
        }
    }

    /// Force of the link, N, positive in tension: `φ'²/a2 + (a1/a2) sin φ + sin(φ+θ) u1`.
    #[must_use]
    pub fn link_force(&self, x: &PlanarState<S>, thrust: S) -> S {
        let (sin, _) = x.elevation.sin_cos();
        let (s, _) = (x.elevation + x.pitch).sin_cos();
        (x.elevation_rate * x.elevation_rate + self.a1 * sin) / self.a2 + s * thrust
    }

    /// Inertial reading: the link force over the mass, turned by `φ+θ`, minus the thrust over the mass.
    #[must_use]
    pub fn imu(&self, x: &PlanarState<S>, thrust: S) -> PlanarImu<S> {
        let (s, c) = (x.elevation + x.pitch).sin_cos();
        let pull = self.link_force(x, thrust) / self.mass;
        PlanarImu { x: pull * c, z: pull * s - thrust / self.mass, rate: x.pitch_rate }
    }

    /// Thrust across and along the link that a motion needs (`P` and `S` of `planar` section 2), N.
    pub(crate) fn thrust_across(&self, elevation: S, accel: S) -> S {
        (accel - self.a1 * elevation.sin_cos().1) / self.a2
    }
    /// See [`Self::thrust_across`].
    pub(crate) fn thrust_along(&self, elevation: S, rate: S, link_force: S) -> S {
        link_force - (rate * rate + self.a1 * elevation.sin_cos().0) / self.a2
    }
}

impl<S: Scalar> PlanarState<S> {
    /// As `[φ, φ', θ, θ']`.
    #[must_use]
    pub fn to_array(&self) -> [S; 4] {
        [self.elevation, self.elevation_rate, self.pitch, self.pitch_rate]
    }

    /// From `[φ, φ', θ, θ']`.
    #[must_use]
    pub fn from_array([elevation, elevation_rate, pitch, pitch_rate]: [S; 4]) -> Self {
        Self { elevation, elevation_rate, pitch, pitch_rate }
    }

    /// With the pitch wrapped to (-pi, pi].
    #[must_use]
    pub(crate) fn wrapped(self) -> Self {
        Self { pitch: wrap_pi(self.pitch), ..self }
    }
}
