//! What the observer is told at construction.

use super::BranchIndex;
use crate::fault::{Invalid, not_negative, positive};
use crate::model::PlanarModel;

/// Which branches run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Branches {
    /// Both; this one is selected at first.
    Both(BranchIndex),
    /// Only the one that starts in tension.
    One,
}

/// Which residual tells the branches apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Discrimination {
    /// Predicted against measured specific force, as in the articles.
    Acceleration,
    /// How far sine and cosine of the reconstructed elevation are from a unit vector, times g: sharper.
    UnitVector,
}

/// How a branch is advanced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Update {
    /// Predictor and corrector with the gyro's trapezium: what flies.
    #[default]
    PredictorCorrector,
    /// The same with the gyro held.
    PredictorCorrectorHeld,
    /// The articles' differential equation, forward Euler, measurement held.
    Euler,
    /// The same by Runge-Kutta.
    Rk4Held,
    /// The same by matrix exponential.
    ExactHeld,
}

/// When the branch that is not selected stops for good: its residual stayed above three times the
/// confident one for so long.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SwitchOff {
    /// Residual below which the selected branch counts as confident, m/s².
    pub confident: f64,
    /// s.
    pub time: f64,
}

/// Settings; [`Self::new`] has the specification's defaults.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HighGainSettings<S> {
    /// Mass and length as believed.
    pub model: PlanarModel<S>,
    /// Roots of the error dynamics in units of 1/ε, negative.
    pub roots: [f64; 3],
    /// High-gain parameter ε; smaller is faster and noisier.
    pub epsilon: f64,
    /// Another ε, for the first seconds.
    pub fast_start: Option<(f64, f64)>,
    /// s.
    pub period: f64,
    /// How branches advance.
    pub update: Update,
    /// Which run.
    pub branches: Branches,
    /// Whether the sign of the link force follows the selected angle; without, it stays as it began.
    pub sign_is_continuous: bool,
    /// Residual.
    pub discrimination: Discrimination,
    /// m/s².
    pub hysteresis: f64,
    /// The vehicle is above the anchor.
    pub is_above_ground: bool,
    /// Rate of the residuals' low-pass, 1/s.
    pub forgetting: f64,
    /// When the other branch stops.
    pub switch_off: Option<SwitchOff>,
    /// Link force over mass below which the angle is not used, m/s².
    pub force_min: f64,
    /// Bound of |φ'|, rad/s.
    pub rate_max: f64,
    /// Bound of |φ''|, rad/s².
    pub accel_max: f64,
    /// Start anew when no residual stayed below this many m/s² for so many s.
    pub restart: Option<(f64, f64)>,
}

impl<S> HighGainSettings<S> {
    /// The defaults of `planar` sections 7 and 8.
    #[must_use]
    pub fn new(model: PlanarModel<S>, period: f64) -> Self {
        Self {
            model,
            roots: [-6.0, -4.5, -3.0],
            epsilon: 0.1,
            fast_start: None,
            period,
            update: Update::default(),
            branches: Branches::Both(BranchIndex::A),
            sign_is_continuous: true,
            discrimination: Discrimination::UnitVector,
            hysteresis: 0.05,
            is_above_ground: true,
            forgetting: 20.0,
            switch_off: None,
            force_min: 0.05,
            rate_max: 10.0,
            accel_max: 100.0,
            restart: Some((3.0, 0.3)),
        }
    }

    /// Everything but roots, ε and period, which the gain checks.
    pub(super) fn check(&self) -> Result<(), Invalid> {
        not_negative("hysteresis", self.hysteresis)?;
        positive("forgetting", self.forgetting)?;
        not_negative("force_min", self.force_min)?;
        positive("rate_max", self.rate_max)?;
        positive("accel_max", self.accel_max)?;
        if let Some(off) = &self.switch_off {
            positive("switch_off.confident", off.confident)?;
            positive("switch_off.time", off.time)?;
        }
        if let Some((residual, time)) = self.restart {
            positive("restart residual", residual)?;
            positive("restart time", time)?;
        }
        if let Some((_, time)) = self.fast_start {
            positive("fast_start time", time)?;
        }
        Ok(())
    }
}
