//! Taut Force and Taut Attitude: elevation with link force or pitch on a taut link, by inertia.

mod config;
mod moves;

pub(crate) use config::TautConfig;

use super::refusal::NEEDS_FIXED_LENGTH;
use super::setpoints::SLACK;
use super::{Context, Entry, Exit, FlightMode, Handover, ModeReport, Refusal, Setpoints, rejected};
use crate::control::taut::TautControllerState;
use crate::estimate::taut::TautEstimate;
use crate::math::wrap_pi;
use crate::scalar::Scalar;
use crate::signal::{Action, PlanarReference, TautPurpose};
use crate::supervisor::Mode;
use crate::time::OUTER_DT;
use crate::trajectory::TautPlan;

/// The nose may be this far from the plane of the link at entry, rad.
const NOSE_MAX: f64 = 0.35;
/// Largest correction by the altimeter, rad.
const CORRECTION_MAX: f64 = 0.4;
/// A cable that pulls less than this share of what is wanted is slack or broken; for so long, s, it may:
/// shorter where the vehicle would speed up after the missing force.
pub(super) const SLACK_SHARE: f64 = 0.3;
pub(super) const SLACK_TIME_FORCE: f64 = 0.5;
const SLACK_TIME_ATTITUDE: f64 = 0.8;
/// In Taut Attitude no force is wanted: what the link has pulled lately stands in for it, s.
const PULL_TIME: f64 = 2.0;
/// No vehicle on its link is higher than the link is long, but for the altimeter's error: share and m.
const REACH_SHARE: f64 = 1.15;
const REACH_MARGIN: f64 = 0.3;

/// The second output as the observer sees it.
fn second<S: Scalar>(purpose: TautPurpose, now: &TautEstimate<S>) -> S {
    match purpose {
        TautPurpose::Force => now.link_force,
        TautPurpose::Attitude => now.planar.pitch,
    }
}

/// Where the out-of-plane filter of the observer starts: azimuth of the vehicle minus its heading, and roll, rad.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OutOfPlane<S> {
    pub azimuth: S,
    pub roll: S,
}

/// A move that was asked for, and how many of its points are good.
#[derive(Clone, Copy, Debug)]
struct Candidate<S> {
    plan: TautPlan<S>,
    checked: u8,
}

/// What moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct TautLink<S: Scalar> {
    purpose: TautPurpose,
    controller: TautControllerState<S>,
    plan: TautPlan<S>,
    candidate: Option<Candidate<S>>,
    /// Elevation that the observer sees too much of, by the altimeter, rad.
    correction: S,
    /// What the link pulls when all is well, low-passed, N.
    pull: S,
    /// How long the link has pulled less than it should, s.
    slack: S,
    start: OutOfPlane<S>,
}

/// Elevation by altimeter and length, rad.
fn elevation_by_altimeter<S: Scalar>(cx: &Context<'_, S>) -> Option<S> {
    // The link ends below the centre of mass.
    let estimate = &cx.situation.estimate;
    let end = S::from_f32(cx.params.attachment) * estimate.attitude.cos_tilt();
    let sin = (estimate.height - end) / cx.config.constants.tether_length;
    (cx.sensors.altitude_is_fresh && sin.abs() < S::one()).then(|| sin.asin())
}

/// The altimeter allows that the link holds the vehicle.
fn is_within_reach<S: Scalar>(cx: &Context<'_, S>) -> bool {
    let reach = cx.config.constants.tether_length * S::lit(REACH_SHARE) + S::lit(REACH_MARGIN);
    !cx.sensors.altitude_is_fresh || cx.situation.estimate.height < reach
}

