//! Takeoff: thrust up on the ground, level, until the estimator sees the vehicle leave it; then along a plan.

mod slack_hover;

pub(crate) use slack_hover::SlackHoverPlan;

use super::context::leaning;
use super::{
    Context, Entry, Exit, FlightMode, Handover, Notice, Refusal, Setpoints, denied, feasible, plan,
    rejected,
};
use crate::control::{PositionState, RadialControl};
use crate::frames::{V3, World};
use crate::math::so3;
use crate::scalar::Scalar;
use crate::signal::SphericalPoint;
use crate::supervisor::{Failure, GroundState};
use crate::time::OUTER_DT;
use slack_hover::SlackHover;

/// Thrust at which the ramp on the ground begins, N.
const SPOOL_START: f64 = 3.0;
/// Time after the ramp in which the vehicle must have left the ground, s.
const SPOOL_GRACE: f64 = 2.0;
/// Damping of a vehicle that slides before lift-off, 1/s, and the tangent of the largest lean for it.
const SLIDE_DAMPING: f64 = 6.0;
const SLIDE_LEAN: f64 = 0.3;

/// From this share of the hover's thrust on the battery's drop is looked at; it is too much for so long, s.
const SAG_FROM: f64 = 0.5;
const SAG_TIME: f64 = 0.1;

/// A vehicle that turns by so much (tangent of 35 degrees) lower than this over the ground, m, has a rotor too few.
const TURNED: f64 = 0.7;
const TURNED_LOW: f64 = 0.2;

/// What moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Takeoff<S: Scalar> {
    /// m over the anchor; the parameter's if nobody gave one.
    altitude: Option<f32>,
    /// Where the nose pointed when the thrust began to rise, world axes.
    nose: Option<V3<S>>,
    /// Time in the thrust ramp on the ground, s.
    spool: S,
    /// Volts per cell at rest, and how long they would have been too low in a hover, s.
    rested: Option<S>,
    sagging: S,
    /// Under way; `None` once done.
    slack: Option<SlackHover<S>>,
}

impl<S: Scalar> FlightMode<S> for Takeoff<S> {
    fn enter(
        entry: &Entry,
        handover: &mut Handover<S>,
        cx: &Context<'_, S>,
    ) -> Result<Self, Refusal> {
        if cx.is_in_air() {
            return Err(denied("Take-off refused: already in the air"));
        }
        if cx.situation.estimate.position.is_none() {
            return Err(rejected("Take-off refused: no position estimate"));
        }
        let takeoff = Self {
            altitude: entry.altitude,
            nose: None,
            spool: S::zero(),
            rested: None,
            sagging: S::zero(),
            slack: None,
        };
        let target =
            takeoff.target(cx).ok_or(denied("Take-off refused: altitude beyond the tether"))?;
        feasible::check(&feasible::TAKEOFF, &target.to_f32(), handover.tension.to_f32(), cx)?;
        Ok(takeoff)
    }

    fn step(
        &mut self,
        handover: &mut Handover<S>,
        cx: &Context<'_, S>,
    ) -> Result<Setpoints<S>, Exit> {
        let is_in_air = cx.ground() == GroundState::InAir;
        if self.turns(cx) {
            let text = "Take-off failed: it turns, check the rotors";
            return Err(Exit { failure: Failure::NoLiftOff, text });
        }
        let is_far_out = is_in_air && handover.plan.is_last_leg();
        let tension = cx.tension(handover, is_far_out, cx.fixed_pull());
        if is_in_air {
            Ok(self.fly(handover, tension, cx))
        } else {
            self.lift(handover, tension, cx)
        }
    }

    fn sees_pull(&self, cx: &Context<'_, S>) -> Option<bool> {
        // From inside the sphere of a fixed link it is slack until it gets there.
        cx.config.modes.slack_hover.as_ref().map(|_| true)
    }

    fn climbs_slack(&self) -> bool {
        self.slack.is_some()
    }
}

impl<S: Scalar> Takeoff<S> {
    fn fly(&mut self, handover: &mut Handover<S>, tension: S, cx: &Context<'_, S>) -> Setpoints<S> {
        let asked = plan::fly(handover, tension, cx);
        let is_done = asked.reference.is_some() && handover.plan.is_done();
        Setpoints { notice: is_done.then_some(Notice::Complete), ..asked }
    }

