//! Whether the line pulls, and what follows for the filter.

use super::super::slackness::SlacknessState;
use super::answer::Answer;
use super::slack::Along;
use super::{FullFlight, FullFlightState, Intent};
use crate::estimate::full_state::{POSITION, VELOCITY};
use crate::estimate::{Fault, MahonyState};
use crate::frames::V3;
use crate::math::{GRAVITY, so3};
use crate::scalar::Scalar;

/// Slack: no pull, N; not beyond the line's end, m, and how far beyond is too far.
const SLACK_TENSION_SD: f64 = 0.5;
const SLACK_LENGTH_SD: f64 = 0.3;
const BEYOND: f64 = 0.1;
/// No cable pushes: an estimate below this, N, is wrong.
const PUSH: f64 = -0.5;
/// A line shorter than this, m, is not missed.
const ANSWER_LENGTH: f64 = 3.0;
/// What a line that becomes slack leaves unknown: place, m, and velocity, m/s.
const RELEASE_SD: f64 = 0.2;

/// Share of a step of the pull that is felt: a fifth of a second.
const PULL_SHARE: f64 = 0.02;

impl<S: Scalar> FullFlight<S> {
    /// Third part: whether the line pulls.
    pub fn judge(&self, flying: &mut FullFlightState<S>, intent: &Intent<S>, sit: &MahonyState<S>) {
        let done = self.try_judge(flying, intent, sit);
        flying.has_failed |= done.is_err();
    }

    fn try_judge(
        &self,
        flying: &mut FullFlightState<S>,
        intent: &Intent<S>,
        sit: &MahonyState<S>,
    ) -> Result<(), Fault> {
        let along = self.along(flying, sit);
        self.feel_pull(flying);
        // A line that hangs in a curve yields before it answers; a fixed one is moved by the vehicle, as far as it can; near
        // the anchor a small error of the place is a large one of the direction.
        let is_sure =
            self.is_straight && self.fixed_line.is_none() && along.distance > S::lit(ANSWER_LENGTH);
        let is_silent = flying.answer.step(intent.tension, intent.dither, along.felt) && is_sure;
        if is_silent {
            flying.is_gone = true;
            flying.answer = Answer::new();
            flying.line.slackness = SlacknessState::SLACK;
        }
        if let Some(line) = &self.fixed_line
            && line.step(&mut flying.line, &along)
        {
            self.release(flying, &along);
        }
        flying.is_gone |= flying.line.is_beyond();
        flying.load.is_taut = flying.line.slackness.is_taut;
        let FullFlightState { state, load, .. } = flying;
        match &self.fixed_line {
            Some(_) if load.is_taut => {}
            Some(line) => {
                if line.is_inside(along.distance) || along.tension < S::lit(PUSH) {
                    self.filter.chord_tension(state, S::zero(), S::lit(SLACK_TENSION_SD))?;
                }
                if along.distance > line.length + S::lit(BEYOND) && !flying.is_gone {
                    self.filter.distance(state, line.length, S::lit(SLACK_LENGTH_SD))?;
                }
            }
            None if load.is_taut => {}
            None => {
                self.filter.chord_tension(state, S::zero(), S::lit(SLACK_TENSION_SD))?;
            }
        }
        Ok(())
    }

    /// What pulls along the line by accelerometer and thrust model alone: a filter that expects the winch to do what it
    /// is asked sees in more of it weak rotors.
    fn feel_pull(&self, flying: &mut FullFlightState<S>) {
        let (model, state) = (&self.filter.model, &flying.state);
        let lift = V3::new(S::zero(), S::zero(), flying.load.thrust);
        let felt = state.attitude.0 * ((flying.reading - state.accel_bias) * model.mass + lift);
        let pull = -so3::dot(&model.direction(state), &felt);
        flying.pull += (pull - flying.pull) * S::lit(PULL_SHARE);
    }

    /// What the filter and the accelerometer say along the line.
    fn along(&self, flying: &FullFlightState<S>, sit: &MahonyState<S>) -> Along<S> {
        let (model, state) = (&self.filter.model, &flying.state);
        let (u, distance) = (model.direction(state), model.distance(state));
        let own = flying.reading - state.accel_bias;
        let force = state.attitude.0 * own;
        let lift = so3::col_z(&state.attitude.0) * (state.thrust_scale * flying.load.thrust);
        let felt = force * model.mass + lift;
        let speed = so3::dot(&u, &state.velocity);
        let across = so3::dot(&state.velocity, &state.velocity) - speed * speed;
        Along {
            distance,
            speed,
            accel: so3::dot(&u, &(sit.attitude.0 * own))
                + u.z * S::lit(GRAVITY)
                + across / distance,
            tension: state.tension,
            felt: -so3::dot(&u, &felt),
            wind: -so3::dot(&u, &state.wind) * model.mass,
        }
    }

    /// The line has become slack: its pull was the wind's, and the speed along it is what the accelerometer shows.
    fn release(&self, flying: &mut FullFlightState<S>, along: &Along<S>) {
        let u = self.filter.model.direction(&flying.state);
        let state = &mut flying.state;
        state.wind -= u * (state.tension / self.filter.model.mass);
        state.tension = S::zero();
        state.velocity += u * (flying.line.drift - along.speed);
        let unknown = V3::repeat(S::lit(RELEASE_SD * RELEASE_SD));
        state.covariance.inflate(POSITION, &unknown);
        state.covariance.inflate(VELOCITY, &unknown);
    }
}
