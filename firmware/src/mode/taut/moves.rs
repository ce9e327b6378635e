//! A smooth move on a taut link, from a command.

use super::{Candidate, TautConfig, TautLink, second};
use crate::mode::{Context, Refusal, denied, rejected};
use crate::scalar::Scalar;
use crate::signal::{Action, TautPurpose};
use crate::trajectory::TautPlan;

/// A stated start may be this far from the estimate: rad; N, or rad of pitch.
const START_ELEVATION: f64 = 0.2;
const START_FORCE: f64 = 2.0;
const START_PITCH: f64 = 0.15;
/// Set-points closer than this are the same.
const SAME: f64 = 1e-3;
/// Shortest and longest move, s.
const SHORTEST: f64 = 0.5;
const LONGEST: f64 = 600.0;
/// Shortest automatic move, s; automatic change of link force, N/s, and of pitch, s per rad.
const AUTOMATIC_SHORTEST: f64 = 3.0;
const FORCE_RATE: f64 = 1.0;
const PITCH_TIME: f64 = 10.0;
/// Automatic duration where the link force changes its sign, s.
const CROSSING: f64 = 1.5;
/// Peak over mean speed of a move, with a margin.
const PEAK: f64 = 2.5;

/// From and to of each output; `None` for where the reference is or stays.
#[derive(Clone, Copy, Debug)]
struct Wanted {
    elevation: [Option<f32>; 2],
    force: [Option<f32>; 2],
    pitch: [Option<f32>; 2],
    duration: Option<f32>,
}

impl Wanted {
    /// Of a place only the elevation counts where the length is given and the azimuth held.
    fn of<S: Scalar>(action: &Action, cx: &Context<'_, S>) -> Result<Self, Refusal> {
        let none = [None; 2];
        match *action {
            Action::MoveTaut { elevation, force, pitch, duration } => {
                Ok(Self { elevation, force, pitch, duration })
            }
            Action::MoveTether { elevation, tension, .. } => Ok(Self {
                elevation: [None, elevation],
                force: [None, tension],
                pitch: none,
                duration: None,
            }),
            Action::MoveTo { ned: [_, _, down], .. } => {
                let down = down.ok_or(denied("Move refused: needs an altitude"))?;
                let sin = -down / cx.params.tether_length;
                if sin.is_nan() || sin.abs() >= 1.0 {
                    return Err(denied("Move refused: altitude beyond the tether"));
                }
                let elevation = [None, Some(libm::asinf(sin))];
                Ok(Self { elevation, force: none, pitch: none, duration: None })
            }
            _ => Err(crate::mode::refusal::not_here(action)),
        }
    }
}

impl<S: Scalar> TautLink<S> {
    /// Takes up a move; whether vehicle and link can follow it is answered by [`Self::look`].
    pub(super) fn go(&mut self, action: &Action, cx: &Context<'_, S>) -> Result<(), Refusal> {
        let Wanted { elevation, force, pitch, duration } = Wanted::of(action, cx)?;
        let Some(taut) = &cx.config.modes.taut else {
            return Err(rejected("Move refused: not in a taut-link mode"));
        };
        let (wanted, other, tolerance) = match self.purpose {
            TautPurpose::Force => (force, pitch, START_FORCE),
            TautPurpose::Attitude => (pitch, force, START_PITCH),
        };
        if other.iter().any(Option::is_some) {
            return Err(denied("Move refused: not an output of this mode"));
        }
        if !self.plan.is_done() || self.candidate.is_some() {
            return Err(rejected("Move refused: the last move is still flown"));
        }
        let at = self.plan.now();
        let ([phi, ..], [y, ..]) = (at.elevation, at.second);
        let pick = |x: Option<f32>, or: S| x.map_or(or, S::from_f32);
        let [from, to] = elevation.map(|x| pick(x, phi));
        let [second_from, second_to] = wanted.map(|x| pick(x, y));
        let now = cx.situation.taut.estimate();
        let is_near = |stated: S, seen: S, most: f64| (stated - seen).abs() <= S::lit(most);
        let is_here = now.is_some_and(|now| {
            is_near(from, now.planar.elevation - self.correction, START_ELEVATION)
                && is_near(second_from, second(self.purpose, now), tolerance)
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
            || self.automatic_time(taut, [from, to], [second_from, second_to], cx),
            S::from_f32,
        );
        let plan = TautPlan::go(self.purpose, [from, to], [second_from, second_to], duration)
            .filter(|_| duration >= S::lit(SHORTEST) && duration <= S::lit(LONGEST))
            .ok_or(denied("Move refused: duration out of range"))?;
        self.candidate = Some(Candidate { plan, checked: 0 });
        Ok(())
    }

    /// Looks at one more point of the move that was asked for; an answer after the last.
    pub(super) fn look(&mut self, cx: &Context<'_, S>) -> Option<Result<(), Refusal>> {
        let candidate = self.candidate.as_mut()?;
        let Some(taut) = &cx.config.modes.taut else {
            self.candidate = None;
            return Some(Err(rejected("Move refused: not in a taut-link mode")));
        };
        if let Err(text) = candidate.plan.check(candidate.checked, &taut.bounds) {
            self.candidate = None;
            return Some(Err(denied(text)));
        }
        candidate.checked += 1;
        if candidate.checked < TautPlan::<S>::CHECKS {
            return None;
        }
        self.plan = candidate.plan;
        self.candidate = None;
        Some(Ok(()))
    }

    /// Time that keeps the cruise speed along the sphere and a gentle change of force.
    fn automatic_time(
        &self,
        taut: &TautConfig<S>,
        [from, to]: [S; 2],
        [y_from, y_to]: [S; 2],
        cx: &Context<'_, S>,
    ) -> S {
        let way = (to - from).abs() * cx.config.constants.tether_length;
        let by_speed = S::lit(PEAK) * way / taut.cruise.max(S::lit(0.1));
        let change = (y_to - y_from).abs();
        let by_second = match self.purpose {
            TautPurpose::Force if (y_from > S::zero()) != (y_to > S::zero()) => {
                return S::lit(CROSSING);
            }
            TautPurpose::Force => change / S::lit(FORCE_RATE),
            TautPurpose::Attitude => change * S::lit(PITCH_TIME),
        };
        by_speed.max(by_second).max(S::lit(AUTOMATIC_SHORTEST))
    }
}
