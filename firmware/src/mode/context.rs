//! What a mode may read of the vehicle.

use super::Handover;
use super::pendulum::RodWatch;
use super::setpoints::Setpoints;
use crate::config::Config;
use crate::control::{AttitudeCommand, DitherState, RadialControl};
use crate::estimate::taut::TautEstimatorState;
use crate::feature;
use crate::frames::{Body, V3, World};
use crate::math::{so3, wrap_pi};
use crate::navigation::NavigationState;
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::{
    Estimate, Imu, MixerReport, PositionSource, Sensors, Setpoint, SphericalPoint, Sticks,
};
use crate::supervisor::GroundState;
use crate::time::{Micros, OUTER_DT, Sample};

/// Slew of the tension set-point, N/s.
const TENSION_RISE: f64 = 3.0;
const TENSION_FALL: f64 = 2.0;
/// Largest movement of the tension, as a share of it, and the share of the thrust that it may use.
const DITHER_SHARE: f64 = 0.5;
const DITHER_RESERVE: f64 = 0.9;
/// Height over the ground below which the tension does not move, m, and over which it grows to its full amplitude.
const DITHER_GROUND: f64 = 0.3;
const DITHER_FADE: f64 = 0.5;

/// What the vehicle keeps up to date for the modes.
#[derive(Clone, Debug)]
pub(crate) struct Situation<S: Scalar> {
    pub navigation: NavigationState<S>,
    pub estimate: Estimate<S>,
    pub smoothed: Option<Smoothed<S>>,
    pub taut: TautEstimatorState<S>,
    pub dither: DitherState<S>,
    /// While a rod on top is seen.
    pub rod: Option<RodWatch<S>>,
    pub sticks: Option<Sample<Sticks>>,
    /// The last of a program's stream.
    pub setpoint: Option<Sample<Setpoint>>,
    pub armed_at: Option<Micros>,
    pub mixer: MixerReport,
    /// The position is believed.
    pub has_place: bool,
    /// Of the last step.
    pub setpoints: Setpoints<S>,
}

impl<S: Scalar> Situation<S> {
    /// Inertial readings of the last outer step, bias removed.
    pub fn inertial_mean(&self) -> Imu<S> {
        let average = self.navigation.average();
        let gyro = Body(average.gyro.0 - self.estimate.gyro_bias.0);
        Imu { gyro, accel: average.accel }
    }
}

/// Estimate behind the position loop's low-pass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Smoothed<S: Scalar> {
    pub position: World<V3<S>>,
    pub velocity: World<V3<S>>,
    pub tension: S,
}

/// Read access to the vehicle, for one call.
pub(crate) struct Context<'a, S: Scalar> {
    pub now: Micros,
    pub params: &'a Params,
    pub config: &'a Config<S>,
    pub sensors: &'a Sensors<S>,
    pub situation: &'a Situation<S>,
}

/// What a mode wants of a tether of fixed length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FixedPull {
    /// The operator's tension.
    Full,
    /// Just taut, gently.
    Floor,
    /// Just taut, at once.
    FloorNow,
}

