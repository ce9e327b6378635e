//! What is asked from outside: checked, then done or refused with a reason.

use super::Vehicle;
use super::config::Config;
use super::pendulum::gain_warning;
use crate::control::Link;
use crate::frames::{V3, World};
use crate::param::{META, Params};
use crate::scalar::Scalar;
use crate::signal::{Action, Event, EventQueue, Outcome, Reply, Request, Sensors, SphericalPoint};
use crate::supervisor::{ArmingCheck, FAILSAFES, FailsafeAction, GroundState, Mode};
use crate::time::Micros;
use crate::trajectory::Plan;

/// Set-points closer than this in every coordinate are the same, m.
pub(super) const SAME_PLACE: f64 = 0.01;

/// Refused, and why.
pub(super) type Refusal = (Outcome, &'static str);

pub(super) const fn rejected(text: &'static str) -> Refusal {
    (Outcome::Rejected, text)
}
pub(super) const fn denied(text: &'static str) -> Refusal {
    (Outcome::Denied, text)
}

pub(super) fn check_heading(yaw: Option<f32>) -> Result<(), Refusal> {
    let is_bad = |yaw: f32| !yaw.is_finite() || yaw.abs() > 100.0;
    if yaw.is_some_and(is_bad) { Err(denied("Move refused: not a number")) } else { Ok(()) }
}

impl<S: Scalar> Vehicle<S> {
    pub(super) fn handle(
        &mut self,
        request: &Request,
        sensors: &Sensors<S>,
        now: Micros,
        events: &mut EventQueue,
    ) -> Reply {
        let mut parameter = None;
        let result = match request.action {
            Action::Arm { force } => self.arm(force, sensors, now, events),
            Action::Disarm { force } => self.disarm_on_request(force, events),
            Action::SetMode(mode) => self.request_mode(mode, sensors, now),
            Action::Takeoff { altitude } => self.request_takeoff(altitude),
            Action::MoveTo { ned, .. } if self.state.mode.purpose().is_some() => {
                self.move_taut_to(ned)
            }
            Action::MoveTo { ned, yaw } if self.state.mode == Mode::Pendulum => {
                self.move_load(ned, yaw)
            }
            Action::MoveTo { ned, yaw } => self.move_to(ned, yaw),
            Action::MoveTether { elevation, tension, .. }
                if self.state.mode.purpose().is_some() =>
            {
                self.move_taut([None, elevation], [None, tension], [None; 2], None)
            }
            Action::MoveTaut { elevation, force, pitch, duration } => {
                self.move_taut(elevation, force, pitch, duration)
            }
            Action::MoveTether { elevation, azimuth, length, tension } => {
                self.move_tether([elevation, azimuth, length], tension)
            }
            Action::Pause => {
                self.request_mode(Mode::TetherHold, sensors, now).map(|()| self.stay())
            }
            Action::SetParam { index, value } => {
                parameter = Some(index);
                self.set_param(index, value, events)
            }
            Action::ResetParams => self.reset_params(),
            Action::Level => self.level(),
        };
        let outcome = match result {
            Ok(()) => Outcome::Accepted,
            Err((outcome, text)) => {
                events.push(Event::warning(text));
                outcome
            }
        };
        Reply { ticket: request.ticket, outcome, parameter }
    }

    fn is_in_air(&self) -> bool {
        self.state.armed_at.is_some() && self.state.ground != GroundState::OnGround
    }

    fn arm(
        &mut self,
        force: bool,
        sensors: &Sensors<S>,
        now: Micros,
        events: &mut EventQueue,
    ) -> Result<(), Refusal> {
        if self.state.armed_at.is_some() {
            return Ok(());
        }
        if let Some(check) = ArmingCheck::first_failure(&self.arming_facts(sensors, now), force) {
            return Err(rejected(check.text));
        }
        let state = &mut self.state;
        if matches!(state.mode, Mode::Land | Mode::Descent) {
            state.mode = Mode::TetherHold;
        }
        state.armed_at = Some(now);
        state.landed_at = None;
        state.ground = GroundState::OnGround;
        state.tension = self.config.tension_low;
        if self.config.link == Link::Free {
            // Nothing points anywhere: as it was put down.
            (.., state.yaw) = state.estimate.attitude.euler();
        }
        events.push(Event::info("Armed"));
        Ok(())
    }

    fn disarm_on_request(&mut self, force: bool, events: &mut EventQueue) -> Result<(), Refusal> {
        if self.is_in_air() && !force {
            return Err(denied("Disarm refused: in the air"));
        }
        if self.state.armed_at.is_some() {
            self.disarm(Event::info("Disarmed"), events);
        }
        Ok(())
    }

    pub(super) fn disarm(&mut self, event: Event, events: &mut EventQueue) {
        self.end_taut();
        let state = &mut self.state;
        state.armed_at = None;
        state.ground = GroundState::OnGround;
        state.takeoff_altitude = None;
        state.slack_hover = None;
        state.reference = None;
        if matches!(state.mode, Mode::Takeoff | Mode::Pendulum) || state.mode.flies_taut() {
            state.mode = Mode::TetherHold;
        }
        events.push(event);
    }

    /// The most severe action that is due now.
    fn failsafe_in_force(&self) -> Option<FailsafeAction> {
        let active = self.state.failsafe.active;
        FAILSAFES
            .iter()
            .filter(|row| active & (1 << row.failure as u16) != 0)
            .map(|row| (row.action)(&self.config.failsafes))
            .max()
    }

    fn request_mode(
        &mut self,
        mode: Mode,
        sensors: &Sensors<S>,
        now: Micros,
    ) -> Result<(), Refusal> {
        let needs = mode.rule().needs;
        if mode == Mode::Takeoff {
            return self.request_takeoff(None);
        }
        if needs.sticks && !self.sticks_are_up(now) {
            return Err(rejected("Mode refused: no joystick"));
        }
        if needs.position && !self.has_place() {
            return Err(rejected("Mode refused: no position estimate"));
        }
        if self.is_in_air() {
            let is_escape = needs.sticks || mode == Mode::Descent;
            match self.failsafe_in_force() {
                Some(FailsafeAction::Land) if mode != Mode::Land && !is_escape => {
                    return Err(rejected("Mode refused: failsafe is landing"));
                }
                Some(FailsafeAction::Descend | FailsafeAction::Terminate) if !is_escape => {
                    return Err(rejected("Mode refused: failsafe is descending"));
                }
                _ => {}
            }
        }
        if let Some(purpose) = mode.purpose() {
            return if mode == self.state.mode {
                Ok(())
            } else {
                self.request_taut(purpose, sensors)
            };
        }
        if mode == Mode::TetherAngle {
            return if mode == self.state.mode { Ok(()) } else { self.request_angle() };
        }
        if mode == Mode::Pendulum {
            return if mode == self.state.mode { Ok(()) } else { self.request_pendulum(now) };
        }
        self.enter(mode);
        Ok(())
    }

    fn request_takeoff(&mut self, altitude: Option<f32>) -> Result<(), Refusal> {
        if self.is_in_air() {
            return Err(denied("Take-off refused: already in the air"));
        }
        if self.state.estimate.position.is_none() {
            return Err(rejected("Take-off refused: no position estimate"));
        }
        self.takeoff_point(altitude.unwrap_or(self.params.takeoff_altitude))
            .ok_or(denied("Take-off refused: altitude beyond the tether"))?;
        self.state.takeoff_altitude = altitude;
        self.state.mode = Mode::Takeoff;
        Ok(())
    }

    /// Where a take-off to this altitude ends: straight out along the start heading; free straight up.
    pub(super) fn takeoff_point(&self, altitude: f32) -> Option<SphericalPoint<S>> {
        let p = &self.params;
        if self.config.link == Link::Free {
            let here = self.state.estimate.position?.0;
            let reaches = altitude > p.ground_height && altitude < p.length_max;
            let above = World(V3::new(here.x, here.y, -S::from_f32(altitude)));
            return reaches.then(|| SphericalPoint::from_world(&above));
        }
        let sin = altitude / p.tether_length;
        // The negation refuses NaN too.
        if !(altitude > p.ground_height && sin < 1.0) {
            return None;
        }
        let elevation = libm::asinf(sin);
        (elevation >= p.elevation_min && elevation <= p.elevation_max).then(|| SphericalPoint {
            elevation: S::from_f32(elevation),
            azimuth: S::from_f32(p.start_heading),
            length: S::from_f32(p.tether_length),
        })
    }

    fn may_move(&self) -> Result<SphericalPoint<f32>, Refusal> {
        let moves = matches!(self.state.mode, Mode::TetherHold | Mode::TetherAngle);
        if !self.is_in_air() || !moves {
            return Err(rejected("Move refused: not in Tether Hold in the air"));
        }
        let end = SphericalPoint::from_world(&self.state.plan.end());
        Ok(SphericalPoint {
            elevation: end.elevation.to_f32(),
            azimuth: end.azimuth.to_f32(),
            length: end.length.to_f32(),
        })
    }

    fn move_to(&mut self, ned: [Option<f32>; 3], yaw: Option<f32>) -> Result<(), Refusal> {
        let now = self.may_move()?;
        let here = now.to_world().0;
        let [north, east, down] = ned;
        let to =
            World(V3::new(north.unwrap_or(here.x), east.unwrap_or(here.y), down.unwrap_or(here.z)));
        check_heading(yaw)?;
        if ned.iter().any(Option::is_some) {
            let mut to_point = SphericalPoint::from_world(&to);
            if self.config.link == Link::FixedLength {
                to_point.length = self.params.tether_length;
            }
            self.start_move(&to_point)?;
        }
        if let Some(yaw) = yaw {
            self.state.yaw = S::from_f32(yaw);
        }
        Ok(())
    }

    /// Of a place only the elevation counts where the length is given and the azimuth held.
    fn move_taut_to(&mut self, ned: [Option<f32>; 3]) -> Result<(), Refusal> {
        let [_, _, Some(down)] = ned else {
            return Err(denied("Move refused: needs an altitude"));
        };
        let sin = -down / self.params.tether_length;
        if sin.is_nan() || sin.abs() >= 1.0 {
            return Err(denied("Move refused: altitude beyond the tether"));
        }
        self.move_taut([None, Some(libm::asinf(sin))], [None; 2], [None; 2], None)
    }

    fn move_tether(
        &mut self,
        place: [Option<f32>; 3],
        tension: Option<f32>,
    ) -> Result<(), Refusal> {
        let now = self.may_move()?;
        if tension.is_some() && self.state.mode == Mode::TetherAngle {
            return Err(denied("Move refused: not an output of this mode"));
        }
        if let Some(tension) = tension {
            let p = &self.params;
            let reserve = 0.9 * p.thrust_max - p.mass * crate::math::GRAVITY as f32;
            if !(tension >= p.tension_min && tension <= p.tension_max.min(reserve)) {
                return Err(denied("Move refused: tension out of range"));
            }
        }
        let [elevation, azimuth, length] = place;
        self.start_move(&SphericalPoint {
            elevation: elevation.unwrap_or(now.elevation),
            azimuth: azimuth.unwrap_or(now.azimuth),
            length: length.unwrap_or(now.length),
        })?;
        if let Some(tension) = tension {
            self.state.tension_target = S::from_f32(tension);
        }
        Ok(())
    }

    fn start_move(&mut self, to: &SphericalPoint<f32>) -> Result<(), Refusal> {
        let p = &self.params;
        let within = |x: f32, lo: f32, hi: f32| x >= lo && x <= hi;
        if !(to.elevation.is_finite() && to.length.is_finite() && to.azimuth.abs() < 100.0) {
            return Err(denied("Move refused: not a number"));
        }
        let is_free = self.config.link == Link::Free;
        let (low, high) = (p.elevation_min - 0.01, p.elevation_max + 0.01);
        if !is_free && !within(to.elevation, low, high) {
            return Err(denied("Move refused: elevation out of range"));
        }
        let nearest = if is_free { 0.1 } else { 1.0 };
        if !within(to.length, nearest, p.length_max) {
            return Err(denied("Move refused: length out of range"));
        }
        let is_fixed = self.config.link == Link::FixedLength;
        if is_fixed && (to.length - p.tether_length).abs() > 0.3 {
            return Err(denied("Move refused: the tether has a fixed length"));
        }
        let to = SphericalPoint {
            elevation: S::from_f32(to.elevation),
            azimuth: S::from_f32(to.azimuth),
            length: S::from_f32(to.length),
        };
        // Programs repeat their set-point many times a second: only a new place is a new move.
        let is_new = (to.to_world().0 - self.state.plan.end().0)
            .iter()
            .any(|d| d.abs() > S::lit(SAME_PLACE));
        if !is_new {
            return Ok(());
        }
        let from = self.state.reference.map_or(self.state.plan.end(), |r| r.position);
        self.state.plan = self.config.planner.go(from, to);
        Ok(())
    }

    /// Holds where the vehicle is.
    pub(super) fn stay(&mut self) {
        if let Some(position) = self.state.estimate.position {
            self.state.plan = Plan::stay(position);
        }
    }

    fn set_param(
        &mut self,
        index: usize,
        value: f32,
        events: &mut EventQueue,
    ) -> Result<(), Refusal> {
        let guarded = |group: &str| matches!(group, "Vehicle" | "Motors" | "Sensors" | "Tether");
        if self.is_in_air() && META.get(index).is_some_and(|meta| guarded(meta.group)) {
            return Err(rejected("Parameter refused: not in the air"));
        }
        self.params.set(index, value).map_err(|_| denied("Parameter refused: out of range"))?;
        self.reconfigure();
        let concerns_pendulum = META.get(index).is_some_and(|meta| meta.group == "Pendulum");
        if let Some(text) = gain_warning(&self.params).filter(|_| concerns_pendulum) {
            events.push(Event::warning(text));
        }
        Ok(())
    }

    fn reset_params(&mut self) -> Result<(), Refusal> {
        if self.state.armed_at.is_some() {
            return Err(rejected("Reset refused: armed"));
        }
        self.params = Params::default();
        self.reconfigure();
        Ok(())
    }

    fn reconfigure(&mut self) {
        self.config = Config::new(&self.params, self.scale);
        if self.state.armed_at.is_none() {
            // The place to start from and the heading follow from the parameters.
            self.state.estimator.replace(&self.config.estimator);
            self.state.yaw = S::from_f32(self.params.start_heading);
            self.state.tension_target = S::from_f32(self.params.tension);
        }
    }

    fn level(&mut self) -> Result<(), Refusal> {
        if self.state.armed_at.is_some() {
            return Err(rejected("Levelling refused: armed"));
        }
        self.state.estimator.relevel();
        self.state.estimate = self.config.estimator.estimate(&self.state.estimator);
        Ok(())
    }
}
