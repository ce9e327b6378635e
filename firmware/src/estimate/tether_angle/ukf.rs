//! Unscented Kalman filter of tether angle, rate and tilt in one vertical plane. `inertial` section 4.

use super::minimal::{Located, TENSION_FLOOR, locate};
use crate::fault::{Invalid, positive};
use crate::frames::{M3, V3};
use crate::model::{TetherAngle, TetherAngleModel, TiltImu};
use crate::scalar::Scalar;
use crate::single::Single;
use nalgebra::{Matrix2, Vector2};

/// Standard deviations after initialisation: 10° and 0.3 rad/s.
const START_ANGLE: f64 = 0.174_532_925_199_432_95;
const START_RATE: f64 = 0.3;
/// Largest |1/cos| in the process noise.
const COS_FLOOR: f64 = 0.2;
/// Keeps the root of a covariance of full rank, rad².
const JITTER: f64 = 1e-15;
/// Points of a three-state filter without a central one.
const POINTS: usize = 6;

/// Deviations are kept so many times as large: in fixed point their squares had no bits otherwise.
fn fine<S: Scalar>() -> S {
    S::lit(if S::IS_FLOATING { 1.0 } else { 64.0 })
}

/// Noise, period and limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TetherAngleUkf<S> {
    /// Period, s.
    pub dt: S,
    /// Process noise: angular acceleration, rad/s².
    pub sigma: S,
    /// Covariance of the specific force, (m/s²)²: x, x with z, z.
    pub accel_noise: [S; 3],
    /// Tension over mass below which the tether counts as slack, m/s².
    pub tension_floor: S,
    /// Time without tension after which the estimate is lost, s.
    pub slack_max: S,
}

impl<S: Scalar> TetherAngleUkf<S> {
    /// The published covariances at a period of `dt` s. The process noise is the published 0.4 rad/s²
    /// times 1/80 s: taken literally it makes the filter diverge (`inertial` section 4).
    ///
    /// # Errors
    /// A period that is not finite and positive.
    pub fn try_new(dt: S) -> Result<Self, Invalid> {
        Ok(Self {
            dt: positive("dt", dt)?,
            sigma: S::lit(0.005),
            accel_noise: [S::lit(0.31), S::lit(0.157), S::lit(1.105)],
            tension_floor: S::lit(TENSION_FLOOR),
            slack_max: S::one(),
        })
    }
}

/// What the filter did with a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UkfStage {
    /// No estimate: the reading gives no angle.
    #[default]
    Uninitialised,
    /// Started from the reading.
    Started,
    /// Predicted and corrected.
    Updated,
    /// No tension: predicted only.
    DeadReckoning,
    /// No tension for too long; starts anew when the tether pulls again.
    Lost,
}

/// Estimate and covariance, order angle, rate, tilt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Posterior<S: Scalar> {
    /// rad, rad/s, rad.
    pub x: TetherAngle<S>,
    /// Symmetric; in fixed point 64² times as large.
    pub covariance: M3<S>,
}

impl<S: Scalar> Single for Posterior<S> {
    type Single = Posterior<f32>;
    fn single(&self) -> Posterior<f32> {
        let fine = fine::<S>().to_f32();
        Posterior { x: self.x.single(), covariance: self.covariance.single() / (fine * fine) }
    }
}

/// A correction with what it was made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corrected<S: Scalar> {
    /// After it.
    pub posterior: Posterior<S>,
    /// Measured minus expected specific force, m/s².
    pub innovation: Vector2<S>,
    /// Its covariance.
    pub innovation_covariance: Matrix2<S>,
}

/// What moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TetherAngleState<S: Scalar> {
    /// The last estimate, also after it is lost.
    pub posterior: Posterior<S>,
    /// What was done with the last sample.
    pub mode: UkfStage,
    pub(crate) is_running: bool,
    pub(crate) slack: S,
    pub(crate) prior: S,
}

impl<S: Scalar> TetherAngleState<S> {
    /// Not started; `tilt` picks the side of the first estimate, rad.
    #[must_use]
    pub fn with_prior(tilt: S) -> Self {
        Self {
            posterior: Posterior {
                x: TetherAngle { tilt, ..TetherAngle::default() },
                covariance: M3::zeros(),
            },
            mode: UkfStage::Uninitialised,
            is_running: false,
            slack: S::zero(),
            prior: tilt,
        }
    }

