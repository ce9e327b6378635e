//! Elevation and pitch: Γa with the thrust as input, Γa' with its rate. `planar` sections 6.1, 6.2.

use super::Inversion;
use crate::fault::{Fault, Invalid, all_finite};
use crate::math::{gains_from_poles, wrap_pi};
use crate::model::{PlanarModel, PlanarState};
use crate::scalar::Scalar;

/// Γa: static. Knows no thrust rate, so the observer cannot serve it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElevationAttitudeStatic<S> {
    model: PlanarModel<S>,
    elevation_gains: [S; 2],
    pitch_gains: [S; 2],
    inversion: Inversion<S>,
}

/// Γa': the thrust is a state of the controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElevationAttitude<S> {
    model: PlanarModel<S>,
    elevation_gains: [S; 3],
    pitch_gains: [S; 2],
    inversion: Inversion<S>,
}

impl<S: Scalar> ElevationAttitudeStatic<S> {
    /// From real poles, 1/s. Like the force law's but for what its second output is.
    ///
    /// # Errors
    /// [`Invalid`] naming `elevation_poles`, `pitch_poles`, `damping` or `threshold`.
    pub fn try_new(
        model: PlanarModel<S>,
        elevation_poles: &[S; 2],
        pitch_poles: &[S; 2],
        inversion: Inversion<S>,
    ) -> Result<Self, Invalid> {
        Ok(Self {
            model,
            elevation_gains: gains_from_poles("elevation_poles", elevation_poles)?,
            pitch_gains: gains_from_poles("pitch_poles", pitch_poles)?,
            inversion: inversion.check()?,
        })
    }

    /// Thrust, N, and torque, N m, for references with derivatives (rad, s).
    ///
    /// # Errors
    /// [`Fault::NotFinite`]; [`Fault::Degenerate`] at the singularity with [`Inversion::Exact`].
    pub fn step(&self, x: &PlanarState<S>, y1: &[S; 3], y2: &[S; 3]) -> Result<(S, S), Fault> {
        all_finite(y1).and(all_finite(y2)).and(all_finite(&x.to_array()))?;
        let m = &self.model;
        let ([phi, phi1, phi2], [k1, k2]) = (*y1, self.elevation_gains);
        let wanted = phi2 + k1 * wrap_pi(phi - x.elevation) + k2 * (phi1 - x.elevation_rate);
        let gravity = m.a1 * x.elevation.sin_cos().1;
        let across = m.a2 * (x.elevation + x.pitch).sin_cos().1;
        let thrust = self.inversion.divide(wanted - gravity, across);
        let torque = m.inertia * pitch_accel(&self.pitch_gains, x, y2);
        all_finite(&[thrust, torque]).map_err(|_| Fault::Degenerate)?;
        Ok((thrust, torque))
    }
}

impl<S: Scalar> ElevationAttitude<S> {
    /// From real poles, 1/s.
    ///
    /// # Errors
    /// [`Invalid`] naming `elevation_poles`, `pitch_poles`, `damping` or `threshold`.
    pub fn try_new(
        model: PlanarModel<S>,
        elevation_poles: &[S; 3],
        pitch_poles: &[S; 2],
        inversion: Inversion<S>,
    ) -> Result<Self, Invalid> {
        Ok(Self {
            model,
            elevation_gains: gains_from_poles("elevation_poles", elevation_poles)?,
            pitch_gains: gains_from_poles("pitch_poles", pitch_poles)?,
            inversion: inversion.check()?,
        })
    }

    /// `b1 = -a1 sin φ φ' - a2 sin(φ+θ)(φ'+θ') u1`: what φ''' is without a thrust rate.
    #[must_use]
    pub fn drift(&self, x: &PlanarState<S>, thrust: S) -> S {
        let m = &self.model;
        let (s, _) = (x.elevation + x.pitch).sin_cos();
        let turn = x.elevation_rate + x.pitch_rate;
        -m.a1 * x.elevation.sin_cos().0 * x.elevation_rate - m.a2 * s * turn * thrust
    }

    /// Thrust rate, N/s, and torque, N m, for references with derivatives (rad, s).
    ///
    /// # Errors
    /// [`Fault::NotFinite`]; [`Fault::Degenerate`] at the singularity with [`Inversion::Exact`].
    pub fn step(
        &self,
        x: &PlanarState<S>,
        thrust: S,
        y1: &[S; 4],
        y2: &[S; 3],
    ) -> Result<(S, S), Fault> {
        all_finite(y1).and(all_finite(y2)).and(all_finite(&x.to_array()))?;
        all_finite(&[thrust])?;
        let ([phi, phi1, phi2, phi3], [k1, k2, k3]) = (*y1, self.elevation_gains);
        let accel = self.model.elevation_accel(x, thrust);
        let wanted = phi3
            + k1 * wrap_pi(phi - x.elevation)
            + k2 * (phi1 - x.elevation_rate)
            + k3 * (phi2 - accel);
        let across = self.model.a2 * (x.elevation + x.pitch).sin_cos().1;
        let rate = self.inversion.divide(wanted - self.drift(x, thrust), across);
        let torque = self.model.inertia * pitch_accel(&self.pitch_gains, x, y2);
        all_finite(&[rate, torque]).map_err(|_| Fault::Degenerate)?;
        Ok((rate, torque))
    }
}

fn pitch_accel<S: Scalar>([k1, k2]: &[S; 2], x: &PlanarState<S>, y2: &[S; 3]) -> S {
    let [theta, theta1, theta2] = *y2;
    theta2 + *k1 * wrap_pi(theta - x.pitch) + *k2 * (theta1 - x.pitch_rate)
}
