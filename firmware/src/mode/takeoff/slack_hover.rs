//! The first seconds of a take-off on a slack link: straight up, level, by altimeter; there the thrust
//! is calibrated (`flight` section 5); then out along the nose, by integrated acceleration, until the
//! link pulls.
//!
//! The position filter starts afterwards: without tension it has nothing to hold on to.

use super::Takeoff;
use crate::estimate::{Calibrated, ThrustCalibration, ThrustCalibrationState};
use crate::frames::{Body, V3};
use crate::mode::{Context, Exit, Handover, Notice, Setpoints};
use crate::param::Params;
use crate::scalar::Scalar;
use crate::time::OUTER_DT;

/// Height of the hover over the anchor, m, unless the link is too short for it.
const HEIGHT: f64 = 1.5;
/// The hover is reached this close, m, and this slow, m/s.
const CLOSE: f64 = 0.15;
const SLOW: f64 = 0.15;
/// Height error to climb rate, 1/s, and the largest climb rate, m/s.
const CLIMB_GAIN: f64 = 1.0;
const CLIMB_MAX: f64 = 0.6;
/// The hover is within this share of the link's length.
const SLACK_SHARE: f32 = 0.93;
/// Off the ground, m.
const LIFTED: f64 = 0.12;
/// From then on it may take this long, s.
const PATIENCE: f64 = 25.0;
/// Speed on the way out, m/s, and its growth, m/s²: the integrated speed drifts, and may point inwards; speed error to acceleration, 1/s; largest acceleration, m/s².
const OUT_SPEED: f64 = 0.5;
const OUT_GROWTH: f64 = 0.06;
const SPEED_GAIN: f64 = 2.0;
const ACCEL_MAX: f64 = 1.8;
/// The link is taut when it has pulled this hard, N, for so long, s; low-pass of the pull, per step. In
/// the hover half of it spoils the calibration.
const PULL: f64 = 1.0;
const PULL_TIME: f64 = 0.3;
const PULL_SHARE: f64 = 0.04;
/// From here on the vehicle starts slack, m.
const SLACK_START: f32 = 0.5;

/// Configuration.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SlackHoverPlan<S> {
    calibration: ThrustCalibration<S>,
    height: S,
}

/// What moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct SlackHover<S> {
    calibration: ThrustCalibrationState<S>,
    height: S,
    stage: Stage,
    time: S,
    /// Horizontal, along the nose and to its right, integrated since lift-off, m/s.
    velocity: [S; 2],
    /// Time on the way out, s.
    outwards: S,
    /// Of the link, towards the anchor, N, and how long it has pulled, s.
    pull: S,
    pulled: S,
}

/// In this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    Ground,
    Hover,
    Out,
}

impl<S: Scalar> SlackHoverPlan<S> {
    /// `None` where the vehicle starts taut or the calibration is off.
    pub fn new(p: &Params, is_fixed_cable: bool) -> Option<Self> {
        let wanted = is_fixed_cable && p.start_slack >= SLACK_START;
        if !wanted || p.thrust_calibration_time <= 0.0 {
            return None;
        }
        let (length, ground) = (p.tether_length, p.ground_height);
        let side = libm::sqrtf((length * length - ground * ground).max(0.01)) - p.start_slack;
        let reach = SLACK_SHARE * length;
        let room = libm::sqrtf((reach * reach - side * side).max(0.0));
        Some(Self {
            calibration: ThrustCalibration {
                mass: S::from_f32(p.mass),
                samples: (p.thrust_calibration_time / OUTER_DT as f32) as u16,
            },
            height: S::lit(HEIGHT).min(S::from_f32(room)),
        })
    }
}

impl<S: Scalar> SlackHover<S> {
    pub fn start(plan: &SlackHoverPlan<S>) -> Self {
        Self {
            calibration: ThrustCalibrationState::default(),
            height: plan.height,
            stage: Stage::Ground,
            time: S::zero(),
            velocity: [S::zero(); 2],
            outwards: S::zero(),
            pull: S::zero(),
            pulled: S::zero(),
        }
    }
}

