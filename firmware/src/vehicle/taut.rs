//! The taut-link modes: entering, moving, flying, handing back.

use super::requests::{Refusal, denied, rejected};
use super::{TautFlight, Vehicle};
use crate::control::taut::TautPilot;
use crate::estimate::taut::{TautEstimate, TautEstimator, TautInput};
use crate::math::wrap_pi;
use crate::model::LinkKind;
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::{Event, EventQueue, PlanarReference, Sensors, TautPurpose};
use crate::supervisor::Mode;
use crate::time::OUTER_DT;
use crate::trajectory::{TautBounds, TautPlan};

/// The nose may be this far from the plane of the link at entry, rad.
const NOSE_MAX: f64 = 0.35;
/// A stated start may be this far from the estimate: rad; N, or rad of pitch.
const START_ELEVATION: f64 = 0.2;
const START_FORCE: f64 = 2.0;
const START_PITCH: f64 = 0.15;
/// Of every mode on a taut link.
pub(super) const NEEDS_FIXED_LENGTH: Refusal = denied("Mode refused: needs a link of fixed length");
/// Set-points closer than this are the same.
const SAME: f64 = 1e-3;
/// Largest correction by the altimeter, rad.
const CORRECTION_MAX: f64 = 0.4;
/// A cable that pulls less than this share of what is wanted is slack or broken; for so long, s, it may:
/// shorter where the vehicle would speed up after the missing force.
pub(super) const SLACK_SHARE: f64 = 0.3;
pub(super) const SLACK_TIME_FORCE: f64 = 0.5;
const SLACK_TIME_ATTITUDE: f64 = 1.0;
/// Shortest automatic move, s; automatic change of link force, N/s.
const MOVE_SHORTEST: f64 = 3.0;
const FORCE_RATE: f64 = 1.0;
/// Automatic duration where the link force changes its sign, s.
const CROSSING: f64 = 1.5;

/// Configuration of everything on a taut link.
#[derive(Clone, Copy, Debug)]
pub(super) struct Taut<S: Scalar> {
    pub estimator: TautEstimator<S>,
    force: TautPilot<S>,
    attitude: TautPilot<S>,
    bounds: TautBounds<S>,
    /// s; `None`: by inertia alone.
    altimeter_tau: Option<S>,
    force_min: S,
    cruise: S,
}

impl<S: Scalar> Taut<S> {
    /// From the parameters; `None` where their ranges let something impossible through.
    pub fn new(p: &Params) -> Option<Self> {
        let estimator = TautEstimator::try_new(p).ok()?;
        let model = *estimator.model();
        let force = TautPilot::try_new(p, model, TautPurpose::Force).ok()?;
        let attitude = TautPilot::try_new(p, model, TautPurpose::Attitude).ok()?;
        Some(Self {
            bounds: TautBounds {
                model,
                kind: LinkKind::from_parameter(p.tether_kind),
                thrust: force.thrust_range(),
                // What the observer cannot see is no set-point.
                force_min: S::from_f32(p.taut_force_min).max(estimator.force_floor()),
                elevation: (S::from_f32(p.elevation_min), S::from_f32(p.elevation_max)),
            },
            estimator,
            force,
            attitude,
            altimeter_tau: (p.taut_altimeter_tau > 0.0).then(|| S::from_f32(p.taut_altimeter_tau)),
            force_min: S::from_f32(p.taut_force_min),
            cruise: S::from_f32(p.cruise_speed),
        })
    }

    fn pilot(&self, purpose: TautPurpose) -> &TautPilot<S> {
        match purpose {
            TautPurpose::Force => &self.force,
            TautPurpose::Attitude => &self.attitude,
        }
    }
}

/// The second output as the observer sees it.
fn second<S: Scalar>(purpose: TautPurpose, now: &TautEstimate<S>) -> S {
    match purpose {
        TautPurpose::Force => now.link_force,
        TautPurpose::Attitude => now.planar.pitch,
    }
}

impl Mode {
    /// What a taut-link mode controls; `None` for the other modes.
    pub(super) fn purpose(self) -> Option<TautPurpose> {
        match self {
            Self::TautForce => Some(TautPurpose::Force),
            Self::TautAttitude => Some(TautPurpose::Attitude),
            _ => None,
        }
    }
}

impl<S: Scalar> Vehicle<S> {
    /// Runs the observer in the air, whatever the mode, so that it has converged when it is wanted.
    pub(super) fn observe_link(&mut self) {
        let imu = self.inertial_mean();
        let state = &mut self.state;
        let Some(taut) = self.config.taut.as_ref().filter(|_| state.estimator.is_airborne()) else {
            state.taut = Default::default();
            return;
        };
        let (roll, ..) = state.estimate.attitude.euler();
        let input = TautInput {
            imu,
            thrust: state.estimate.thrust,
            roll,
            purpose: state.mode.purpose().unwrap_or_default(),
        };
        taut.estimator.step(&mut state.taut, &input);
    }