impl<S: Scalar> Context<'_, S> {
    pub fn ground(&self) -> GroundState {
        self.situation.setpoints.ground
    }

    /// Armed, and not standing.
    pub fn is_in_air(&self) -> bool {
        self.situation.armed_at.is_some() && self.ground() != GroundState::OnGround
    }

    /// Sticks that somebody holds.
    pub fn fresh_sticks(&self) -> Option<Sticks> {
        let timeout = self.params.stick_timeout_us();
        let fresh = |s: &Sample<Sticks>| self.now.since(s.at) < timeout;
        self.situation.sticks.filter(fresh).map(|s| s.value)
    }

    /// By the attitude loop: a thrust, N, world axes, and a heading.
    pub fn thrust(&self, force: V3<S>, heading: S) -> AttitudeCommand<S> {
        self.config.attitude.step(&World(force), &self.situation.estimate.attitude, heading)
    }

    /// Yaw rate that turns the nose to a heading, rad/s, as the attitude loop does.
    pub fn turn(&self, heading: S) -> S {
        let (.., yaw) = self.situation.estimate.attitude.euler();
        let attitude = &self.config.attitude;
        (wrap_pi(heading - yaw) * attitude.yaw_gain).limit_abs(attitude.yaw_rate_max)
    }

    /// Nothing new: on the ground, or for this step.
    pub fn unchanged(&self, tension: S) -> Setpoints<S> {
        Setpoints {
            tension,
            dither: S::zero(),
            wants_down: false,
            notice: None,
            ..self.situation.setpoints
        }
    }

    /// Set-points without a place.
    pub fn placeless(&self, attitude: AttitudeCommand<S>, tension: S) -> Setpoints<S> {
        Setpoints { attitude, reference: None, ..self.unchanged(tension) }
    }

    /// Tension for the modes that neither leave the ground nor come down to it, N.
    pub fn tension_in_flight(&self, handover: &Handover<S>) -> S {
        self.tension(handover, self.ground() == GroundState::InAir, self.fixed_pull())
    }

    /// Of a fixed length, the operator's tension once the flight has begun and until it comes down.
    pub(super) fn fixed_pull(&self) -> FixedPull {
        if self.ground() == GroundState::InAir { FixedPull::Full } else { FixedPull::FloorNow }
    }

    /// The next tension set-point on its way, N. The winch pulls gently unless `is_far_out`; a fixed length
    /// starts from its floor when slack.
    pub(super) fn tension(&self, handover: &Handover<S>, is_far_out: bool, fixed: FixedPull) -> S {
        let now = self.situation.setpoints.tension;
        let is_slack = || self.situation.estimate.tether.is_none_or(|t| !t.is_taut);
        let target = match self.config.constants.radial_control {
            RadialControl::Free => return S::zero(),
            RadialControl::FixedLength if fixed == FixedPull::FloorNow || is_slack() => {
                return self.config.constants.tension_floor;
            }
            RadialControl::FixedLength if fixed == FixedPull::Floor => {
                self.config.constants.tension_floor
            }
            RadialControl::Winch if !is_far_out => self.config.constants.tension_low,
            RadialControl::FixedLength | RadialControl::Winch => handover.tension,
        };
        let dt = S::lit(OUTER_DT);
        now + (target - now).limit(-S::lit(TENSION_FALL) * dt, S::lit(TENSION_RISE) * dt)
    }

    /// How far to move the tension off its set-point now, N. Not in slack, nor near the ground; less where the line
    /// would sag or the thrust end.
    pub(super) fn dither(&self, tension: S) -> S {
        let (constants, estimate) = (&self.config.constants, &self.situation.estimate);
        let Some(tether) = estimate.tether.filter(|tether| tether.is_taut) else {
            return S::zero();
        };
        let is_built = feature::FullState::<()>::IS_BUILT;
        if !is_built || estimate.source != PositionSource::FullState {
            return S::zero();
        }
        let floor = match constants.radial_control {
            RadialControl::Winch => S::zero(),
            RadialControl::FixedLength | RadialControl::Free => self.config.position.tension_min,
        };
        let place = SphericalPoint {
            elevation: tether.elevation,
            azimuth: tether.azimuth,
            length: tether.length,
        };
        let least = constants.line.least_tension(&place).max(floor);
        let reserve = S::lit(DITHER_RESERVE) * self.config.position.thrust_max;
        let most = constants.line.most_tension(&place, constants.weight, reserve);
        let amplitude = self
            .config
            .dither
            .amplitude
            .min(tension * S::lit(DITHER_SHARE))
            .min(tension - least)
            .min(most - tension)
            .max(S::zero());
        let height = estimate.height - self.config.touch_down.ground_height;
        let share = (height - S::lit(DITHER_GROUND)) * S::lit(1.0 / DITHER_FADE);
        let wave = self.config.dither.wave(&self.situation.dither);
        wave * amplitude * share.limit(S::zero(), S::one())
    }
}

/// A thrust of `up` N that pushes to the level part of `side` too, N, leaning by no more than this tangent.
pub(super) fn leaning<S: Scalar>(up: S, side: &V3<S>, most: S) -> V3<S> {
    let level = V3::new(side.x, side.y, S::zero());
    let limit = up * most;
    let share = (limit / so3::norm(&level).max(limit)).min(S::one());
    level * share - V3::new(S::zero(), S::zero(), up)
}
