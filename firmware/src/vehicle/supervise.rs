//! Failsafes, landing and the automatic mode changes.

use super::Vehicle;
use crate::control::Link;
use crate::scalar::Scalar;
use crate::signal::{Event, EventQueue, Sensors};
use crate::supervisor::{
    ArmingCheck, ArmingFacts, FailsafeAction, FailsafeFacts, GroundState, Mode,
};
use crate::time::Micros;
use crate::trajectory::Plan;

/// A ground station or joystick that was silent this long is not there.
const VOICE_TIMEOUT_US: u64 = 3_000_000;
const STICKS_TIMEOUT_US: u64 = 1_000_000;

impl<S: Scalar> Vehicle<S> {
    pub(super) fn sticks_are_up(&self, now: Micros) -> bool {
        self.state.sticks.is_some_and(|s| now.since(s.at) < STICKS_TIMEOUT_US)
    }

    fn link_is_up(&self, now: Micros) -> bool {
        // No shorter than the silence that counts as loss: a simulator in a hurry stretches that one.
        let lost = (self.params.link_loss_time * 1e6) as u64;
        self.state.link_at.is_some_and(|at| now.since(at) < VOICE_TIMEOUT_US.max(lost))
    }

    pub(super) fn arming_facts(&self, sensors: &Sensors<S>, now: Micros) -> ArmingFacts {
        let (state, p) = (&self.state, &self.params);
        let throttle_is_open = state.mode.rule().needs.sticks
            && state
                .sticks
                .is_none_or(|s| now.since(s.at) > STICKS_TIMEOUT_US || s.value.throttle > 0.05);
        let pull = if self.config.link == Link::Free { 0.0 } else { p.tension };
        ArmingFacts {
            imu: sensors.imu_health,
            is_levelled: state.estimate.is_levelled,
            cos_tilt: state.estimate.attitude.cos_tilt().to_f32(),
            altitude_is_fresh: sensors.altitude_is_fresh,
            tether_is_known: self.tether_is_known(sensors),
            cell: sensors.battery.map(|battery| battery.cell.to_f32()),
            cell_low: p.battery_low,
            link_is_up: self.link_is_up(now),
            throttle_is_open,
            hover_share: (p.mass * crate::math::GRAVITY as f32 + pull) / (4.0 * p.rotor_thrust_max),
        }
    }

    /// Whether there is a position to fly by; on the way up on a slack link there is none yet.
    pub(super) fn has_place(&self) -> bool {
        self.state.estimate.position.is_some() && self.state.slack_hover.is_none()
    }

    /// In a taut-link mode its own observer says so.
    fn link_is_taut(&self) -> bool {
        if let Some(angle) = &self.state.angle_flight {
            return angle.slack <= S::zero();
        }
        match self.state.taut.estimate().filter(|_| self.state.taut_flight.is_some()) {
            _ if self.config.kind.is_rigid() || self.config.kind.is_free() => true,
            _ if self.takes_off_slack() => true,
            Some(taut) => taut.link_force > S::from_f32(self.params.slack_tension),
            None => self.state.estimate.tether.is_none_or(|tether| tether.is_taut),
        }
    }

    fn tether_is_known(&self, sensors: &Sensors<S>) -> bool {
        sensors.tether_is_fresh || self.config.link != Link::Winch
    }

    pub(super) fn is_armable(&self, sensors: &Sensors<S>, now: Micros) -> bool {
        ArmingCheck::first_failure(&self.arming_facts(sensors, now), false).is_none()
    }

