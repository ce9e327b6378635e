//! One of the two dynamic laws, with its thrust.

use super::{Applied, ElevationAttitude, ElevationForce, ThrustLimits, ThrustState};
use crate::fault::Fault;
use crate::model::PlanarState;
use crate::scalar::Scalar;
use crate::signal::PlanarReference;

/// Which outputs are controlled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law<S> {
    /// Elevation and pitch, Γa'.
    Attitude(ElevationAttitude<S>),
    /// Elevation and link force, Γb.
    Force(ElevationForce<S>),
}

impl<S: Scalar> Law<S> {
    /// Advances the thrust over `dt` s; what to apply, and the torque, N m.
    ///
    /// # Errors
    /// As the law's own step; the thrust is untouched.
    pub fn advance(
        &self,
        thrust: &mut ThrustState<S>,
        x: &PlanarState<S>,
        reference: &PlanarReference<S>,
        dt: S,
        limits: Option<&ThrustLimits<S>>,
    ) -> Result<(Applied<S>, S), Fault> {
        let [phi, phi1, phi2, phi3, _] = reference.elevation;
        let (applied, torque) = match self {
            Self::Attitude(law) => {
                let y1 = [phi, phi1, phi2, phi3];
                let (rate, torque) = law.step(x, thrust.thrust, &y1, &reference.second)?;
                (thrust.advance_rate(rate, dt, limits), torque)
            }
            Self::Force(law) => {
                let (accel, torque) =
                    law.step(x, thrust, &reference.elevation, &reference.second)?;
                (thrust.advance_accel(accel, dt, limits), torque)
            }
        };
        Ok((applied, limits.map_or(torque, |l| torque.limit_abs(l.torque))))
    }
}
