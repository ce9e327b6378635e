//! The outer loop, 250 times a second: the mode's set-points, and coming to stand on the ground.

use super::{Moment, Vehicle, context};
use crate::control::{AttitudeCommand, DitherState, PositionState, RadialControl, RateState};
use crate::frames::{V3, World};
use crate::math::so3;
use crate::mode::{Notice, Smoothed};
use crate::navigation::CLEAR;
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::{Event, EventQueue, PositionSource};
use crate::supervisor::{GroundState, LineInput, RotorWatchState, TouchDownInput, TouchDownState};
use crate::time::OUTER_DT;

/// Low-pass of the estimate before the position loop, per step.
const SMOOTHING: f64 = 0.05;
/// On ground contact the thrust runs down in this time, s.
const CONTACT_RAMP: f64 = 0.4;

impl<S: Scalar> Vehicle<S> {
    pub(super) fn fly(&mut self, at: Moment<'_, S>, events: &mut EventQueue) {
        self.smooth();
        if self.situation.armed_at.is_none() {
            self.situation.setpoints.reference = None;
            self.situation.setpoints.attitude = AttitudeCommand::idle();
            self.mode.handover_mut().position = PositionState::default();
            self.state.contact_ramp = S::one();
            self.state.touch_down = TouchDownState::default();
            return;
        }
        self.move_tension();
        self.situation.has_place = self.has_place();
        let cx = context!(self, at);
        match self.mode.step(&cx) {
            Ok(setpoints) => {
                let was_on_ground = cx.ground() == GroundState::OnGround;
                if was_on_ground && setpoints.ground != GroundState::OnGround {
                    self.state.landed_at = None;
                }
                self.situation.setpoints = setpoints;
                if let Some(notice) = setpoints.notice {
                    self.note(notice, events);
                }
            }
            // One step on the last set-points; whatever the table says flies from the next one on.
            Err(exit) => self.leave(exit, at, events),
        }
        self.touch_down(at);
        self.watch_line();
        self.watch_rotors();
    }

    /// So far up that nothing but the air and the line touch it.
    fn is_clear(&self) -> bool {
        let ground = self.config.touch_down.ground_height;
        let is_over = self.situation.estimate.height > ground + S::lit(CLEAR);
        self.situation.navigation.is_airborne() && is_over
    }

    fn watch_line(&mut self) {
        let is_clear = self.is_clear();
        let (situation, state) = (&self.situation, &mut self.state);
        let is_on_winch = self.config.constants.radial_control == RadialControl::Winch;
        let flies = situation.setpoints.ground == GroundState::InAir && is_clear;
        let tether = situation.estimate.tether.filter(|t| t.is_taut && is_on_winch && flies);
        let reference = situation.setpoints.reference;
        let input = tether.zip(reference).map(|(tether, reference)| LineInput {
            tension: situation.estimate.pull.unwrap_or(tether.tension).max(tether.tension),
            asked: state.actuation.winch.tension,
            length: tether.length,
            wanted: so3::norm(&reference.position.0),
            wanted_rate: {
                let out = reference.position.0 / so3::norm(&reference.position.0).max(S::lit(0.1));
                so3::dot(&out, &reference.velocity.0)
            },
        });
        state.line = state.line_watch.step(input.as_ref(), S::lit(OUTER_DT));
    }

    fn watch_rotors(&mut self) {
        let Some(watch) = &self.config.rotor_watch else { return };
        // The ground turns a vehicle too.
        let flies = self.is_clear() && self.state.contact_ramp >= S::one();
        let (situation, state) = (&self.situation, &mut self.state);
        if !flies {
            state.rotor_watch = RotorWatchState::default();
            return;
        }
        let (rate, torque) = (&situation.estimate.rate, &state.wrench.torque);
        let found = watch.step(&mut state.rotor_watch, rate, torque, &state.actuation.thrusts);
        // The torque that is asked of a rotor taken for dead is missed on: one that was named wrongly is found after all.
        if let Some(rotor) = found.filter(|rotor| state.lost_rotor != Some(*rotor))
            && self.config.mixer.lose(rotor, &self.params)
        {
            state.lost_rotor = Some(rotor);
            state.rotor_watch = RotorWatchState::default();
            state.rate = RateState::default();
        }
    }

