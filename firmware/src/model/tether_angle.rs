//! A point mass under constant thrust on a taut tether, in a vertical plane. `inertial` sections 1, 2.
//!
//! Angles from straight up, positive towards the plane's horizontal axis: the tether's `ths` (anchor to
//! vehicle) and the body's tilt `thv` (thrust axis). Forces are divided by the mass, m/s². The tension
//! is positive towards the anchor.

use crate::fault::{Invalid, positive};
use crate::math::GRAVITY;
use crate::scalar::Scalar;

/// Tether angle, its rate, and body tilt.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TetherAngle<S> {
    /// rad from straight up.
    pub angle: S,
    /// rad/s.
    pub rate: S,
    /// Tilt of the thrust axis, rad.
    pub tilt: S,
}

/// What an accelerometer at the centre of mass and a gyro show in the plane: x is the body's axis that
/// points along the plane's horizontal when level, z the thrust axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TiltImu<S> {
    /// Specific force, m/s².
    pub x: S,
    /// Specific force, m/s²; g at rest on a table.
    pub z: S,
    /// Of the tilt, rad/s, mean over the interval that just ended.
    pub rate: S,
}

/// Thrust and length as the algorithms believe them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TetherAngleModel<S> {
    /// Thrust over mass, m/s².
    pub(crate) thrust: S,
    /// m.
    pub(crate) length: S,
}

impl<S: Scalar> TetherAngleModel<S> {
    /// From thrust over mass, m/s², and length, m.
    ///
    /// # Errors
    /// [`Invalid`] naming the one that is not finite and positive.
    pub fn try_new(thrust: S, length: S) -> Result<Self, Invalid> {
        Ok(Self { thrust: positive("thrust", thrust)?, length: positive("length", length)? })
    }

    /// Thrust over mass, m/s².
    #[must_use]
    pub fn thrust(&self) -> S {
        self.thrust
    }

    /// m.
    #[must_use]
    pub fn length(&self) -> S {
        self.length
    }

    /// Tension over mass, m/s² (2), for an anchor that accelerates by `anchor` (horizontal, up), m/s².
    /// Negative where the tether would have to push.
    #[must_use]
    pub fn tension(&self, x: &TetherAngle<S>, anchor: [S; 2]) -> S {
        let (sin, cos) = x.angle.sin_cos();
        let (_, along) = (x.angle - x.tilt).sin_cos();
        let [ax, az] = anchor;
        self.thrust * along - S::lit(GRAVITY) * cos + self.length * x.rate * x.rate
            - (ax * sin + az * cos)
    }

    /// Angular acceleration of the tether, rad/s² (3), for an anchor that accelerates by `anchor`.
    #[must_use]
    pub fn angular_accel(&self, x: &TetherAngle<S>, anchor: [S; 2]) -> S {
        let (sin, cos) = x.angle.sin_cos();
        let (across, _) = (x.angle - x.tilt).sin_cos();
        let [ax, az] = anchor;
        (S::lit(GRAVITY) * sin - self.thrust * across - (ax * cos - az * sin)) / self.length
    }

    /// Specific force along body x and z, m/s² (4), under the given tension over mass.
    #[must_use]
    pub fn specific_force(&self, x: &TetherAngle<S>, tension: S) -> [S; 2] {
        let (sin, cos) = (x.angle - x.tilt).sin_cos();
        [-tension * sin, self.thrust - tension * cos]
    }

    /// Tilt at which the tether rests at `angle` (9); `None` where the thrust does not suffice.
    #[must_use]
    pub fn equilibrium_tilt(&self, angle: S) -> Option<S> {
        let needed = S::lit(GRAVITY) * angle.sin_cos().0 / self.thrust;
        (needed.abs() <= S::one()).then(|| angle - needed.asin())
    }

    /// The state after `dt` s with a constant rate of the tilt: one Runge–Kutta step of fourth order.
    #[must_use]
    pub fn advance(&self, x: &TetherAngle<S>, tilt_rate: S, dt: S) -> TetherAngle<S> {
        let (half, o) = (dt * S::lit(0.5), S::zero());
        let middle_tilt = x.tilt + tilt_rate * half;
        let end_tilt = x.tilt + tilt_rate * dt;
        let accel =
            |angle: S, tilt: S| self.angular_accel(&TetherAngle { angle, rate: o, tilt }, [o, o]);
        let a1 = accel(x.angle, x.tilt);
        let w2 = x.rate + a1 * half;
        let a2 = accel(x.angle + x.rate * half, middle_tilt);
        let w3 = x.rate + a2 * half;
        let a3 = accel(x.angle + w2 * half, middle_tilt);
        let w4 = x.rate + a3 * dt;
        let a4 = accel(x.angle + w3 * dt, end_tilt);
        let (two, sixth) = (S::lit(2.0), dt * S::lit(1.0 / 6.0));
        TetherAngle {
            angle: x.angle + (x.rate + (w2 + w3) * two + w4) * sixth,
            rate: x.rate + (a1 + (a2 + a3) * two + a4) * sixth,
            tilt: end_tilt,
        }
    }
}
