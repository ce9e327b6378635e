//! Who may change the mode or stop the motors: requests, and the failsafe table. Nothing else does.

use super::{Moment, Vehicle, context};
use crate::control::{PositionState, RadialControl};
use crate::math::so3;
use crate::mode::refusal::{self, NOT_BUILT};
use crate::mode::{Context, Entry, Exit, Refusal, denied, rejected};
use crate::param::broken;
use crate::scalar::Scalar;
use crate::signal::{Action, Aid, AidSet, CLOSED_THROTTLE, Event, EventQueue, Sensors};
use crate::supervisor::{
    ArmingCheck, ArmingFacts, FailsafeAction, FailsafeFacts, FailsafeState, Failure, GroundState,
    Rest, TouchDownState,
};
use crate::time::Micros;

/// A position filter proves itself over so long, µs, and not below this height over the ground, m: there it comes down.
const PROOF_US: u64 = 10_000_000;
const PROOF_HEIGHT: f64 = 2.0;

impl<S: Scalar> Vehicle<S> {
    fn arming_facts(&self, cx: &Context<'_, S>) -> ArmingFacts {
        let (estimate, p) = (&cx.situation.estimate, &self.params);
        let is_open = || cx.fresh_sticks().is_none_or(|s| s.throttle > CLOSED_THROTTLE);
        let pull = if self.config.constants.radial_control == RadialControl::Free {
            0.0
        } else {
            p.tension
        };
        let weight = p.mass * crate::math::GRAVITY as f32;
        ArmingFacts {
            outputs_suffice: self.state.actuation.throttle.len() <= self.outputs,
            rotor_is_lost: self.state.lost_rotor.is_some(),
            imu: cx.sensors.imu_health,
            mounting_is_known: self.config.sense.mounting_is_known(),
            is_levelled: estimate.is_levelled,
            felt: self.state.felt.force().to_f32(),
            gyro_bias: so3::norm(&estimate.gyro_bias.0).to_f32(),
            cos_tilt: estimate.attitude.cos_tilt().to_f32(),
            altitude_is_fresh: cx.sensors.altitude_is_fresh,
            tether_is_known: self.tether_is_known(cx.sensors),
            cell: cx.sensors.battery.map(|battery| battery.cell.to_f32()),
            cell_low: p.battery_low,
            link_is_up: self.link_is_up(cx.now) || self.radio_is_up(cx.now),
            throttle_is_open: (self.mode.mode().rule().needs.sticks || self.arms_by_radio())
                && is_open(),
            is_killed: self.is_killed(),
            hover_share: (weight + pull) / crate::model::thrust_max(p),
        }
    }

    /// Whether there is a position to fly by; on the way up on a slack link there is none yet.
    pub(super) fn has_place(&self) -> bool {
        // What is known of the place was known by the line.
        let is_believed = self.state.doubt.is_none() && !self.situation.estimate.tether_is_gone;
        self.situation.estimate.position.is_some() && is_believed && !self.mode.climbs_slack()
    }

    /// As the mode sees it that flies on the link; else as the estimator does.
    fn link_is_taut(&self, cx: &Context<'_, S>) -> bool {
        let kind = self.config.constants.kind;
        let estimated = || cx.situation.estimate.tether.is_none_or(|tether| tether.is_taut);
        self.mode.sees_pull(cx).unwrap_or_else(|| kind.is_rigid() || kind.is_free() || estimated())
    }

    fn tether_is_known(&self, sensors: &Sensors<S>) -> bool {
        let is_told = sensors.tether_is_fresh && !self.situation.estimate.length_is_stuck;
        is_told || self.config.constants.radial_control != RadialControl::Winch
    }

    /// Beyond the fence, if there is one.
    pub(super) fn is_outside(&self) -> bool {
        let (p, estimate) = (&self.params, &self.situation.estimate);
        p.has_fence() && {
            let place = estimate.position.map(|position| position.0.map(Scalar::to_f32));
            !p.is_inside_fence(place.unwrap_or_default(), estimate.height.to_f32())
        }
    }