    /// Started at a known state, as uncertain as after one reading.
    #[must_use]
    pub fn at(x: TetherAngle<S>) -> Self {
        Self::known(x, [START_ANGLE, START_RATE, START_ANGLE].map(S::lit))
    }

    /// Started at a known state with these standard deviations of angle, rate and tilt.
    #[must_use]
    pub fn known(x: TetherAngle<S>, deviations: [S; 3]) -> Self {
        let [angle, rate, tilt] = deviations.map(|d| d * fine::<S>()).map(|d| d * d);
        Self {
            posterior: Posterior { x, covariance: M3::from_diagonal(&V3::new(angle, rate, tilt)) },
            mode: UkfStage::Started,
            is_running: true,
            slack: S::zero(),
            prior: x.tilt,
        }
    }

    /// Whether the estimate may be flown on.
    #[must_use]
    pub fn is_running(&self) -> bool {
        self.is_running
    }
}

fn vector<S: Scalar>(x: &TetherAngle<S>) -> V3<S> {
    V3::new(x.angle, x.rate, x.tilt)
}

fn state<S: Scalar>(v: &V3<S>) -> TetherAngle<S> {
    TetherAngle { angle: v.x, rate: v.y, tilt: v.z }
}

/// Columns of the lower Cholesky factor; a pivot lost to rounding gives a column of zeros.
fn root<S: Scalar>(p: &M3<S>) -> [V3<S>; 3] {
    let o = S::zero();
    let inverse = |pivot: S| if pivot > o { S::one() / pivot } else { o };
    let jitter = S::lit(JITTER);
    let l11 = (p.m11 + jitter).sqrt();
    let k = inverse(l11);
    let (l21, l31) = (p.m21 * k, p.m31 * k);
    let l22 = (p.m22 + jitter - l21 * l21).sqrt();
    let l32 = (p.m32 - l31 * l21) * inverse(l22);
    let l33 = (p.m33 + jitter - l31 * l31 - l32 * l32).sqrt();
    [V3::new(l11, l21, l31), V3::new(o, l22, l32), V3::new(o, o, l33)]
}

/// x ± sqrt(3) times each column of the root of P.
fn points<S: Scalar>(posterior: &Posterior<S>) -> [V3<S>; POINTS] {
    let x = vector(&posterior.x);
    let coarse = S::lit(SQRT_3) / fine();
    let [a, b, c] = root(&posterior.covariance).map(|column| column * coarse);
    [x + a, x - a, x + b, x - b, x + c, x - c]
}

const SQRT_3: f64 = 1.732_050_807_568_877_2;

impl<S: Scalar> TetherAngleUkf<S> {
    /// How one step's noise enters the state (15), per rad/s².
    #[must_use]
    pub fn noise_gain(&self, model: &TetherAngleModel<S>, x: &TetherAngle<S>) -> V3<S> {
        let (_, cos) = (x.angle - x.tilt).sin_cos();
        let floor = S::lit(COS_FLOOR);
        let cos = if cos < S::zero() { cos.min(-floor) } else { cos.max(floor) };
        let dt = self.dt;
        V3::new(dt * dt * S::lit(0.5), dt, model.length / (model.thrust * cos))
    }

    /// One period ahead with the mean rate of the tilt over it, rad/s.
    #[must_use]
    pub fn predict(
        &self,
        model: &TetherAngleModel<S>,
        posterior: &Posterior<S>,
        tilt_rate: S,
    ) -> Posterior<S> {
        let share = S::lit(1.0 / POINTS as f64);
        let ahead =
            points(posterior).map(|p| vector(&model.advance(&state(&p), tilt_rate, self.dt)));
        let mean = ahead.iter().fold(V3::zeros(), |sum, p| sum + p) * share;
        let noise = self.noise_gain(model, &posterior.x) * (self.sigma * fine());
        let mut covariance = noise * noise.transpose();
        for p in &ahead {
            let d = (p - mean) * fine::<S>();
            covariance += (d * share) * d.transpose();
        }
        Posterior { x: state(&mean), covariance }
    }