impl<S: Scalar> Takeoff<S> {
    /// Flies hover and way out while they last. On the ground, and afterwards, the caller's thrust ramp goes on.
    pub(super) fn hover_slack(
        &mut self,
        handover: &mut Handover<S>,
        tension: S,
        cx: &Context<'_, S>,
    ) -> Result<Option<Setpoints<S>>, Exit> {
        let (Some(plan), Some(hover)) = (&cx.config.modes.slack_hover, &mut self.slack) else {
            self.slack = None;
            return Ok(None);
        };
        let estimate = &cx.situation.estimate;
        if hover.stage == Stage::Ground {
            let ground = cx.config.touch_down.ground_height;
            if estimate.height < ground + S::lit(LIFTED) {
                return Ok(None);
            }
            hover.stage = Stage::Hover;
            let lift = estimate.thrust * estimate.attitude.cos_tilt();
            handover.climb = cx.config.climb.holding(lift);
        }
        let dt = S::lit(OUTER_DT);
        hover.time += dt;
        let accel = cx.situation.navigation.average().accel;
        let force = estimate.attitude.to_world(accel).0;
        let (sin, cos) = handover.heading.sin_cos();
        let [along, across] = &mut hover.velocity;
        *along += (force.x * cos + force.y * sin) * dt;
        *across += (force.y * cos - force.x * sin) * dt;
        let speed = if hover.stage == Stage::Out {
            hover.outwards += dt;
            S::lit(OUT_SPEED) + S::lit(OUT_GROWTH) * hover.outwards
        } else {
            S::zero()
        };
        let push = |error: S| (error * S::lit(SPEED_GAIN)).limit_abs(S::lit(ACCEL_MAX));
        let (ahead, right) = (push(speed - *along), push(-*across));

        let error = hover.height - estimate.height;
        let wanted = (error * S::lit(CLIMB_GAIN)).limit_abs(S::lit(CLIMB_MAX));
        let up = cx.config.climb.step(&mut handover.climb, wanted, estimate.climb, dt);
        let mass = cx.config.constants.mass;
        let asked =
            V3::new((ahead * cos - right * sin) * mass, (ahead * sin + right * cos) * mass, -up);
        let attitude = cx.thrust(asked, handover.heading);

        // What neither thrust nor weight explains, along the nose.
        let thrust =
            estimate.attitude.to_world(Body(V3::new(S::zero(), S::zero(), -estimate.thrust)));
        let pull = force * mass - thrust.0;
        let inward = -(pull.x * cos + pull.y * sin);
        hover.pull += (inward - hover.pull) * S::lit(PULL_SHARE);
        hover.pulled = if hover.pull > S::lit(PULL) { hover.pulled + dt } else { S::zero() };

        let is_there = error.abs() < S::lit(CLOSE)
            && estimate.climb.abs() < S::lit(SLOW)
            && hover.pull.abs() < S::lit(0.5 * PULL);
        let mut notice = None;
        if hover.stage == Stage::Hover && is_there {
            let lift = -accel.0.z;
            notice = plan.calibration.step(&mut hover.calibration, lift, estimate.thrust).map(
                |result| match result {
                    Calibrated::Ratio(ratio) => Notice::ThrustRatio(ratio),
                    Calibrated::Implausible => {
                        Notice::Warning("Thrust not calibrated: implausible")
                    }
                },
            );
        }
        if notice.is_some() {
            hover.stage = Stage::Out;
        }
        if hover.time > S::lit(PATIENCE) {
            return Err(Exit::slack("Take-off failed: link does not get taut"));
        }
        if hover.pulled > S::lit(PULL_TIME) {
            if hover.stage == Stage::Hover {
                notice = Some(Notice::Warning("Thrust not calibrated: link is taut"));
            }
            self.slack = None;
        }
        Ok(Some(Setpoints { attitude, notice, ..cx.unchanged(tension) }))
    }
}