    fn failsafe_facts(&self, cx: &Context<'_, S>) -> FailsafeFacts {
        let estimate = &cx.situation.estimate;
        let sticks_are_up = cx.fresh_sticks().is_some();
        FailsafeFacts {
            mode: self.mode.mode(),
            cos_tilt: estimate.attitude.cos_tilt().to_f32(),
            imu: cx.sensors.imu_health,
            has_diverged: self.state.doubt.is_some(),
            altitude_is_fresh: cx.sensors.altitude_is_fresh,
            is_taut: self.link_is_taut(cx),
            is_gone: estimate.tether_is_gone,
            line: self.state.line,
            rotor_is_lost: self.state.lost_rotor.is_some(),
            is_outside: self.is_outside(),
            has_capture: !self.config.constants.kind.is_free() || estimate.position.is_some(),
            tether_is_known: self.tether_is_known(cx.sensors),
            cell: cx.sensors.battery.map(|battery| battery.cell.to_f32()),
            link_silence_us: self.link_silence_us(cx.now),
            sticks_are_up,
            radio_is_lost: !sticks_are_up && self.obeys_radio() && self.radio_is_lost(cx.now),
        }
    }

    /// A filter that has diverged is believed again after it was well for a while, and high enough to be of use.
    fn doubt(&mut self, now: Micros) {
        let estimate = &self.situation.estimate;
        let over = estimate.height - self.config.touch_down.ground_height;
        let is_low = over < S::lit(PROOF_HEIGHT);
        let doubt = &mut self.state.doubt;
        *doubt = match *doubt {
            _ if estimate.has_diverged => Some(now),
            Some(_) if is_low => Some(now),
            Some(since) if now.since(since) < PROOF_US => Some(since),
            _ => None,
        };
        let is_doubted = doubt.is_some();
        self.situation.navigation.doubt(is_doubted);
    }

    pub(super) fn supervise(&mut self, at: Moment<'_, S>, events: &mut EventQueue) {
        self.doubt(at.now);
        let cx = self.context(at);
        let facts = self.failsafe_facts(&cx);
        if self.situation.armed_at.is_none() {
            let is_armable = ArmingCheck::first_failure(&self.arming_facts(&cx), false).is_none();
            self.state.is_armable = is_armable && self.state.is_consistent;
            self.state.failsafe = FailsafeState::default();
            self.state.doubt = None;
            return;
        }
        let (action, announced) =
            self.config.failsafes.step(&mut self.state.failsafe, &facts, at.now);
        if let Some(row) = announced {
            events.push(Event::critical(row.text));
        }
        if let Some(action) = action {
            self.react(action, announced.is_some(), at, events);
        }
        self.stop_when_landed(at, events);
    }

    /// A mode ended by itself: a failure like any other.
    pub(super) fn leave(&mut self, exit: Exit, at: Moment<'_, S>, events: &mut EventQueue) {
        events.push(Event::critical(exit.text));
        let action = self.config.failsafes.raise(&mut self.state.failsafe, exit.failure, at.now);
        self.react(action, true, at, events);
        // On the ground the table does nothing after a landing; the mode shall not fail again each step.
        let cx = context!(self, at);
        if !cx.is_in_air() && self.mode.mode().rule().rest == Rest::EndsWithMotors {
            self.mode.rest(&cx);
        }
    }