    /// Correction by the specific force along body x and z, m/s².
    #[must_use]
    pub fn correct(
        &self,
        model: &TetherAngleModel<S>,
        posterior: &Posterior<S>,
        force: [S; 2],
    ) -> Corrected<S> {
        let share = S::lit(1.0 / POINTS as f64);
        let points = points(posterior);
        let expected = points.map(|p| {
            let x = state(&p);
            let [ax, az] = model.specific_force(&x, model.tension(&x, [S::zero(); 2]));
            Vector2::new(ax, az)
        });
        let mean = expected.iter().fold(Vector2::zeros(), |sum, z| sum + z) * share;
        let [rxx, rxz, rzz] = self.accel_noise;
        let mut s = Matrix2::new(rxx, rxz, rxz, rzz);
        let x = vector(&posterior.x);
        let (mut cross_x, mut cross_z) = (V3::zeros(), V3::zeros());
        for (p, z) in points.iter().zip(&expected) {
            let (dx, dz) = ((p - x) * (share * fine()), z - mean);
            s += (dz * share) * dz.transpose();
            cross_x += dx * dz.x;
            cross_z += dx * dz.y;
        }
        let determinant = s.m11 * s.m22 - s.m12 * s.m21;
        let k_x = (cross_x * s.m22 - cross_z * s.m21) / determinant;
        let k_z = (cross_z * s.m11 - cross_x * s.m12) / determinant;
        let [ax, az] = force;
        let innovation = Vector2::new(ax, az) - mean;
        let moved = x + (k_x * innovation.x + k_z * innovation.y) / fine::<S>();
        // K S Kᵀ = C Kᵀ; half of it and of its transpose, so that the result stays symmetric.
        let shrink = cross_x * k_x.transpose() + cross_z * k_z.transpose();
        let covariance = posterior.covariance - (shrink + shrink.transpose()) * S::lit(0.5);
        Corrected {
            posterior: Posterior { x: state(&moved), covariance },
            innovation,
            innovation_covariance: s,
        }
    }

    /// Takes one sample. A rate that is not finite counts as zero; a specific force that is not finite,
    /// or that shows no tension, corrects nothing.
    pub fn step(
        &self,
        model: &TetherAngleModel<S>,
        filter: &mut TetherAngleState<S>,
        imu: &TiltImu<S>,
    ) {
        let rate = if imu.rate.is_finite() { imu.rate } else { S::zero() };
        let is_finite = imu.x.is_finite() && imu.z.is_finite();
        self.advance(model, filter, is_finite.then_some([imu.x, imu.z]), rate);
    }

    /// One period without a specific force.
    pub fn dead_reckon(
        &self,
        model: &TetherAngleModel<S>,
        filter: &mut TetherAngleState<S>,
        tilt_rate: S,
    ) {
        self.advance(model, filter, None, tilt_rate);
    }

    fn advance(
        &self,
        model: &TetherAngleModel<S>,
        filter: &mut TetherAngleState<S>,
        force: Option<[S; 2]>,
        rate: S,
    ) {
        if !filter.is_running {
            filter.prior += rate * self.dt;
            let prior = filter.prior;
            let find = |force| locate(model, force, S::zero(), prior, self.tension_floor).ok();
            filter.mode = match force.and_then(find) {
                Some(Located { angle, tilt, .. }) => {
                    *filter = TetherAngleState::at(TetherAngle { angle, rate: S::zero(), tilt });
                    UkfStage::Started
                }
                None => UkfStage::Uninitialised,
            };
            return;
        }
        let mut next = self.predict(model, &filter.posterior, rate);
        let pull = |[x, z]: &[S; 2]| {
            let along = *z - model.thrust;
            (*x * *x + along * along).sqrt()
        };
        if let Some(force) = force.filter(|force| pull(force) > self.tension_floor) {
            next = self.correct(model, &next, force).posterior;
            filter.slack = S::zero();
            filter.mode = UkfStage::Updated;
        } else {
            filter.slack += self.dt;
            filter.mode = UkfStage::DeadReckoning;
        }
        let is_sane = vector(&next.x).iter().chain(next.covariance.iter()).all(|v| v.is_finite());
        if is_sane {
            filter.posterior = next;
        }
        if !is_sane || filter.slack > self.slack_max {
            filter.mode = UkfStage::Lost;
            filter.is_running = false;
            filter.prior = filter.posterior.x.tilt;
        }
    }
}