    /// Elevation by altimeter and length, rad.
    fn elevation_by_altimeter(&self, sensors: &Sensors<S>) -> Option<S> {
        // The link ends below the centre of mass.
        let estimate = &self.state.estimate;
        let end = S::from_f32(self.params.attachment) * estimate.attitude.cos_tilt();
        let sin = (estimate.height - end) / self.config.tether_length;
        (sensors.altitude_is_fresh && sin.abs() < S::one()).then(|| sin.asin())
    }

    pub(super) fn request_taut(
        &mut self,
        purpose: TautPurpose,
        sensors: &Sensors<S>,
    ) -> Result<(), Refusal> {
        let Some(taut) = self.config.taut.filter(|t| !t.bounds.kind.has_winch()) else {
            return Err(NEEDS_FIXED_LENGTH);
        };
        let Some(now) = self.state.taut.estimate().copied() else {
            return Err(rejected("Mode refused: not in the air"));
        };
        let is_slack = now.link_force.abs() < taut.force_min * S::lit(0.5);
        if is_slack || !taut.bounds.kind.carries(now.link_force.to_f32()) {
            return Err(rejected("Mode refused: link is slack"));
        }
        if (now.planar.elevation + now.planar.pitch).sin_cos().1 < S::lit(0.1) {
            return Err(rejected("Mode refused: thrust along the link"));
        }
        let Some(tether) = self.state.estimate.tether else {
            return Err(rejected("Mode refused: no position estimate"));
        };
        let (roll, _, yaw) = self.state.estimate.attitude.euler();
        let azimuth = wrap_pi(tether.azimuth - yaw);
        if azimuth.abs() > S::lit(NOSE_MAX) {
            return Err(rejected("Mode refused: nose not along the link"));
        }
        let measured = taut.altimeter_tau.and_then(|_| self.elevation_by_altimeter(sensors));
        let correction = measured
            .map_or(S::zero(), |phi| wrap_pi(now.planar.elevation - phi))
            .limit_abs(S::lit(CORRECTION_MAX));
        let elevation = now.planar.elevation - correction;
        let plan = TautPlan::stay(purpose, elevation, second(purpose, &now));
        let pilot = taut.pilot(purpose).start(&now);
        self.enter(match purpose {
            TautPurpose::Force => Mode::TautForce,
            TautPurpose::Attitude => Mode::TautAttitude,
        });
        // After the other taut-link mode has ended, which forgets its sideways filter.
        taut.estimator.watch_sideways(&mut self.state.taut, azimuth, roll);
        self.state.taut_flight = Some(TautFlight { pilot, plan, correction, slack: S::zero() });
        Ok(())
    }

    /// A move: start and end of each output, `None` for where the reference is or stays.
    pub(super) fn move_taut(
        &mut self,
        elevation: [Option<f32>; 2],
        force: [Option<f32>; 2],
        pitch: [Option<f32>; 2],
        duration: Option<f32>,
    ) -> Result<(), Refusal> {
        let (Some(purpose), Some(flight), Some(taut)) =
            (self.state.mode.purpose(), self.state.taut_flight, self.config.taut)
        else {
            return Err(rejected("Move refused: not in a taut-link mode"));
        };
        let (wanted, other, tolerance) = match purpose {
            TautPurpose::Force => (force, pitch, START_FORCE),
            TautPurpose::Attitude => (pitch, force, START_PITCH),
        };
        if other.iter().any(Option::is_some) {
            return Err(denied("Move refused: not an output of this mode"));
        }
        if !flight.plan.is_done() {
            return Err(rejected("Move refused: the last move is still flown"));
        }
        let at = flight.plan.now();
        let ([phi, ..], [y, ..]) = (at.elevation, at.second);
        let pick = |x: Option<f32>, or: S| x.map_or(or, S::from_f32);
        let [from, to] = elevation;
        let from = pick(from, phi);
        let to = pick(to, phi);
        let [second_from, second_to] = wanted;
        let second_from = pick(second_from, y);
        let second_to = pick(second_to, y);
        let now = self.state.taut.estimate();
        let is_near = |stated: S, seen: S, most: f64| (stated - seen).abs() <= S::lit(most);
        let is_here = now.is_some_and(|now| {
            is_near(from, now.planar.elevation - flight.correction, START_ELEVATION)
                && is_near(second_from, second(purpose, now), tolerance)
        });
        if !is_here {
            return Err(denied("Move refused: start is not where the vehicle is"));
        }
        let is_same = |a: S, b: S| (a - b).abs() < S::lit(SAME);
        let is_start = is_same(from, phi) && is_same(second_from, y);
        if is_start && is_same(to, phi) && is_same(second_to, y) {
            return Ok(());
        }
        let duration = duration.map_or_else(
            || self.move_time(purpose, &taut, [from, to], [second_from, second_to]),
            S::from_f32,
        );
        let plan = TautPlan::go(purpose, [from, to], [second_from, second_to], duration)
            .filter(|_| duration >= S::lit(0.5) && duration <= S::lit(600.0))
            .ok_or(denied("Move refused: duration out of range"))?;
        plan.check(&taut.bounds).map_err(denied)?;
        self.state.taut_flight = Some(TautFlight { plan, ..flight });
        Ok(())
    }