    pub(super) fn supervise(&mut self, sensors: &Sensors<S>, now: Micros, events: &mut EventQueue) {
        let facts = FailsafeFacts {
            mode: self.state.mode,
            cos_tilt: self.state.estimate.attitude.cos_tilt().to_f32(),
            imu: sensors.imu_health,
            has_diverged: self.state.estimate.has_diverged,
            altitude_is_fresh: sensors.altitude_is_fresh,
            is_taut: self.link_is_taut(),
            has_capture: !self.config.kind.is_free() || self.state.estimate.position.is_some(),
            tether_is_known: self.tether_is_known(sensors),
            cell: sensors.battery.map(|battery| battery.cell.to_f32()),
            link_silence_us: self.state.link_at.map(|at| now.since(at)),
            sticks_are_up: self.sticks_are_up(now),
        };
        self.state.is_armable = self.is_armable(sensors, now);
        if self.state.armed_at.is_none() {
            self.state.failsafe = crate::supervisor::FailsafeState::default();
            return;
        }
        let (action, announced) = self.config.failsafes.step(&mut self.state.failsafe, &facts, now);
        if let Some(row) = announced {
            events.push(Event::critical(row.text));
        }
        if let Some(action) = action {
            self.react(action, announced.is_some(), events);
        }
        self.stop_when_landed(now, events);
    }

    fn react(&mut self, action: FailsafeAction, is_new: bool, events: &mut EventQueue) {
        if self.state.ground == GroundState::OnGround {
            // After a landing the motors stop by themselves.
            if action >= FailsafeAction::Land && self.state.landed_at.is_none() {
                self.disarm(Event::warning("Disarmed: failsafe on the ground"), events);
            }
            return;
        }
        let Some(mode) = action.mode() else {
            self.disarm(Event::critical("Motors stopped"), events);
            return;
        };
        // Landing needs a position; without one, level and down.
        let mode =
            if mode.rule().needs.position && !self.has_place() { Mode::Descent } else { mode };
        let rank = |mode: Mode| match mode {
            Mode::Descent => 2,
            Mode::Land => 1,
            _ => 0,
        };
        let present = self.state.mode;
        // A pilot with sticks in hand may fly on, unless it is the joystick that failed.
        let is_manual = present.rule().needs.sticks;
        if rank(mode) > rank(present) && (is_new || !is_manual) {
            self.enter(mode);
        } else if is_new && rank(mode) == 0 && rank(present) == 0 {
            self.enter(mode);
            self.stay();
        }
    }

    /// Changes the mode and prepares what the new one flies on.
    pub(super) fn enter(&mut self, mode: Mode) {
        let state = &mut self.state;
        if state.mode == mode {
            return;
        }
        state.mode = mode;
        state.slack_hover = None;
        self.end_taut();
        let state = &mut self.state;
        if state.armed_at.is_none() || state.ground == GroundState::OnGround {
            return;
        }
        state.ground = GroundState::InAir;
        state.contact_ramp = S::one();
        // The thrust of the moment carries weight and tether: the climb loop starts from there.
        let lift = state.estimate.thrust * state.estimate.attitude.cos_tilt();
        state.climb = self.config.climb.holding(lift);
        let Some(position) = state.estimate.position else {
            return;
        };
        let from = state.reference.map_or(position, |reference| reference.position);
        match mode {
            Mode::TetherHold => state.plan = Plan::stay(position),
            Mode::Land => {
                state.plan = self.config.planner.land(from);
                state.ground = GroundState::Landing;
            }
            Mode::Descent => state.ground = GroundState::Landing,
            Mode::Stabilize
            | Mode::Altitude
            | Mode::Takeoff
            | Mode::TautForce
            | Mode::TautAttitude
            | Mode::TetherAngle
            | Mode::Pendulum => {}
        }
    }

    fn stop_when_landed(&mut self, now: Micros, events: &mut EventQueue) {
        let state = &self.state;
        let Some(armed_at) = state.armed_at else {
            return;
        };
        if state.ground != GroundState::OnGround {
            return;
        }
        match state.landed_at {
            Some(at) if now.seconds_since(at) > self.params.disarm_delay => {
                self.disarm(Event::info("Landed, disarmed"), events);
                self.state.mode = Mode::TetherHold;
            }
            None if now.seconds_since(armed_at) > self.params.preflight_disarm => {
                self.disarm(Event::info("Disarmed: no take-off"), events);
            }
            _ => {}
        }
    }
}
