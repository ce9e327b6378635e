//! Holds a tether angle under constant thrust by tilting. `inertial` section 5.

use crate::fault::{Invalid, positive};
use crate::math::GRAVITY;
use crate::model::{TetherAngle, TetherAngleModel};
use crate::scalar::Scalar;

/// Time constants and limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TetherAngleLoop<S> {
    /// Of the tether angle, s.
    pub tether_time: S,
    /// Damping ratio of the tether angle.
    pub tether_damping: S,
    /// Of the tilt, s.
    pub tilt_time: S,
    /// Tension over mass that every asked tilt keeps at rest, m/s²; `None`: the paper's law without guard.
    pub tension_min: Option<S>,
    /// Largest tilt rate, rad/s.
    pub rate_max: S,
}

/// What is asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TetherAngleCommand<S> {
    /// Of the tether, rad/s².
    pub accel: S,
    /// Of the thrust axis, rad.
    pub tilt: S,
    /// Of the tilt, rad/s.
    pub rate: S,
}

impl<S: Scalar> TetherAngleLoop<S> {
    /// The planar tuning: 0.6 s, 0.6, 0.16 s, guard at 1.5 m/s², 6 rad/s.
    #[must_use]
    pub fn planar() -> Self {
        Self {
            tether_time: S::lit(0.6),
            tether_damping: S::lit(0.6),
            tilt_time: S::lit(0.16),
            tension_min: Some(S::lit(1.5)),
            rate_max: S::lit(6.0),
        }
    }

    /// The tuning for two planes at once: 1.2 s, 0.8, 4 rad/s.
    #[must_use]
    pub fn spatial() -> Self {
        Self {
            tether_time: S::lit(1.2),
            tether_damping: S::lit(0.8),
            rate_max: S::lit(4.0),
            ..Self::planar()
        }
    }

    /// Refuses what cannot be divided by.
    ///
    /// # Errors
    /// [`Invalid`] naming the setting.
    pub fn validate(self) -> Result<Self, Invalid> {
        positive("tether_time", self.tether_time)?;
        positive("tilt_time", self.tilt_time)?;
        positive("rate_max", self.rate_max)?;
        Ok(self)
    }

    /// Tilt rate that brings the tether to `reference`, rad (17).
    #[must_use]
    pub fn step(
        &self,
        model: &TetherAngleModel<S>,
        reference: S,
        x: &TetherAngle<S>,
    ) -> TetherAngleCommand<S> {
        let g = S::lit(GRAVITY);
        let tau = self.tether_time;
        let accel =
            (reference - x.angle) / (tau * tau) - S::lit(2.0) * self.tether_damping / tau * x.rate;
        let (sin, cos) = x.angle.sin_cos();
        let mut lean = ((g * sin - model.length * accel) / model.thrust).asin();
        if let Some(least) = self.tension_min {
            lean = lean.limit_abs(((least + g * cos) / model.thrust).acos());
        }
        let tilt = x.angle - lean;
        let rate = ((tilt - x.tilt) / self.tilt_time).limit_abs(self.rate_max);
        TetherAngleCommand { accel, tilt, rate }
    }
}

/// Angular acceleration, rad/s², that cancels the torque of a tether attached `below` m under the centre
/// of mass (21). `mass_over_inertia` in 1/m², `force_x` the specific force along body x, m/s².
#[must_use]
pub fn attachment_compensation<S: Scalar>(below: S, mass_over_inertia: S, force_x: S) -> S {
    below * mass_over_inertia * force_x
}