    /// Time that keeps the cruise speed along the sphere and a gentle change of force.
    fn move_time(&self, purpose: TautPurpose, taut: &Taut<S>, phi: [S; 2], y: [S; 2]) -> S {
        let ([from, to], [y_from, y_to]) = (phi, y);
        let peak = S::lit(2.5);
        let way = (to - from).abs() * self.config.tether_length;
        let by_speed = peak * way / taut.cruise.max(S::lit(0.1));
        let by_force = match purpose {
            TautPurpose::Force => (y_to - y_from).abs() / S::lit(FORCE_RATE),
            TautPurpose::Attitude => (y_to - y_from).abs() * S::lit(10.0),
        };
        if purpose == TautPurpose::Force && (y_from > S::zero()) != (y_to > S::zero()) {
            return S::lit(CROSSING);
        }
        by_speed.max(by_force).max(S::lit(MOVE_SHORTEST))
    }

    pub(super) fn fly_taut(&mut self, sensors: &Sensors<S>, events: &mut EventQueue) {
        let measured = self.elevation_by_altimeter(sensors);
        let rate = self.state.estimate.rate;
        let state = &mut self.state;
        let (Some(purpose), Some(flight), Some(taut), Some(now)) = (
            state.mode.purpose(),
            &mut state.taut_flight,
            self.config.taut.as_ref(),
            state.taut.estimate(),
        ) else {
            return self.leave_taut("Taut link lost: holding", events);
        };
        state.reference = None;
        let dt = S::lit(OUTER_DT);
        if let (Some(tau), Some(measured)) = (taut.altimeter_tau, measured) {
            let off = wrap_pi(now.planar.elevation - measured);
            flight.correction = (flight.correction + (off - flight.correction) * (dt / tau))
                .limit_abs(S::lit(CORRECTION_MAX));
        }
        let PlanarReference { mut elevation, second } = flight.plan.step(dt);
        // Without a link the vehicle would speed up until its drag looks like the force it wants.
        let [wanted, ..] = second;
        let floor = taut.force_min * S::lit(0.5);
        let (expected, patience) = match purpose {
            TautPurpose::Force => ((wanted * S::lit(SLACK_SHARE)).max(floor), SLACK_TIME_FORCE),
            TautPurpose::Attitude => (floor, SLACK_TIME_ATTITUDE),
        };
        let is_pulling = taut.bounds.kind.is_rigid() || now.link_force > expected;
        flight.slack = if is_pulling { S::zero() } else { flight.slack + dt };
        if flight.slack > S::lit(patience) {
            events.push(Event::critical("Tether slack: descending"));
            return self.enter(Mode::Descent);
        }
        if let Some(phi) = elevation.first_mut() {
            *phi += flight.correction;
        }
        let reference = PlanarReference { elevation, second };
        match taut.pilot(purpose).step(&mut flight.pilot, now, &rate, &reference) {
            Ok(command) => state.attitude = command,
            Err(_) => self.leave_taut("Taut link controller failed: holding", events),
        }
    }

    /// Back to Tether Hold, or down where no position is known.
    pub(super) fn leave_taut(&mut self, text: &'static str, events: &mut EventQueue) {
        let mode =
            if self.state.estimate.position.is_some() { Mode::TetherHold } else { Mode::Descent };
        events.push(Event::critical(text));
        self.enter(mode);
    }

    /// What the modes other than the taut-link ones need when these end.
    pub(super) fn end_taut(&mut self) {
        self.state.angle_flight = None;
        self.state.pendulum_flight = None;
        if self.state.taut_flight.take().is_some() {
            let (.., yaw) = self.state.estimate.attitude.euler();
            self.state.yaw = yaw;
            self.state.taut.forget_sideways();
        }
    }
}
