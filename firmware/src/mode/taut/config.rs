//! Observer, laws and bounds on a taut link.

use crate::control::taut::TautController;
use crate::estimate::taut::TautEstimator;
use crate::model::TetherKind;
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::TautPurpose;
use crate::trajectory::TautBounds;

/// Configuration of everything on a taut link.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TautConfig<S: Scalar> {
    pub estimator: TautEstimator<S>,
    force: TautController<S>,
    attitude: TautController<S>,
    pub(super) bounds: TautBounds<S>,
    /// s; `None`: by inertia alone.
    pub(super) altimeter_tau: Option<S>,
    pub(super) force_min: S,
    pub(super) cruise: S,
}

impl<S: Scalar> TautConfig<S> {
    /// From the parameters; `None` where their ranges let something impossible through.
    pub fn new(p: &Params) -> Option<Self> {
        let estimator = TautEstimator::try_new(p).ok()?;
        let model = *estimator.model();
        let force = TautController::try_new(p, model, TautPurpose::Force).ok()?;
        let attitude = TautController::try_new(p, model, TautPurpose::Attitude).ok()?;
        Some(Self {
            bounds: TautBounds {
                model,
                kind: TetherKind::from_parameter(p.tether_kind),
                thrust: force.thrust_range(),
                // What the observer cannot see is no set-point.
                force_min: S::from_f32(p.taut_force_min).max(estimator.force_floor()),
                elevation: (S::from_f32(p.elevation_min), S::from_f32(p.elevation_max)),
            },
            estimator,
            force,
            attitude,
            altimeter_tau: (p.taut_altimeter_tau > 0.0).then(|| S::from_f32(p.taut_altimeter_tau)),
            force_min: S::from_f32(p.taut_force_min),
            cruise: S::from_f32(p.cruise_speed),
        })
    }

    pub(super) fn controller(&self, purpose: TautPurpose) -> &TautController<S> {
        match purpose {
            TautPurpose::Force => &self.force,
            TautPurpose::Attitude => &self.attitude,
        }
    }
}