impl<S: Scalar> FlightMode<S> for TautLink<S> {
    fn enter(
        entry: &Entry,
        _handover: &mut Handover<S>,
        cx: &Context<'_, S>,
    ) -> Result<Self, Refusal> {
        let purpose = if entry.mode == Mode::TautAttitude {
            TautPurpose::Attitude
        } else {
            TautPurpose::Force
        };
        let situation = cx.situation;
        let Some(taut) = cx.config.modes.taut.as_ref() else {
            return Err(NEEDS_FIXED_LENGTH);
        };
        let Some(now) = situation.taut.estimate() else {
            return Err(rejected("Mode refused: not in the air"));
        };
        let is_slack = now.link_force.abs() < taut.force_min * S::lit(0.5);
        if is_slack || !taut.bounds.kind.carries(now.link_force.to_f32()) {
            return Err(rejected("Mode refused: link is slack"));
        }
        if (now.planar.elevation + now.planar.pitch).sin_cos().1 < S::lit(0.1) {
            return Err(rejected("Mode refused: thrust along the link"));
        }
        let Some(tether) = situation.estimate.tether else {
            return Err(rejected("Mode refused: no position estimate"));
        };
        let (roll, _, yaw) = situation.estimate.attitude.euler();
        let azimuth = wrap_pi(tether.azimuth - yaw);
        if azimuth.abs() > S::lit(NOSE_MAX) {
            return Err(rejected("Mode refused: nose not along the link"));
        }
        let measured = taut.altimeter_tau.and_then(|_| elevation_by_altimeter(cx));
        let correction = measured
            .map_or(S::zero(), |phi| wrap_pi(now.planar.elevation - phi))
            .limit_abs(S::lit(CORRECTION_MAX));
        let elevation = now.planar.elevation - correction;
        Ok(Self {
            purpose,
            controller: taut.controller(purpose).start(now),
            plan: TautPlan::stay(purpose, elevation, second(purpose, now)),
            candidate: None,
            correction,
            pull: now.link_force,
            slack: S::zero(),
            start: OutOfPlane { azimuth, roll },
        })
    }

    fn step(
        &mut self,
        handover: &mut Handover<S>,
        cx: &Context<'_, S>,
    ) -> Result<Setpoints<S>, Exit> {
        let tension = cx.tension_in_flight(handover);
        let (Some(taut), Some(now)) = (cx.config.modes.taut.as_ref(), cx.situation.taut.estimate())
        else {
            return Err(Exit::failed("Taut link lost: holding"));
        };
        let dt = S::lit(OUTER_DT);
        if let (Some(tau), Some(measured)) = (taut.altimeter_tau, elevation_by_altimeter(cx)) {
            let off = wrap_pi(now.planar.elevation - measured);
            self.correction = (self.correction + (off - self.correction) * (dt / tau))
                .limit_abs(S::lit(CORRECTION_MAX));
        }
        let PlanarReference { mut elevation, second } = self.plan.step(dt);
        // Without a link the vehicle would speed up until its drag looks like the force it wants.
        let [wanted, ..] = second;
        let floor = taut.force_min * S::lit(0.5);
        let (expected, patience) = match self.purpose {
            TautPurpose::Force => ((wanted * S::lit(SLACK_SHARE)).max(floor), SLACK_TIME_FORCE),
            TautPurpose::Attitude => {
                ((self.pull * S::lit(SLACK_SHARE)).max(floor), SLACK_TIME_ATTITUDE)
            }
        };
        let is_pulling =
            taut.bounds.kind.is_rigid() || (now.link_force > expected && is_within_reach(cx));
        if is_pulling {
            self.pull += (now.link_force - self.pull) * (dt / S::lit(PULL_TIME));
            self.slack = S::zero();
        } else {
            self.slack += dt;
        }
        if self.slack > S::lit(patience) {
            return Err(SLACK);
        }
        if let Some(phi) = elevation.first_mut() {
            *phi += self.correction;
        }
        let reference = PlanarReference { elevation, second };
        let rate = &cx.situation.estimate.rate;
        taut.controller(self.purpose)
            .step(&mut self.controller, now, rate, &reference)
            .map(|attitude| cx.placeless(attitude, tension))
            .map_err(|_| Exit::failed("Taut link controller failed: holding"))
    }

    fn command(
        &mut self,
        _handover: &mut Handover<S>,
        action: &Action,
        cx: &Context<'_, S>,
    ) -> Result<(), Refusal> {
        self.go(action, cx)
    }

    fn is_considering(&self) -> bool {
        self.candidate.is_some()
    }

    fn consider(&mut self, cx: &Context<'_, S>) -> Option<Result<(), Refusal>> {
        self.look(cx)
    }

    /// Whatever it has become: nobody held it.
    fn heading(&self, _handover: &Handover<S>, cx: &Context<'_, S>) -> S {
        let (.., yaw) = cx.situation.estimate.attitude.euler();
        yaw
    }

    fn sees_pull(&self, cx: &Context<'_, S>) -> Option<bool> {
        let taut = cx.situation.taut.estimate()?;
        Some(
            cx.config.constants.kind.is_rigid()
                || taut.link_force > S::from_f32(cx.params.slack_tension),
        )
    }

    fn purpose(&self) -> Option<TautPurpose> {
        Some(self.purpose)
    }

    fn out_of_plane(&self) -> Option<OutOfPlane<S>> {
        Some(self.start)
    }

    fn report(&self) -> ModeReport<S> {
        ModeReport { taut: Some(self.plan.now()), ..ModeReport::default() }
    }
}
