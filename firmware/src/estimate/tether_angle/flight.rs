//! The filters of both planes on a vehicle: from NED and FRD into the planes' axes and back, at their own
//! rate. `inertial` section 8, `flight` section 6.

use super::spatial::{PlaneReading, TetherAngles, TetherAnglesState};
use super::ukf::{TetherAngleState, TetherAngleUkf, UkfStage};
use crate::fault::Invalid;
use crate::frames::{Attitude, Body, V3, World};
use crate::math::filter::first_order;
use crate::math::{GRAVITY, so3};
use crate::model::{TetherAngle, TetherAngleModel};
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::Imu;
use crate::time::OUTER_DT;

/// Outer steps per filter step: 12 ms, the article has 12.5.
const DECIMATION: u8 = 3;

/// How well position and attitude filter know the angle, its rate and the tilt at the start: 3°, 0.1 rad/s
/// and 1.5°. With the 10° of a single reading the angle near zero, hardly observable, runs away.
const START: [f64; 3] = [0.052, 0.1, 0.026];

/// Configuration.
#[derive(Clone, Copy, Debug)]
pub struct TetherAngleEstimator<S: Scalar> {
    angles: TetherAngles<S>,
    mass: S,
    /// Low-pass of specific force and thrust, per outer step.
    share: S,
}

/// What moves.
#[derive(Clone, Copy, Debug)]
pub struct TetherAngleEstimatorState<S: Scalar> {
    filters: TetherAnglesState<S>,
    force: V3<S>,
    /// N.
    thrust: S,
    gyro: V3<S>,
    ticks: u8,
    /// A reading of this period was not finite.
    is_spoilt: bool,
    /// The second plane's turn comes an outer step later: both at once would be too much for one.
    waiting: Option<PlaneReading<S>>,
}

/// What is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TetherAngleEstimate<S: Scalar> {
    /// In the plane of North and up, and of West and up.
    pub planes: [TetherAngleState<S>; 2],
    /// Thrust and length as each plane sees them.
    pub models: [TetherAngleModel<S>; 2],
    /// Of the tether at rest under this thrust, N.
    pub tension: S,
    /// What the accelerometer shows beside the thrust: tether, drag, noise, N.
    pub pull: S,
}

/// NED to North-West-up, FRD to forward-left-up, and back.
fn flip<S: Scalar>(v: &V3<S>) -> V3<S> {
    V3::new(v.x, -v.y, -v.z)
}

/// Angles of a direction, NED, in both planes, rad from straight up.
#[must_use]
pub fn plane_angles<S: Scalar>(direction: &World<V3<S>>) -> [S; 2] {
    let v = flip(&direction.0);
    [v.x.atan2(v.z), v.y.atan2(v.z)]
}

/// Heading as the planes count it: the left axis lies across it.
fn heading<S: Scalar>(attitude: &Attitude<S>) -> S {
    let right = so3::col_y(&attitude.0);
    right.x.atan2(right.y)
}

impl<S: Scalar> TetherAngleEstimator<S> {
    /// From the parameters.
    ///
    /// # Errors
    /// [`Invalid`] naming the setting; the parameters' ranges exclude it.
    pub fn try_new(p: &Params) -> Result<Self, Invalid> {
        let dt = OUTER_DT * f64::from(DECIMATION);
        let ukf = TetherAngleUkf::try_new(S::lit(dt))?;
        let model =
            TetherAngleModel::try_new(S::from_f32(p.angle_thrust), S::from_f32(p.tether_length))?;
        Ok(Self {
            angles: TetherAngles {
                ukf: TetherAngleUkf { sigma: S::from_f32(p.angle_sigma), ..ukf },
                model,
                projects: true,
            },
            mass: S::from_f32(p.mass),
            share: first_order(p.angle_accel_tau, OUTER_DT as f32),
        })
    }

    /// From where the vehicle is believed to be, at rest. `position` from the anchor, m; `imu` and
    /// `thrust`, N, as of now.
    #[must_use]
    pub fn start(
        &self,
        position: &World<V3<S>>,
        attitude: &Attitude<S>,
        imu: &Imu<S>,
        thrust: S,
    ) -> TetherAngleEstimatorState<S> {
        let angles = plane_angles(position);
        let tilts = plane_angles(&World(-so3::col_z(&attitude.0)));
        let plane = |angle, tilt| {
            let x = TetherAngle { angle, rate: S::zero(), tilt };
            TetherAngleState::known(x, START.map(S::lit))
        };
        let ([ax, ay], [tx, ty]) = (angles, tilts);
        TetherAngleEstimatorState {
            filters: TetherAnglesState { planes: [plane(ax, tx), plane(ay, ty)] },
            force: flip(&imu.accel.0),
            thrust,
            gyro: V3::zeros(),
            ticks: 0,
            is_spoilt: false,
            waiting: None,
        }
    }

