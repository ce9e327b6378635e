//! Elevation and link force: Γb, with the thrust's acceleration as input. `planar` section 6.3.

use super::{Inversion, ThrustState};
use crate::fault::{Fault, Invalid, all_finite};
use crate::math::{gains_from_poles, wrap_pi};
use crate::model::{PlanarModel, PlanarState};
use crate::scalar::Scalar;

/// Γb.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElevationForce<S> {
    model: PlanarModel<S>,
    elevation_gains: [S; 4],
    force_gains: [S; 2],
    inversion: Inversion<S>,
}

/// The controlled outputs and their derivatives, and the drift of the highest ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceOutputs<S> {
    /// φ to φ''', rad and s.
    pub elevation: [S; 4],
    /// fL and fL', N and s.
    pub force: [S; 2],
    /// What φ'''' and fL'' are without input.
    pub drift: [S; 2],
}

impl<S: Scalar> ElevationForce<S> {
    /// From real poles, 1/s.
    ///
    /// # Errors
    /// [`Invalid`] naming `elevation_poles`, `force_poles`, `damping` or `threshold`.
    pub fn try_new(
        model: PlanarModel<S>,
        elevation_poles: &[S; 4],
        force_poles: &[S; 2],
        inversion: Inversion<S>,
    ) -> Result<Self, Invalid> {
        Ok(Self {
            model,
            elevation_gains: gains_from_poles("elevation_poles", elevation_poles)?,
            force_gains: gains_from_poles("force_poles", force_poles)?,
            inversion: inversion.check()?,
        })
    }

    /// Outputs and drift in this state. The decoupling matrix is
    /// `[[a2 c, -a2 s u1 / J], [s, c u1 / J]]` with `s, c` of φ+θ.
    #[must_use]
    pub fn outputs(&self, x: &PlanarState<S>, thrust: &ThrustState<S>) -> ForceOutputs<S> {
        self.outputs_with(x, thrust, (x.elevation + x.pitch).sin_cos())
    }

    fn outputs_with(
        &self,
        x: &PlanarState<S>,
        thrust: &ThrustState<S>,
        (s, c): (S, S),
    ) -> ForceOutputs<S> {
        let (a1, a2, two) = (self.model.a1, self.model.a2, S::lit(2.0));
        let (u, du) = (thrust.thrust, thrust.rate);
        let (sin, cos) = x.elevation.sin_cos();
        let rate = x.elevation_rate;
        let turn = rate + x.pitch_rate;
        let ratio = a1 / a2;
        let accel = a1 * cos + a2 * c * u;
        let jerk = -a1 * sin * rate - a2 * s * turn * u + a2 * c * du;
        let force = rate * rate / a2 + ratio * sin + s * u;
        let force_rate = two * rate * accel / a2 + ratio * cos * rate + c * turn * u + s * du;
        let drift_elevation = -a1 * cos * rate * rate
            - a1 * sin * accel
            - a2 * c * turn * turn * u
            - a2 * s * accel * u
            - two * a2 * s * turn * du;
        let drift_force = two / a2 * (accel * accel + rate * jerk)
            + ratio * (-sin * rate * rate + cos * accel)
            - s * turn * turn * u
            + c * accel * u
            + two * c * turn * du;
        ForceOutputs {
            elevation: [x.elevation, rate, accel, jerk],
            force: [force, force_rate],
            drift: [drift_elevation, drift_force],
        }
    }

    /// Thrust acceleration, N/s², and torque, N m, for references with derivatives (rad, N, s).
    ///
    /// # Errors
    /// [`Fault::NotFinite`]; [`Fault::Degenerate`] at zero thrust with [`Inversion::Exact`].
    pub fn step(
        &self,
        x: &PlanarState<S>,
        thrust: &ThrustState<S>,
        y1: &[S; 5],
        y2: &[S; 3],
    ) -> Result<(S, S), Fault> {
        all_finite(y1).and(all_finite(y2)).and(all_finite(&x.to_array()))?;
        all_finite(&[thrust.thrust, thrust.rate])?;
        let (s, c) = (x.elevation + x.pitch).sin_cos();
        let now = self.outputs_with(x, thrust, (s, c));
        let ([_, phi1, phi2, phi3], [force, force1]) = (now.elevation, now.force);
        let ([k1, k2, k3, k4], [h1, h2]) = (self.elevation_gains, self.force_gains);
        let [yd, yd1, yd2, yd3, yd4] = *y1;
        let [fd, fd1, fd2] = *y2;
        let v1 = yd4
            + k1 * wrap_pi(yd - x.elevation)
            + k2 * (yd1 - phi1)
            + k3 * (yd2 - phi2)
            + k4 * (yd3 - phi3);
        let v2 = fd2 + h1 * (fd - force) + h2 * (fd1 - force1);
        let [b1, b2] = now.drift;
        let (accel, torque) = self.invert((s, c), thrust.thrust, [v1 - b1, v2 - b2]);
        all_finite(&[accel, torque]).map_err(|_| Fault::Degenerate)?;
        Ok((accel, torque))
    }

    /// Rows scaled alike, the matrix is a rotation by φ+θ times `diag(1, u1/J)`: only the torque is
    /// singular, at zero thrust.
    fn invert(&self, (s, c): (S, S), u: S, [r1, r2]: [S; 2]) -> (S, S) {
        let (a2, j) = (self.model.a2, self.model.inertia);
        if let Inversion::Damped { damping } = self.inversion {
            return damped(a2, j, (s, c), u, [r1, r2], damping * damping);
        }
        let along = c * r1 / a2 + s * r2;
        let across = -s * r1 / a2 + c * r2;
        (along, j * self.inversion.divide(across, u))
    }
}

/// `Eᵀ (E Eᵀ + c² I)⁻¹ r` in the matrix's own units, as `(det E adj E + c² Eᵀ) r` over the sum of squares that
/// the determinant is, with `det E = a2 u1/J`: products of nearly equal size would cancel, in `f32` to 0.7 %.
fn damped<S: Scalar>(a2: S, j: S, (s, c): (S, S), u: S, [r1, r2]: [S; 2], square: S) -> (S, S) {
    let (e11, e12, e21, e22) = (a2 * c, -a2 * s * u / j, s, c * u / j);
    let whole = a2 * u / j;
    let sum = e11 * e11 + e12 * e12 + e21 * e21 + e22 * e22;
    let det = whole * whole + square * (sum + square);
    let x1 = whole * (e22 * r1 - e12 * r2) + square * (e11 * r1 + e21 * r2);
    let x2 = whole * (e11 * r2 - e21 * r1) + square * (e12 * r1 + e22 * r2);
    (x1 / det, x2 / det)
}
