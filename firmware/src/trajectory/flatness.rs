//! Which state and inputs do these outputs require? `planar` section 4.
//!
//! Outputs are given with their time derivatives, value first.

use crate::fault::{Fault, all_finite};
use crate::math::wrap_pi;
use crate::model::{PlanarModel, PlanarState};
use crate::scalar::Scalar;

/// Sign of the thrust: each elevation and link force can be held with either.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ThrustBranch {
    /// Rotors that push up.
    #[default]
    Positive,
    /// The vehicle upside down, or reversible rotors.
    Negative,
}

impl ThrustBranch {
    fn sign<S: Scalar>(self) -> S {
        match self {
            Self::Positive => S::one(),
            Self::Negative => -S::one(),
        }
    }
}

/// State and inputs along a plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlatPoint<S> {
    /// Elevation, pitch, rates.
    pub state: PlanarState<S>,
    /// u1, N.
    pub thrust: S,
    /// u1', N/s.
    pub thrust_rate: S,
    /// u2, N m.
    pub torque: S,
}

impl<S: Scalar> PlanarModel<S> {
    /// For elevation `[φ … φ''']` and pitch `[θ, θ', θ'']`.
    ///
    /// # Errors
    /// [`Fault::NotFinite`]; [`Fault::Degenerate`] where the thrust is along the link, `cos(φ+θ) = 0`.
    pub fn flat_attitude(&self, y1: &[S; 4], y2: &[S; 3]) -> Result<FlatPoint<S>, Fault> {
        all_finite(y1).and(all_finite(y2))?;
        let ([phi, d1, d2, d3], [theta, theta1, theta2]) = (*y1, *y2);
        let (a1, a2) = (self.a1, self.a2);
        let (sin, cos) = phi.sin_cos();
        let (s, c) = (phi + theta).sin_cos();
        let thrust = (d2 - a1 * cos) / (a2 * c);
        let thrust_rate = (d3 + a1 * sin * d1 + a2 * s * (d1 + theta1) * thrust) / (a2 * c);
        let torque = theta2 * self.inertia;
        all_finite(&[thrust, thrust_rate, torque]).map_err(|_| Fault::Degenerate)?;
        let state =
            PlanarState { elevation: phi, elevation_rate: d1, pitch: theta, pitch_rate: theta1 };
        Ok(FlatPoint { state, thrust, thrust_rate, torque })
    }

    /// For elevation `[φ … φ'''']` and link force `[fL, fL', fL'']`; also the thrust acceleration, N/s².
    ///
    /// # Errors
    /// [`Fault::NotFinite`]; [`Fault::Degenerate`] where no thrust is needed at all.
    pub fn flat_force(
        &self,
        y1: &[S; 5],
        y2: &[S; 3],
        branch: ThrustBranch,
    ) -> Result<(FlatPoint<S>, S), Fault> {
        all_finite(y1).and(all_finite(y2))?;
        let ([phi, d1, d2, d3, d4], [force, force1, force2]) = (*y1, *y2);
        let (a1, a2, two) = (self.a1, self.a2, S::lit(2.0));
        let (sin, cos) = phi.sin_cos();
        let across = self.thrust_across(phi, d2);
        let across1 = (d3 + a1 * sin * d1) / a2;
        let across2 = (d4 + a1 * cos * d1 * d1 + a1 * sin * d2) / a2;
        let along = self.thrust_along(phi, d1, force);
        let along1 = force1 - (two * d1 * d2 + a1 * cos * d1) / a2;
        let along2 =
            force2 - (two * d2 * d2 + two * d1 * d3 - a1 * sin * d1 * d1 + a1 * cos * d2) / a2;

        let square = across * across + along * along;
        let n = square.sqrt();
        let slope = across * across1 + along * along1;
        let sign = branch.sign::<S>();
        let z = (sign * along).atan2(sign * across);
        let z1 = (across * along1 - along * across1) / square;
        let z2 = (across * along2 - along * across2) / square - two * z1 * slope / square;
        let curvature = across1 * across1 + along1 * along1 + across * across2 + along * along2;
        let accel = sign * (curvature / n - slope * slope / (n * square));
        let point = FlatPoint {
            state: PlanarState {
                elevation: phi,
                elevation_rate: d1,
                pitch: wrap_pi(z - phi),
                pitch_rate: z1 - d1,
            },
            thrust: sign * n,
            thrust_rate: sign * slope / n,
            torque: (z2 - d2) * self.inertia,
        };
        all_finite(&[point.thrust_rate, point.torque, accel, point.state.pitch_rate])
            .map_err(|_| Fault::Degenerate)?;
        Ok((point, accel))
    }

    /// The branch whose pitch is nearest to the present one.
    ///
    /// # Errors
    /// As [`Self::flat_force`].
    pub fn nearest_branch(
        &self,
        y1: &[S; 5],
        y2: &[S; 3],
        pitch: S,
    ) -> Result<ThrustBranch, Fault> {
        all_finite(&[pitch])?;
        let (point, _) = self.flat_force(y1, y2, ThrustBranch::Positive)?;
        let off = wrap_pi(point.state.pitch - pitch).abs();
        let quarter = S::lit(core::f64::consts::FRAC_PI_2);
        Ok(if off <= quarter { ThrustBranch::Positive } else { ThrustBranch::Negative })
    }
}
