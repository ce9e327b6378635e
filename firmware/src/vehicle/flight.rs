//! What each mode asks of the attitude loop, 250 times a second.

use super::slack_hover::SlackHover;
use super::{Smoothed, Vehicle};
use crate::control::{AttitudeCommand, Link, PositionInput, PositionState};
use crate::frames::{Attitude, V3, World};
use crate::math::so3;
use crate::scalar::Scalar;
use crate::signal::{Event, EventQueue, FlightReference, Sensors, Sticks};
use crate::supervisor::{GroundState, Mode, TouchDownInput, TouchDownState};
use crate::time::{Micros, OUTER_DT};
use crate::trajectory::direction_of;

/// Low-pass of the estimate before the position loop, per step.
const SMOOTHING: f64 = 0.05;
/// Slew of the tension set-point, N/s.
const TENSION_RISE: f64 = 3.0;
const TENSION_FALL: f64 = 2.0;
/// Thrust at which the ramp on the ground begins, N.
const SPOOL_START: f64 = 3.0;
/// Time after the ramp in which the vehicle must have left the ground, s.
const SPOOL_GRACE: f64 = 2.0;
/// On ground contact the thrust runs down in this time, s, unless the vehicle rises this high, m.
const CONTACT_RAMP: f64 = 0.4;
const SETTLE_HEIGHT: f64 = 0.3;

impl<S: Scalar> Vehicle<S> {
    pub(super) fn fly(&mut self, sensors: &Sensors<S>, now: Micros, events: &mut EventQueue) {
        self.smooth();
        if self.state.armed_at.is_none() {
            self.state.reference = None;
            self.state.position = PositionState::default();
            self.state.contact_ramp = S::one();
            self.state.touch_down = TouchDownState::default();
            self.state.attitude = AttitudeCommand::idle();
            return;
        }
        self.slew_tension();
        match self.state.mode {
            Mode::Takeoff if self.state.ground != GroundState::InAir => self.take_off(events),
            Mode::Takeoff | Mode::TetherHold | Mode::Land => self.fly_position(events),
            Mode::Stabilize => self.fly_sticks(now, false),
            Mode::Altitude => self.fly_sticks(now, true),
            Mode::TautForce | Mode::TautAttitude => self.fly_taut(sensors, events),
            Mode::TetherAngle => self.fly_angle(events),
            Mode::Pendulum => self.fly_pendulum(now, events),
            Mode::Descent => self.descend(),
        }
        self.touch_down(sensors, now);
    }

    fn smooth(&mut self) {
        let estimate = &self.state.estimate;
        let (Some(position), Some(velocity)) = (estimate.position, estimate.velocity) else {
            self.state.smoothed = None;
            return;
        };
        let k = S::lit(SMOOTHING);
        let tension = estimate.tether.map_or(S::zero(), |tether| tether.tension);
        // Motion capture is quiet enough as it is.
        let is_noisy = self.config.link != Link::Free;
        match &mut self.state.smoothed {
            Some(s) if is_noisy && self.state.estimator.is_airborne() => {
                s.position.0 += (position.0 - s.position.0) * k;
                s.velocity.0 += (velocity.0 - s.velocity.0) * k;
                s.tension += (tension - s.tension) * k;
            }
            slot => *slot = Some(Smoothed { position, velocity, tension }),
        }
    }

    /// The winch pulls gently near the anchor; a fixed length starts from its floor when slack.
    fn slew_tension(&mut self) {
        let is_far_out = self.is_far_out();
        let state = &mut self.state;
        if self.config.link == Link::Free {
            state.tension = S::zero();
            return;
        }
        let is_slack = state.estimate.tether.is_none_or(|t| !t.is_taut);
        let target = match self.config.link {
            Link::FixedLength
                if is_slack || state.ground != GroundState::InAir && state.mode != Mode::Land =>
            {
                state.tension = self.config.tension_floor;
                state.tension
            }
            Link::FixedLength if state.mode == Mode::Land && state.plan.is_last_leg() => {
                self.config.tension_floor
            }
            Link::Winch if !is_far_out => self.config.tension_low,
            _ => state.tension_target,
        };
        let dt = S::lit(OUTER_DT);
        let step =
            (target - state.tension).limit(-S::lit(TENSION_FALL) * dt, S::lit(TENSION_RISE) * dt);
        state.tension += step;
    }

    /// On the outward leg or holding: where the full tension is wanted.
    fn is_far_out(&self) -> bool {
        let state = &self.state;
        match state.mode {
            Mode::Takeoff => state.ground == GroundState::InAir && state.plan.is_last_leg(),
            Mode::Land => state.estimate.tether.is_some_and(|t| t.length > S::lit(4.0)),
            Mode::Descent => false,
            _ => state.ground == GroundState::InAir,
        }
    }