    /// Ramps the thrust up until the vehicle has left the ground.
    fn lift(
        &mut self,
        handover: &mut Handover<S>,
        tension: S,
        cx: &Context<'_, S>,
    ) -> Result<Setpoints<S>, Exit> {
        let situation = cx.situation;
        if cx.ground() == GroundState::OnGround {
            // Parameters may have changed since it was asked for.
            if situation.estimate.position.is_some() && self.target(cx).is_none() {
                let text = "Take-off failed: altitude beyond the tether";
                return Err(Exit { failure: Failure::NoLiftOff, text });
            }
            self.nose = Some(so3::col_x(&situation.estimate.attitude.0));
            self.spool = S::zero();
            self.sagging = S::zero();
            self.rested = cell_voltage(cx);
            self.slack = cx.config.modes.slack_hover.as_ref().map(|block| SlackHover::start(block));
            handover.position = PositionState::default();
        }
        let ground = GroundState::TakingOff;
        if let Some(asked) = self.hover_slack(handover, tension, cx)? {
            return Ok(Setpoints { ground, ..asked });
        }
        if situation.navigation.is_airborne() {
            let (Some(position), Some(target)) = (situation.estimate.position, self.target(cx))
            else {
                return Err(Exit {
                    failure: if cx.config.constants.kind.is_free() {
                        Failure::CaptureLost
                    } else {
                        Failure::EstimatorDiverged
                    },
                    text: "Take-off failed: no place to fly to",
                });
            };
            handover.plan = cx.config.planner.takeoff(position, target);
            return Ok(Setpoints { ground: GroundState::InAir, ..self.fly(handover, tension, cx) });
        }
        let (p, weight) = (cx.params, cx.config.constants.weight);
        self.spool += S::lit(OUTER_DT);
        let time = S::from_f32(p.spool_time);
        if self.spool > time + S::lit(SPOOL_GRACE) {
            return Err(Exit { failure: Failure::NoLiftOff, text: "Take-off failed: no lift-off" });
        }
        let full = weight * S::from_f32(p.spool_thrust) + tension;
        let start = S::lit(SPOOL_START).min(weight * S::lit(0.5));
        let thrust = start + (full - start) * (self.spool / time).min(S::one());
        if self.sags(thrust / full, cx) {
            let text = "Take-off refused: battery sags under load";
            return Err(Exit { failure: Failure::NoLiftOff, text });
        }
        // Light on its feet it slides in the wind: lean against that.
        let damping = -S::lit(SLIDE_DAMPING) * cx.config.constants.mass;
        let side = situation.navigation.sliding().0 * damping;
        let force = leaning(thrust, &side, S::lit(SLIDE_LEAN));
        let attitude = cx.thrust(force, handover.heading);
        Ok(Setpoints { attitude, ground, ..cx.unchanged(tension) })
    }

    /// Whether it turns about its feet.
    fn turns(&self, cx: &Context<'_, S>) -> bool {
        let estimate = &cx.situation.estimate;
        let is_low = estimate.height < cx.config.touch_down.ground_height + S::lit(TURNED_LOW);
        let Some(from) = self.nose.filter(|_| is_low) else { return false };
        let to = so3::col_x(&estimate.attitude.0);
        let (along, across) = (from.x * to.x + from.y * to.y, from.x * to.y - from.y * to.x);
        across.abs() > along * S::lit(TURNED)
    }

    /// Whether the battery would be low in a hover: the drop so far, by the current that goes with the thrust.
    fn sags(&mut self, share: S, cx: &Context<'_, S>) -> bool {
        let (Some(rested), Some(cell)) = (self.rested, cell_voltage(cx)) else { return false };
        if share < S::lit(SAG_FROM) {
            return false;
        }
        let hovering = rested - (rested - cell) / (share * share.sqrt());
        let is_low = hovering < S::from_f32(cx.params.battery_low);
        self.sagging = if is_low { self.sagging + S::lit(OUTER_DT) } else { S::zero() };
        self.sagging > S::lit(SAG_TIME)
    }

    fn target(&self, cx: &Context<'_, S>) -> Option<SphericalPoint<S>> {
        target(self.altitude.unwrap_or(cx.params.takeoff_altitude), cx)
    }
}

/// Volts per cell, as they are.
fn cell_voltage<S: Scalar>(cx: &Context<'_, S>) -> Option<S> {
    let cells = S::from_f32(cx.params.battery_cells.max(1.0));
    cx.sensors.battery.map(|battery| battery.voltage / cells)
}

/// Where a take-off to this altitude ends: straight out along the start heading; free straight up.
fn target<S: Scalar>(altitude: f32, cx: &Context<'_, S>) -> Option<SphericalPoint<S>> {
    let p = cx.params;
    if cx.config.constants.radial_control == RadialControl::Free {
        let here = cx.situation.estimate.position?.0;
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
