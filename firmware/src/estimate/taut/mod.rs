//! Elevation, pitch, link force and the motion out of the plane from accelerometer and gyro, on a taut link in
//! three dimensions. `flight` sections 1 to 4.
//!
//! The high-gain observer sees the vertical plane through nose and anchor; a small Kalman filter sees
//! what happens across it. Both need the nose within some 20° of the direction away from the anchor.
//! Runs from lift-off on, so that it has converged when a mode wants it.

mod out_of_plane;

pub use out_of_plane::{OutOfPlaneFilter, OutOfPlaneInput, OutOfPlaneState};

use super::high_gain::{Branches, HighGain, HighGainInput, HighGainSettings, HighGainState};
use crate::fault::Invalid;
use crate::frames::{Body, V3};
use crate::math::GRAVITY;
use crate::math::filter::{Biquad, Biquad3State, BiquadState};
use crate::model::{PlanarImu, PlanarModel, PlanarState, TetherKind};
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::{Imu, TautPurpose};
use crate::time::OUTER_DT;

/// Low-pass of specific force, rate and thrust alike, Hz.
const CUTOFF_HZ: f32 = 10.0;
/// Link force over mass without a usable direction, m/s²: cable, strut or bar. A bar's force passes
/// through zero, and noise near it throws the estimate off: better blind for longer.
const CABLE_FORCE_MIN: f64 = 0.5;
const RIGID_FORCE_MIN: f64 = 1.2;

/// Configuration.
#[derive(Clone, Copy, Debug)]
pub struct TautEstimator<S: Scalar> {
    force: HighGain<S>,
    attitude: HighGain<S>,
    filter: Biquad<S>,
    out_of_plane: OutOfPlaneFilter<S>,
    mass: S,
    length: S,
}

/// What moves.
#[derive(Clone, Copy, Debug)]
pub struct TautEstimatorState<S: Scalar> {
    accel: Biquad3State<S>,
    gyro: Biquad3State<S>,
    thrust: Option<BiquadState<S>>,
    last_thrust: Option<S>,
    observer: Option<HighGainState<S>>,
    out_of_plane: Option<OutOfPlaneState<S>>,
    estimate: Option<TautEstimate<S>>,
}

impl<S: Scalar> Default for TautEstimatorState<S> {
    fn default() -> Self {
        Self {
            accel: Biquad3State::default(),
            gyro: Biquad3State::default(),
            thrust: None,
            last_thrust: None,
            observer: None,
            out_of_plane: None,
            estimate: None,
        }
    }
}

/// What one 250 Hz step reads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TautInput<S: Scalar> {
    /// Averaged over the step, bias removed.
    pub imu: Imu<S>,
    /// Acting, from the motor model behind the accelerometer's filter, N.
    pub thrust: S,
    /// Roll by the attitude filter, rad: used until the out-of-plane filter runs.
    pub roll: S,
    /// Which observer speed.
    pub purpose: TautPurpose,
}

/// What is known of vehicle and link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TautEstimate<S: Scalar> {
    /// In the plane.
    pub planar: PlanarState<S>,
    /// N, positive in tension.
    pub link_force: S,
    /// Residual of the observer, m/s².
    pub residual: S,
    /// Thrust in the plane and its rate, N and N/s.
    pub thrust: S,
    /// See [`Self::thrust`].
    pub thrust_rate: S,
    /// Specific force, 10 Hz, m/s².
    pub accel: Body<V3<S>>,
    /// Rate, 10 Hz, rad/s.
    pub rate: Body<V3<S>>,
    /// Across the plane; `None` until [`TautEstimator::start_out_of_plane`].
    pub out_of_plane: Option<OutOfPlaneState<S>>,
}