    /// Ramp the thrust up, level, until the estimator sees the vehicle leave the ground.
    fn take_off(&mut self, events: &mut EventQueue) {
        let altitude = self.state.takeoff_altitude.unwrap_or(self.params.takeoff_altitude);
        let target = self.takeoff_point(altitude);
        let dt = S::lit(OUTER_DT);
        let state = &mut self.state;
        if state.ground == GroundState::OnGround {
            state.ground = GroundState::TakingOff;
            state.spool = S::zero();
            state.position = PositionState::default();
            state.landed_at = None;
            state.slack_hover = self.config.slack_hover.map(|block| SlackHover::start(&block));
        }
        if self.hover_slack(events) {
            return;
        }
        let state = &mut self.state;
        let (true, Some(position), Some(target)) =
            (state.estimator.is_airborne(), state.estimate.position, target)
        else {
            state.spool += dt;
            let full = self.config.weight * S::from_f32(self.params.spool_thrust) + state.tension;
            let share = state.spool / S::from_f32(self.params.spool_time);
            let start = S::lit(SPOOL_START).min(self.config.weight * S::lit(0.5));
            let thrust = start + (full - start) * share.min(S::one());
            let up = World(V3::new(S::zero(), S::zero(), -thrust));
            state.attitude = self.config.attitude.step(&up, &state.estimate.attitude, state.yaw);
            if share * S::from_f32(self.params.spool_time)
                > S::from_f32(self.params.spool_time) + S::lit(SPOOL_GRACE)
            {
                self.disarm(Event::critical("Take-off failed: no lift-off"), events);
            }
            return;
        };
        state.plan = self.config.planner.takeoff(position, target);
        state.ground = GroundState::InAir;
        self.fly_position(events);
    }

    pub(super) fn fly_position(&mut self, events: &mut EventQueue) {
        let dt = S::lit(OUTER_DT);
        if self.state.ground == GroundState::OnGround {
            return;
        }
        let Some(smoothed) = self.state.smoothed else {
            // The failsafe table ends it: at once on a tether, after a while without motion capture.
            match self.config.link {
                Link::Free => self.hover_level(),
                Link::Winch | Link::FixedLength => self.descend(),
            }
            return;
        };
        let state = &mut self.state;
        let (position, velocity) = state.plan.step(dt);
        let tension = state.tension;
        state.reference = Some(FlightReference { position, velocity, yaw: state.yaw, tension });
        if state.mode == Mode::Takeoff && state.plan.is_done() {
            state.mode = Mode::TetherHold;
            events.push(Event::info("Take-off complete, holding"));
        }
        let (direction, length) = direction_of(&position);
        let length_rate = so3::dot(&direction.0, &velocity.0);
        let is_taut = state.estimate.tether.is_none_or(|t| t.is_taut);
        let mut input = PositionInput {
            position: smoothed.position,
            velocity: smoothed.velocity,
            wind: World(V3::zeros()),
            direction,
            reference_velocity: velocity,
            length,
            length_rate,
            tension,
            link: self.config.link,
            hold_integral: state.mixer.thrust_is_saturated || state.mixer.tilt_is_saturated,
        };
        match self.config.link {
            Link::Winch => {
                input.tension = (tension + smoothed.tension.max(S::zero())) * S::lit(0.5);
            }
            Link::FixedLength if !is_taut => {
                // Slack: out gently; far inside the sphere by position alone.
                let tether = self.config.tether_length;
                let distance = so3::norm(&smoothed.position.0);
                if distance >= tether * S::lit(0.85) {
                    input.length_rate = S::lit(0.3);
                } else {
                    input.link = Link::Winch;
                    input.tension = S::zero();
                    input.length = distance;
                    input.length_rate = S::lit(0.4);
                }
            }
            Link::FixedLength | Link::Free => {}
        }
        let asked = self.config.position.step(&mut state.position, &input, dt);
        state.attitude =
            self.config.attitude.step(&asked.force, &state.estimate.attitude, state.yaw);
    }

