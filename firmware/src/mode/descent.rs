//! Descent: level and sinking, by altimeter and inertia. Uses neither position nor tether.

use super::context::leaning;
use super::{Context, Entry, Exit, FlightMode, Handover, Refusal, Setpoints};
use crate::frames::V3;
use crate::scalar::Scalar;
use crate::supervisor::GroundState;
use crate::time::OUTER_DT;

/// Below this height over the ground it sinks at the landing speed, m.
const SLOW_BELOW: f64 = 1.0;
/// Tangent of the largest lean against a drift.
const BRAKE_LEAN: f64 = 0.35;
/// The vertical share of the thrust counts, within the tilt that divides well.
pub(super) const COS_TILT_MIN: f64 = 0.5;

/// All of it is in the handover.
#[derive(Clone, Copy, Debug)]
pub(super) struct Descent;

impl<S: Scalar> FlightMode<S> for Descent {
    fn enter(
        _entry: &Entry,
        _handover: &mut Handover<S>,
        _cx: &Context<'_, S>,
    ) -> Result<Self, Refusal> {
        Ok(Self)
    }

    fn step(
        &mut self,
        handover: &mut Handover<S>,
        cx: &Context<'_, S>,
    ) -> Result<Setpoints<S>, Exit> {
        let tension = cx.tension(handover, false, cx.fixed_pull());
        Ok(Setpoints { wants_down: true, ..descend(handover, tension, cx) })
    }
}

/// Level, sinking at the landing speeds.
pub(super) fn descend<S: Scalar>(
    handover: &mut Handover<S>,
    tension: S,
    cx: &Context<'_, S>,
) -> Setpoints<S> {
    let low = cx.config.touch_down.ground_height + S::lit(SLOW_BELOW);
    let is_low = cx.situation.estimate.height < low;
    let sink = if is_low { cx.params.land_speed } else { cx.params.descend_speed };
    fly_level(handover, -S::from_f32(sink), tension, cx)
}

/// Level, at a climb rate, m/s.
pub(super) fn fly_level<S: Scalar>(
    handover: &mut Handover<S>,
    climb: S,
    tension: S,
    cx: &Context<'_, S>,
) -> Setpoints<S> {
    let unchanged = Setpoints { reference: None, ..cx.unchanged(tension) };
    if cx.ground() == GroundState::OnGround {
        return unchanged;
    }
    let estimate = &cx.situation.estimate;
    let up = cx.config.climb.step(&mut handover.climb, climb, estimate.climb, S::lit(OUTER_DT));
    // Nothing holds it any more, nor what it had to pull against: the way off is the estimate's last knowledge.
    let drift = estimate.velocity.filter(|_| estimate.tether_is_gone);
    let side = drift.map_or(V3::zeros(), |velocity| velocity.0 * -cx.config.constants.mass);
    let force = leaning(up, &side, S::lit(BRAKE_LEAN));
    let mut attitude = cx.thrust(force, handover.heading);
    attitude.thrust = up / estimate.attitude.cos_tilt().max(S::lit(COS_TILT_MIN));
    Setpoints { attitude, ..unchanged }
}
