//! The law with its limits and guards: thrust and body rates from estimate and reference. `pendulum`
//! sections 6 and 11.

use super::PendulumGains;
use super::body_rate::body_rate;
use super::force_rate::ForceRate;
use super::guidance::Guidance;
use crate::estimate::pendulum::PendulumEstimate;
use crate::fault::{Fault, Invalid, all_finite, not_negative, positive};
use crate::frames::{Attitude, Body, V3};
use crate::math::so3;
use crate::model::PendulumModel;
use crate::scalar::Scalar;
use crate::signal::LoadReference;

/// A wanted force below this share of the weight has no direction worth turning to.
const FORCE_FLOOR: f64 = 0.05;

/// What vehicle and safety allow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PendulumLimits<S> {
    /// N.
    pub thrust_min: S,
    /// N.
    pub thrust_max: S,
    /// Of roll and pitch rate together, rad/s.
    pub rate_max: S,
    /// E3: least downward pull that the position error may leave, as a share of gravity; `None`: the
    /// article's law. Without it the law turns over when the load is far above its reference.
    pub pull_share: Option<S>,
}

impl<S: Scalar> PendulumLimits<S> {
    /// The defaults: no thrust to twice the weight, 10 rad/s, E3 at 0.3.
    #[must_use]
    pub fn standard(model: &PendulumModel<S>) -> Self {
        Self {
            thrust_min: S::zero(),
            thrust_max: model.weight() * S::lit(2.0),
            rate_max: S::lit(10.0),
            pull_share: Some(S::lit(0.3)),
        }
    }

    /// None but a thrust that cannot pull.
    #[must_use]
    pub fn wide() -> Self {
        Self {
            thrust_min: S::zero(),
            thrust_max: S::lit(1000.0),
            rate_max: S::lit(1000.0),
            pull_share: None,
        }
    }
}

/// The controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PendulumControl<S: Scalar> {
    gains: PendulumGains<S>,
    model: PendulumModel<S>,
    limits: PendulumLimits<S>,
}

/// Where the vehicle's down axis was last wanted: held where the wanted force vanishes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PendulumMemory<S: Scalar> {
    down: V3<S>,
}

impl<S: Scalar> Default for PendulumMemory<S> {
    fn default() -> Self {
        Self { down: V3::new(S::zero(), S::zero(), S::one()) }
    }
}

/// What is asked of the vehicle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PendulumCommand<S: Scalar = f32> {
    /// N.
    pub thrust: S,
    /// rad/s; yaw rate zero.
    pub rate: Body<V3<S>>,
    /// Wanted direction of the body's down axis, world axes.
    pub down: V3<S>,
    /// Force wanted, N, world axes.
    pub force: V3<S>,
}

impl<S: Scalar> PendulumControl<S> {
    /// From gains, model and limits.
    ///
    /// # Errors
    /// [`Invalid`] naming the setting.
    pub fn try_new(
        gains: PendulumGains<S>,
        model: PendulumModel<S>,
        limits: PendulumLimits<S>,
    ) -> Result<Self, Invalid> {
        not_negative("thrust_min", limits.thrust_min)?;
        positive("thrust_max", limits.thrust_max)?;
        positive("rate_max", limits.rate_max)?;
        Ok(Self { gains: gains.validate()?, model, limits })
    }

    /// One step.
    ///
    /// # Errors
    /// [`Fault::NotFinite`] for an input or result that is not; `memory` is untouched and the caller holds
    /// its last command for one step, then aborts.
    pub fn step(
        &self,
        memory: &mut PendulumMemory<S>,
        x: &PendulumEstimate<S>,
        attitude: &Attitude<S>,
        reference: &LoadReference<S>,
    ) -> Result<PendulumCommand<S>, Fault> {
        let vectors = [&x.position, &x.velocity, &x.rod, &x.rod_rate, &x.disturbance];
        for v in vectors.map(|v| &v.0).into_iter().chain(&reference.0) {
            all_finite(&[v.x, v.y, v.z])?;
        }
        let x = &self.above(x, reference);
        let (gains, model) = (&self.gains, &self.model);
        let at = Guidance::at(gains, model, x, reference);
        let actual = so3::col_z(&attitude.0);
        let (least, most) = (self.limits.thrust_min, self.limits.thrust_max);
        let thrust = (-so3::dot(&at.force, &actual)).limit(least, most);
        let wanted = so3::norm(&at.force);
        let is_lost = wanted < model.weight() * S::lit(FORCE_FLOOR);
        let down = if is_lost { memory.down } else { at.force * (-S::one() / wanted) };
        let down_rate = if is_lost {
            V3::zeros()
        } else {
            let applied = actual * -thrust;
            ForceRate::at(gains, model, x, reference, &at, &applied).down_wanted(&down, wanted)
        };
        let turning = (&down, &down_rate, wanted);
        let rate = body_rate(gains, model, (x, attitude), &at, turning);
        let rate = Body(so3::limit_norm(rate.0, self.limits.rate_max));
        all_finite(&[thrust, rate.0.x, rate.0.y])?;
        memory.down = down;
        Ok(PendulumCommand { thrust, rate, down, force: at.force })
    }

    /// E3: the estimate with the load no farther above its reference than the law bears.
    fn above(&self, x: &PendulumEstimate<S>, reference: &LoadReference<S>) -> PendulumEstimate<S> {
        let mut shifted = *x;
        let Some(share) = self.limits.pull_share else { return shifted };
        let [d0, d1, d2, ..] = &reference.0;
        let (kp, kv) = (self.gains.position.z, self.gains.velocity.z);
        let demand = kp * (x.position.0.z - d0.z) + kv * (x.velocity.0.z - d1.z) - d2.z;
        let least = (share - S::one()) * self.model.gravity;
        if demand < least {
            shifted.position.0.z += (least - demand) / kp;
        }
        shifted
    }
}