    fn react(
        &mut self,
        action: FailsafeAction,
        is_new: bool,
        at: Moment<'_, S>,
        events: &mut EventQueue,
    ) {
        if self.situation.setpoints.ground == GroundState::OnGround {
            // After a landing the motors stop by themselves.
            if action >= FailsafeAction::Land && self.state.landed_at.is_none() {
                self.disarm(Event::warning("Disarmed: failsafe on the ground"), at, events);
            }
            return;
        }
        let Some(mode) = action.mode() else {
            self.disarm(Event::critical("Motors stopped"), at, events);
            return;
        };
        // Landing needs a position; without one, level and down. In free flight a vehicle whose mode alone failed may
        // hover a while.
        let is_mode_alone = self.state.failsafe.in_force() == Failure::ModeFailed.mask();
        let hovers = is_mode_alone && self.config.constants.kind.is_free();
        let needs_place = mode.rule().needs.position && !hovers;
        let mode = if needs_place && !self.has_place() { FailsafeAction::LEVEL } else { mode };
        let present = self.mode.mode();
        // A pilot with sticks in hand may fly on, unless it is the joystick that failed.
        let is_manual = present.rule().needs.sticks;
        let (asked, flown) = (FailsafeAction::rank(mode), FailsafeAction::rank(present));
        if asked > flown && (is_new || !is_manual) {
            self.change_mode(&Entry::of(mode), at);
            self.state.failsafe.latch();
        } else if is_new && asked == 0 && flown == 0 {
            self.change_mode(&Entry::of(mode), at);
            // A hold knows this command.
            let _ = self.command(&Action::Pause, at);
        }
    }

    /// Into another mode, which may refuse, and what the estimators need for it. The modes of the failsafe
    /// table never refuse.
    fn enter(&mut self, entry: &Entry, at: Moment<'_, S>) -> Result<(), Refusal> {
        let cx = context!(self, at);
        let is_in_air = cx.is_in_air();
        self.mode.enter(entry, &cx)?;
        let taut = &mut self.situation.taut;
        taut.stop_out_of_plane();
        if let (Some(start), Some(config)) = (self.mode.out_of_plane(), &self.config.modes.taut) {
            config.estimator.start_out_of_plane(taut, start.azimuth, start.roll);
        }
        if is_in_air {
            self.situation.setpoints.ground =
                if entry.mode.lands() { GroundState::Landing } else { GroundState::InAir };
            self.state.contact_ramp = S::one();
        }
        Ok(())
    }

    fn change_mode(&mut self, entry: &Entry, at: Moment<'_, S>) {
        if entry.mode != self.mode.mode() {
            let is_entered = self.enter(entry, at).is_ok();
            debug_assert!(is_entered, "a mode of the failsafe table refused");
        }
    }

    /// The mode has done what it was asked.
    pub(super) fn complete(&mut self, events: &mut EventQueue) {
        if let Some(text) = self.mode.complete() {
            events.push(Event::info(text));
        }
    }

    /// A mode that somebody asks for.
    pub(super) fn request_mode(&mut self, entry: &Entry, at: Moment<'_, S>) -> Result<(), Refusal> {
        if !entry.mode.rule().is_built {
            return Err(NOT_BUILT);
        }
        let needs = entry.mode.rule().needs;
        let cx = context!(self, at);
        let takes_off = entry.mode.rule().takes_off;
        if needs.sticks && cx.fresh_sticks().is_none() {
            return Err(rejected("Mode refused: no sticks"));
        }
        if needs.position && !takes_off && !self.has_place() {
            return Err(rejected("Mode refused: no position estimate"));
        }
        if self.situation.armed_at.is_some() {
            let is_escape = needs.sticks || entry.mode == FailsafeAction::LEVEL;
            let lands = entry.mode.lands();
            // In the air a failure that has gone may be flown on; after the landing the motors stop first.
            let failsafe = &self.state.failsafe;
            let bits = if cx.is_in_air() { failsafe.in_force() } else { failsafe.active() };
            match self.config.failsafes.severest(bits) {
                Some(FailsafeAction::Land) if !lands && !is_escape => {
                    return Err(rejected("Mode refused: failsafe is landing"));
                }
                Some(FailsafeAction::Descend | FailsafeAction::Terminate) if !is_escape => {
                    return Err(rejected("Mode refused: failsafe is descending"));
                }
                _ => {}
            }
        }
        if !entry.mode.rule().on.contains(self.config.constants.kind) {
            return Err(refusal::needs_link(entry.mode.rule().on));
        }
        if entry.mode == self.mode.mode() && !takes_off {
            return Ok(());
        }
        self.enter(entry, at)?;
        self.state.failsafe.release();
        Ok(())
    }

