//! Rate loop, mixer and thrust map, at every inertial sample; and, disarmed, the test of one motor.

use super::Vehicle;
use crate::control::{RateSetpoint, RateState};
use crate::frames::{Body, V3, World};
use crate::math::so3;
use crate::mode::{Refusal, denied, rejected};
use crate::scalar::Scalar;
use crate::signal::{Actuation, Event, EventQueue, MixerReport, Sensors, WinchCommand, Wrench};
use crate::supervisor::GroundState;
use crate::time::{INNER_DT, Micros};

/// Of the last thrust, for the descent of a vehicle that no longer knows how it turns.
const BLIND_SHARE: f64 = 0.65;
/// Longest test of a motor, s.
const TEST_TIME: f32 = 10.0;
/// A vehicle that turns this fast, rad/s, has its propellers on.
const TEST_RATE: f64 = 0.5;

/// One motor turns, for a while.
#[derive(Clone, Copy, Debug)]
pub(super) struct MotorTest<S> {
    rotor: usize,
    throttle: S,
    until: Micros,
}

impl<S: Scalar> Vehicle<S> {
    /// Begins a test, or ends it.
    pub(super) fn test_motor(
        &mut self,
        (rotor, throttle, seconds): (usize, f32, f32),
        now: Micros,
        events: &mut EventQueue,
    ) -> Result<(), Refusal> {
        if self.situation.armed_at.is_some() {
            return Err(rejected("Motor test refused: armed"));
        }
        if rotor >= self.state.actuation.throttle.len() {
            return Err(denied("Motor test refused: no such motor"));
        }
        if !(0.0..=1.0).contains(&throttle) {
            return Err(denied("Motor test refused: throttle beyond 0..1"));
        }
        if !(0.0..=TEST_TIME).contains(&seconds) {
            return Err(denied("Motor test refused: longer than 10 s"));
        }
        if self.state.motor_test.is_none() && throttle > 0.0 {
            events.push(Event::warning("Motor test: keep propellers off"));
        }
        let until = Micros(now.0 + (seconds * 1e6) as u64);
        let test = MotorTest { rotor, throttle: S::from_f32(throttle), until };
        self.state.motor_test = Some(test).filter(|_| throttle > 0.0);
        Ok(())
    }

    /// The step of a test.
    fn turn_one(&mut self, now: Micros, events: &mut EventQueue) {
        let Some(test) = self.state.motor_test else { return };
        let turns = so3::norm(&self.situation.estimate.rate.0) > S::lit(TEST_RATE);
        if turns {
            events.push(Event::warning("Motor test stopped: the vehicle moves"));
        }
        if turns || now >= test.until {
            self.state.motor_test = None;
        } else if let Some(throttle) = self.state.actuation.throttle.get_mut(test.rotor) {
            *throttle = test.throttle;
        }
    }

    /// At every inertial sample.
    pub(super) fn actuate(&mut self, now: Micros, sensors: &Sensors<S>, events: &mut EventQueue) {
        let (state, situation) = (&mut self.state, &mut self.situation);
        let is_armed = situation.armed_at.is_some();
        state.actuation.is_armed = is_armed;
        state.actuation.winch = WinchCommand { tension: situation.setpoints.pull() };
        if !is_armed {
            state.actuation.thrusts.fill(S::zero());
            state.actuation.throttle.fill(S::zero());
            situation.mixer = MixerReport::default();
            state.wrench = Wrench { thrust: S::zero(), torque: Body(V3::zeros()) };
            state.rate = RateState::default();
            state.voltage = None;
            self.turn_one(now, events);
            return;
        }
        let shown = sensors.battery.map(|battery| battery.voltage);
        state.voltage = self.config.thrust_map.follow(state.voltage, shown);
        if situation.setpoints.ground == GroundState::OnGround {
            let idle = self.config.mixer.min;
            state.actuation.thrusts.fill(idle);
            state.rate = RateState::default();
        } else if sensors.imu.is_none() {
            // Blind: what the motors did, and less of it.
            if !core::mem::replace(&mut state.is_blind, true) {
                let share = S::lit(BLIND_SHARE);
                state.actuation.thrusts.iter_mut().for_each(|thrust| *thrust *= share);
            }
        } else if !sensors.imu_is_held {
            state.is_blind = false;
            let estimate = &situation.estimate;
            let pull = match (&estimate.tether, &estimate.position) {
                // The specific force is the thrust, which has no part across the body axis, and the pull.
                _ if self.mode.mode().flies_taut() => {
                    let force = situation.taut.estimate().map_or(V3::zeros(), |taut| taut.accel.0);
                    Body(V3::new(force.x, force.y, S::zero()) * self.config.constants.mass)
                }
                (Some(tether), Some(position))
                    if tether.is_taut && situation.navigation.is_airborne() =>
                {
                    let line = &self.config.constants.line;
                    let middle = tether.tension - line.growth(-position.0.z);
                    let mut towards = position.0 * (-middle / tether.length.max(S::lit(0.3)));
                    towards.z += line.half_weight(tether.length);
                    estimate.attitude.to_body(World(towards))
                }
                _ => Body(V3::zeros()),
            };
            let dt = S::lit(INNER_DT);
            let wanted = RateSetpoint::of(&situation.setpoints.attitude);
            let torque = self.config.rate.step(
                &mut state.rate,
                &wanted,
                &estimate.rate,
                &pull,
                situation.mixer,
                dt,
            );
            let thrust = situation.setpoints.attitude.thrust * state.contact_ramp
                / self.config.constants.thrust_scale;
            state.wrench = Wrench { thrust, torque };
            situation.mixer = self.config.mixer.step(&state.wrench, &mut state.actuation.thrusts);
        }
        let Actuation { thrusts, throttle, .. } = &mut state.actuation;
        self.config.thrust_map.throttles(thrusts, state.voltage, throttle);
    }
}