    fn note(&mut self, notice: Notice<S>, events: &mut EventQueue) {
        match notice {
            Notice::Complete => self.complete(events),
            Notice::Warning(text) => events.push(Event::warning(text)),
            Notice::ThrustRatio(ratio) => {
                let scale = self.params.thrust_scale * ratio.to_f32();
                self.params.thrust_scale = scale.clamp(0.5, 1.5);
                self.config.set_thrust_scale(self.params.thrust_scale);
                self.state.echo = Params::index_of(b"THR_SCALE");
                events.push(Event::info("Thrust calibrated in slack hover"));
            }
        }
    }

    /// The tension's movement begins with the filter that wants it.
    fn move_tension(&mut self) {
        let situation = &mut self.situation;
        if situation.estimate.source == PositionSource::FullState {
            self.config.dither.step(&mut situation.dither, S::lit(OUTER_DT));
        } else {
            situation.dither = DitherState::default();
        }
    }

    fn smooth(&mut self) {
        let is_doubtful = self.state.doubt.is_some();
        let situation = &mut self.situation;
        if let Some(velocity) = situation.estimate.velocity.filter(|_| !is_doubtful) {
            situation.navigation.follow(&velocity);
        }
        let estimate = &situation.estimate;
        let (Some(position), Some(velocity)) = (estimate.position, estimate.velocity) else {
            situation.smoothed = None;
            return;
        };
        let k = S::lit(SMOOTHING);
        let tension = estimate.tether.map_or(S::zero(), |tether| tether.tension);
        // The others are quiet enough as they are.
        let is_noisy = estimate.source == PositionSource::FourState;
        match &mut situation.smoothed {
            Some(s) if is_noisy && situation.navigation.is_airborne() => {
                s.position.0 += (position.0 - s.position.0) * k;
                s.velocity.0 += (velocity.0 - s.velocity.0) * k;
                s.tension += (tension - s.tension) * k;
            }
            slot => *slot = Some(Smoothed { position, velocity, tension }),
        }
    }

    fn touch_down(&mut self, at: Moment<'_, S>) {
        let (state, estimate) = (&mut self.state, &self.situation.estimate);
        let setpoints = &mut self.situation.setpoints;
        if !matches!(setpoints.ground, GroundState::InAir | GroundState::Landing) {
            return;
        }
        let wants_down = setpoints.wants_down;
        let input = TouchDownInput {
            wants_down,
            height: at.sensors.altitude_is_fresh.then_some(estimate.height),
            climb: estimate.climb,
            altitude_rate: at.sensors.altitude_is_fresh.then_some(estimate.altitude_rate),
            thrust: estimate.thrust,
            felt: at.sensors.accel_is_believed.then(|| state.felt.force()),
            turning: state.felt.turning(&estimate.gyro_bias),
            cos_tilt: estimate.attitude.cos_tilt(),
            left: state.contact_ramp,
        };
        let dt = S::lit(OUTER_DT);
        let contact = self.config.touch_down.step(&mut state.touch_down, &input, dt);
        // Once the ground is felt the thrust runs out, level: the ground's push is in no model, and a
        // position loop that believes it would hop. Only if nothing carries it, the thrust comes back.
        let is_settling = state.contact_ramp < S::one();
        if contact.falls || !wants_down {
            state.contact_ramp = S::one();
        } else if contact.touches || is_settling {
            state.contact_ramp = (state.contact_ramp - dt / S::lit(CONTACT_RAMP)).max(S::zero());
            let level = World(V3::new(S::zero(), S::zero(), -setpoints.attitude.thrust));
            let heading = self.mode.handover().heading;
            setpoints.attitude = self.config.attitude.step(&level, &estimate.attitude, heading);
        }
        if wants_down && contact.has_landed {
            setpoints.ground = GroundState::OnGround;
            state.landed_at = Some(at.now);
        }
    }
}