    /// One outer step. `imu` averaged over it, bias removed; `thrust` acting, N; `attitude` for its heading.
    /// A reading that is not finite is dead-reckoned. Whether a plane's filter had its turn, which is dear.
    pub fn step(
        &self,
        state: &mut TetherAngleEstimatorState<S>,
        imu: &Imu<S>,
        thrust: S,
        attitude: &Attitude<S>,
    ) -> bool {
        let is_finite = |v: &V3<S>| v.iter().all(|x| x.is_finite());
        if is_finite(&imu.accel.0) && is_finite(&imu.gyro.0) && thrust.is_finite() {
            state.force += (flip(&imu.accel.0) - state.force) * self.share;
            state.thrust += (thrust - state.thrust) * self.share;
            state.gyro += flip(&imu.gyro.0);
        } else {
            state.is_spoilt = true;
        }
        let waiting = state.waiting.take();
        if let Some(second) = &waiting {
            let [_, plane] = &mut state.filters.planes;
            self.angles.take(plane, second);
        }
        state.ticks += 1;
        if state.ticks < DECIMATION {
            return waiting.is_some();
        }
        let mean = S::lit(1.0 / f64::from(DECIMATION));
        let rate = state.gyro * mean;
        let force = state.force;
        let force = (!state.is_spoilt).then_some(&force);
        let angles = self.now(state);
        let [first, second] = angles.readings(&state.filters, force, &rate, heading(attitude));
        let [plane, _] = &mut state.filters.planes;
        angles.take(plane, &first);
        state.waiting = Some(second);
        state.is_spoilt = false;
        state.gyro = V3::zeros();
        state.ticks = 0;
        true
    }

    /// With the thrust that acts, not the one that is asked: it is ramped, and the mixer may cut it.
    fn now(&self, state: &TetherAngleEstimatorState<S>) -> TetherAngles<S> {
        let thrust = (state.thrust / self.mass).max(S::one());
        let model = TetherAngleModel { thrust, ..self.angles.model };
        TetherAngles { model, ..self.angles }
    }

    /// What is known now.
    #[must_use]
    pub fn estimate(
        &self,
        state: &TetherAngleEstimatorState<S>,
        attitude: &Attitude<S>,
    ) -> TetherAngleEstimate<S> {
        let angles = self.now(state);
        let frame = state.filters.frame(heading(attitude));
        let direction = state.filters.direction();
        let weight = S::lit(GRAVITY);
        let along = angles.model.thrust * so3::dot(&frame.thrust_axis(), &direction);
        TetherAngleEstimate {
            planes: state.filters.planes,
            models: angles.planar_models(&state.filters, &frame),
            tension: (along - weight * direction.z) * self.mass,
            pull: {
                let lift = V3::new(S::zero(), S::zero(), angles.model.thrust);
                so3::norm(&(state.force - lift)) * self.mass
            },
        }
    }

    /// Body rate, FRD, that turns the tilts of both planes at these rates, rad/s, without yaw.
    #[must_use]
    pub fn body_rate(
        &self,
        state: &TetherAngleEstimatorState<S>,
        attitude: &Attitude<S>,
        tilt_rates: [S; 2],
    ) -> Body<V3<S>> {
        let frame = state.filters.frame(heading(attitude));
        Body(flip(&frame.body_rate(tilt_rates)))
    }
}

impl<S: Scalar> TetherAngleEstimate<S> {
    /// Both planes have an estimate.
    #[must_use]
    pub fn is_running(&self) -> bool {
        self.planes.iter().all(TetherAngleState::is_running)
    }

    /// Angles of the tether in both planes, rad.
    #[must_use]
    pub fn angles(&self) -> [S; 2] {
        let [x, y] = &self.planes;
        [x.posterior.x.angle, y.posterior.x.angle]
    }

    /// What each plane did with its last sample.
    #[must_use]
    pub fn modes(&self) -> [UkfStage; 2] {
        let [x, y] = &self.planes;
        [x.mode, y.mode]
    }
}