    fn fly_sticks(&mut self, now: Micros, holds_climb: bool) {
        let sticks = match self.state.sticks {
            Some(sample) if self.sticks_are_up(now) => sample.value,
            _ => Sticks { throttle: 0.5, ..Sticks::default() },
        };
        let p = &self.params;
        let state = &mut self.state;
        state.reference = None;
        let wants_up = if holds_climb { sticks.throttle > 0.6 } else { sticks.throttle > 0.1 };
        if state.ground == GroundState::OnGround {
            if !wants_up {
                return;
            }
            state.ground = GroundState::InAir;
            state.landed_at = None;
        }
        let thrust = if holds_climb {
            let wanted = S::from_f32((sticks.throttle - 0.5) * 2.0 * p.stick_climb_rate);
            self.config.climb.step(&mut state.climb, wanted, state.estimate.climb, S::lit(OUTER_DT))
        } else {
            S::from_f32(sticks.throttle.clamp(0.0, 1.0) * p.thrust_max)
        };
        let (_, _, yaw) = state.estimate.attitude.euler();
        let tilt = p.stick_tilt_max;
        let asked = Attitude::from_euler(
            S::from_f32(sticks.roll * tilt),
            S::from_f32(-sticks.pitch * tilt),
            yaw,
        );
        let axis = so3::col_z(&asked.0);
        let mut command =
            self.config.attitude.step(&World(-axis * thrust), &state.estimate.attitude, yaw);
        // With climb control the vertical share counts, within the tilt that divides well.
        if holds_climb {
            command.thrust = thrust / state.estimate.attitude.cos_tilt().max(S::lit(0.5));
        }
        command.rate.0.z = S::from_f32(sticks.yaw * p.stick_yaw_rate);
        state.attitude = command;
        state.yaw = yaw;
    }

    /// Level, at the height of the moment, by altimeter and inertia.
    fn hover_level(&mut self) {
        self.fly_level(S::zero());
    }

    /// Level, sinking at the landing speed. Uses neither position nor tether.
    fn descend(&mut self) {
        let low = self.config.touch_down.ground_height + S::lit(1.0);
        let near_ground = self.state.estimate.height < low;
        let sink = if near_ground { self.params.land_speed } else { self.params.descend_speed };
        self.fly_level(-S::from_f32(sink));
    }

    /// Level, at a climb rate, m/s.
    fn fly_level(&mut self, climb: S) {
        let state = &mut self.state;
        state.reference = None;
        if state.ground == GroundState::OnGround {
            return;
        }
        let up =
            self.config.climb.step(&mut state.climb, climb, state.estimate.climb, S::lit(OUTER_DT));
        let force = World(V3::new(S::zero(), S::zero(), -up));
        let mut command = self.config.attitude.step(&force, &state.estimate.attitude, state.yaw);
        command.thrust = up / state.estimate.attitude.cos_tilt().max(S::lit(0.5));
        state.attitude = command;
    }

    fn touch_down(&mut self, sensors: &Sensors<S>, now: Micros) {
        let state = &mut self.state;
        if !matches!(state.ground, GroundState::InAir | GroundState::Landing) {
            return;
        }
        let reference_is_low = state
            .reference
            .is_some_and(|r| -r.position.0.z < self.config.touch_down.ground_height + S::lit(0.1));
        let throttle = state.sticks.map_or(0.5, |s| s.value.throttle);
        let wants_down = match state.mode {
            Mode::Land => reference_is_low,
            Mode::Descent => true,
            Mode::Stabilize | Mode::Altitude => throttle < 0.05,
            Mode::TetherHold
            | Mode::Takeoff
            | Mode::TautForce
            | Mode::TautAttitude
            | Mode::TetherAngle
            | Mode::Pendulum => false,
        };
        let input = TouchDownInput {
            wants_down,
            height: sensors.altitude_is_fresh.then_some(state.estimate.height),
            climb: state.estimate.climb,
            thrust: state.estimate.thrust,
            specific_force: state.specific_force,
        };
        let dt = S::lit(OUTER_DT);
        let contact = self.config.touch_down.step(&mut state.touch_down, &input, dt);
        // Once the ground is felt the thrust runs out, level: the ground's push is in no model, and a
        // position loop that believes it would hop. Only a clear rise ends that.
        let has_risen = input
            .height
            .is_some_and(|h| h > self.config.touch_down.ground_height + S::lit(SETTLE_HEIGHT));
        let is_settling = state.contact_ramp < S::one();
        if has_risen || !wants_down {
            state.contact_ramp = S::one();
        } else if contact.touches || is_settling {
            state.contact_ramp = (state.contact_ramp - dt / S::lit(CONTACT_RAMP)).max(S::zero());
            let level = World(V3::new(S::zero(), S::zero(), -state.attitude.thrust));
            state.attitude = self.config.attitude.step(&level, &state.estimate.attitude, state.yaw);
        }
        if wants_down && contact.has_landed {
            state.ground = GroundState::OnGround;
            state.landed_at = Some(now);
        }
    }
}