    pub(super) fn arm(
        &mut self,
        force: bool,
        at: Moment<'_, S>,
        events: &mut EventQueue,
    ) -> Result<(), Refusal> {
        if self.situation.armed_at.is_some() {
            return Ok(());
        }
        let cx = context!(self, at);
        if let Some(check) = ArmingCheck::first_failure(&self.arming_facts(&cx), force) {
            return Err(rejected(check.text));
        }
        if let Some(rule) = broken(&self.params) {
            return Err(rejected(rule.text));
        }
        if self.mode.mode().lands() {
            self.mode.rest(&cx);
        }
        let has_compass = AidSet::from_parameter(self.params.aids).contains(Aid::Compass);
        if has_compass || self.config.constants.radial_control == RadialControl::Free {
            // As it was put down.
            let (.., yaw) = cx.situation.estimate.attitude.euler();
            self.mode.handover_mut().heading = yaw;
        }
        // Whatever the last flight left, however short ago.
        self.mode.handover_mut().position = PositionState::default();
        self.state.failsafe = FailsafeState::default();
        self.state.touch_down = TouchDownState::default();
        self.state.contact_ramp = S::one();
        self.situation.armed_at = Some(at.now);
        self.state.motor_test = None;
        self.forget_lost_radio(at.now);
        self.state.landed_at = None;
        self.situation.setpoints.ground = GroundState::OnGround;
        self.situation.setpoints.tension = self.config.constants.tension_low;
        events.push(Event::info("Armed"));
        Ok(())
    }

    /// The operator's last resort.
    pub(super) fn terminate(&mut self, at: Moment<'_, S>, events: &mut EventQueue) {
        if self.situation.armed_at.is_some() {
            self.disarm(Event::critical("Flight terminated: motors stopped"), at, events);
        }
    }

    pub(super) fn disarm_on_request(
        &mut self,
        force: bool,
        at: Moment<'_, S>,
        events: &mut EventQueue,
    ) -> Result<(), Refusal> {
        if self.context(at).is_in_air() && !force {
            return Err(denied("Disarm refused: in the air"));
        }
        if self.situation.armed_at.is_some() {
            self.disarm(Event::info("Disarmed"), at, events);
        }
        Ok(())
    }

    fn disarm(&mut self, event: Event, at: Moment<'_, S>, events: &mut EventQueue) {
        let cx = context!(self, at);
        if self.mode.mode().rule().rest == Rest::EndsWithMotors {
            self.mode.rest(&cx);
        }
        self.situation.taut.stop_out_of_plane();
        self.situation.armed_at = None;
        self.state.commander = None;
        self.situation.setpoints.ground = GroundState::OnGround;
        self.situation.setpoints.reference = None;
        events.push(event);
    }

    fn stop_when_landed(&mut self, at: Moment<'_, S>, events: &mut EventQueue) {
        let Some(armed_at) = self.situation.armed_at else {
            return;
        };
        if self.situation.setpoints.ground != GroundState::OnGround {
            return;
        }
        match self.state.landed_at {
            Some(landed) if at.now.seconds_since(landed) > self.params.disarm_delay => {
                self.disarm(Event::info("Landed, disarmed"), at, events);
                let cx = context!(self, at);
                self.mode.rest(&cx);
            }
            None if at.now.seconds_since(armed_at) > self.params.preflight_disarm => {
                self.disarm(Event::info("Disarmed: no take-off"), at, events);
            }
            _ => {}
        }
    }
}