impl<S: Scalar> TautEstimator<S> {
    /// From the parameters.
    ///
    /// # Errors
    /// [`Invalid`] naming the setting; the parameters' ranges exclude it.
    pub fn try_new(p: &Params) -> Result<Self, Invalid> {
        let kind = TetherKind::from_parameter(p.tether_kind);
        let model = PlanarModel::try_new(
            S::from_f32(p.mass),
            S::from_f32(p.inertia_y),
            S::from_f32(p.tether_length),
            S::lit(GRAVITY),
        )?;
        let observer = |epsilon: f32| {
            HighGain::try_new(HighGainSettings {
                epsilon: f64::from(if kind.is_rigid() { p.taut_epsilon_bar } else { epsilon }),
                branches: Branches::One,
                sign_is_continuous: kind.is_rigid(),
                force_min: if kind.is_rigid() { RIGID_FORCE_MIN } else { CABLE_FORCE_MIN },
                ..HighGainSettings::new(model, OUTER_DT)
            })
        };
        Ok(Self {
            force: observer(p.taut_epsilon_force)?,
            attitude: observer(p.taut_epsilon_attitude)?,
            filter: Biquad::low_pass(CUTOFF_HZ, (1.0 / OUTER_DT) as f32),
            out_of_plane: OutOfPlaneFilter::new(p),
            mass: model.mass(),
            length: model.length(),
        })
    }

    /// Link force, N, below which the observer is blind, with a margin.
    #[must_use]
    pub fn force_floor(&self) -> S {
        S::lit(1.2 * self.force.settings().force_min) * self.mass
    }

    /// The plane's model.
    #[must_use]
    pub fn model(&self) -> &PlanarModel<S> {
        &self.force.settings().model
    }

    /// One step in the air. A reading that is refused keeps the last estimate.
    pub fn step(&self, state: &mut TautEstimatorState<S>, input: &TautInput<S>) {
        let accel = state.accel.step(&self.filter, input.imu.accel.0);
        let gyro = state.gyro.step(&self.filter, input.imu.gyro.0);
        let thrust = {
            let filter = state.thrust.get_or_insert_with(|| self.filter.settled(input.thrust));
            self.filter.step(filter, input.thrust)
        };
        let roll =
            state.out_of_plane.as_ref().map_or(input.roll, |out_of_plane| out_of_plane.roll());
        let (sin, cos) = roll.sin_cos();
        let planar = PlanarImu { x: -accel.x, z: accel.z * cos + accel.y * sin, rate: -gyro.y };
        let in_plane = thrust * cos;
        let thrust_rate = (in_plane - state.last_thrust.unwrap_or(in_plane)) / S::lit(OUTER_DT);
        state.last_thrust = Some(in_plane);
        let observer = match input.purpose {
            TautPurpose::Force => &self.force,
            TautPurpose::Attitude => &self.attitude,
        };
        let input_now = HighGainInput {
            imu: planar,
            thrust_measured: in_plane,
            thrust_now: in_plane,
            thrust_rate,
        };
        let now = state.observer.get_or_insert_with(|| observer.quasi_static(&planar, in_plane));
        if observer.step(now, &input_now).is_err() {
            return;
        }
        let seen = now.estimate();
        if let Some(out_of_plane) = &mut state.out_of_plane {
            let input_now = OutOfPlaneInput {
                gyro: Body(gyro),
                across: accel.y,
                thrust: thrust / self.mass,
                force: seen.specific_link_force,
                planar: seen.state,
                length: self.length,
            };
            self.out_of_plane.step(out_of_plane, &input_now);
        }
        state.estimate = Some(TautEstimate {
            planar: seen.state,
            link_force: seen.specific_link_force * self.mass,
            residual: seen.error,
            thrust: in_plane,
            thrust_rate,
            accel: Body(accel),
            rate: Body(gyro),
            out_of_plane: state.out_of_plane,
        });
    }

    /// Starts the out-of-plane filter from the azimuth of the vehicle minus its heading, rad, and roll, rad.
    pub fn start_out_of_plane(&self, state: &mut TautEstimatorState<S>, azimuth: S, roll: S) {
        state.out_of_plane = Some(self.out_of_plane.start(azimuth, roll));
        if let Some(estimate) = &mut state.estimate {
            estimate.out_of_plane = state.out_of_plane;
        }
    }
}

impl<S: Scalar> TautEstimatorState<S> {
    /// The latest; `None` on the ground.
    #[must_use]
    pub fn estimate(&self) -> Option<&TautEstimate<S>> {
        self.estimate.as_ref()
    }

    /// The out-of-plane filter is not wanted any more.
    pub fn stop_out_of_plane(&mut self) {
        self.out_of_plane = None;
    }
}
