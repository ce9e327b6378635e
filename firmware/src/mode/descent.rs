//! Descent: down where it is, with what is left.
//!
//! It leans against all that is felt beside the thrust, brakes the drift by the best velocity there is, inertia at worst,
//! and holds the place while the position is believed. Its height needs an altimeter at best and inertia at worst.

use super::context::leaning;
use super::{Context, Entry, Exit, FlightMode, Handover, Refusal, Setpoints};
use crate::control::RadialControl;
use crate::frames::{V3, World};
use crate::math::so3;
use crate::scalar::Scalar;
use crate::supervisor::GroundState;
use crate::time::OUTER_DT;

/// Below this height over the ground it sinks at the landing speed, m.
const SLOW_BELOW: f64 = 1.0;
/// Tangent of the largest lean, and while the position is not believed: what the attitude is off by then pushes too.
const LEAN: f64 = 0.5;
const LEAN_BLIND: f64 = 0.25;
/// Of what is felt beside the thrust, that is leant against then: rather towards the anchor than away.
const SHARE_BLIND: f64 = 0.8;
/// 1/s, and 1/s² to hold the place.
const BRAKE: f64 = 1.4;
const HOLD: f64 = 0.5;
/// Slower than this, m/s, it has come to a stop and holds that place; farther off, m, it is let go.
const STOPPED: f64 = 0.4;
const FAR: f64 = 1.5;
/// A winch pulls as it is asked, the air no more than this, m/s²: beyond both, the line holds by itself.
const AIR_MOST: f64 = 2.5;
/// The vertical share of the thrust counts, within the tilt that divides well.
pub(super) const COS_TILT_MIN: f64 = 0.5;

/// Where it holds, once it has stopped.
#[derive(Clone, Copy, Debug)]
pub(super) struct Descent<S: Scalar> {
    place: Option<World<V3<S>>>,
}

impl<S: Scalar> FlightMode<S> for Descent<S> {
    fn enter(
        _entry: &Entry,
        _handover: &mut Handover<S>,
        _cx: &Context<'_, S>,
    ) -> Result<Self, Refusal> {
        Ok(Self { place: None })
    }

    fn step(
        &mut self,
        handover: &mut Handover<S>,
        cx: &Context<'_, S>,
    ) -> Result<Setpoints<S>, Exit> {
        let tension = cx.tension(handover, false, cx.fixed_pull());
        let estimate = &cx.situation.estimate;
        let position = estimate.position.filter(|_| cx.situation.has_place);
        let is_slow = so3::norm(&cx.situation.navigation.drift().0) < S::lit(STOPPED);
        let off = |place: &World<V3<S>>, here: &World<V3<S>>| {
            let off = place.0 - here.0;
            V3::new(off.x, off.y, S::zero())
        };
        self.place = match (position, self.place) {
            (Some(here), Some(place)) if so3::norm(&off(&place, &here)) < S::lit(FAR) => {
                Some(place)
            }
            (Some(here), _) if is_slow => Some(here),
            _ => None,
        };
        let way = position.zip(self.place).map_or(V3::zeros(), |(here, place)| off(&place, &here));
        let sink = sinking(cx);
        Ok(Setpoints { wants_down: true, ..fly_level(handover, sink, tension, &way, cx) })
    }
}

/// Climb rate of a descent, m/s.
fn sinking<S: Scalar>(cx: &Context<'_, S>) -> S {
    let low = cx.config.touch_down.ground_height + S::lit(SLOW_BELOW);
    let is_low = cx.situation.estimate.height < low;
    let sink = if is_low { cx.params.land_speed } else { cx.params.descend_speed };
    -S::from_f32(sink)
}

/// Sinking at the landing speeds, wherever it is.
pub(super) fn descend<S: Scalar>(
    handover: &mut Handover<S>,
    tension: S,
    cx: &Context<'_, S>,
) -> Setpoints<S> {
    fly_level(handover, sinking(cx), tension, &V3::zeros(), cx)
}

/// At a climb rate, m/s, without drift; `way`: to the place that it holds, level, m.
pub(super) fn fly_level<S: Scalar>(
    handover: &mut Handover<S>,
    climb: S,
    tension: S,
    way: &V3<S>,
    cx: &Context<'_, S>,
) -> Setpoints<S> {
    let unchanged = Setpoints { reference: None, ..cx.unchanged(tension) };
    if cx.ground() == GroundState::OnGround {
        return unchanged;
    }
    let estimate = &cx.situation.estimate;
    let up = cx.config.climb.step(&mut handover.climb, climb, estimate.climb, S::lit(OUTER_DT));
    let mass = cx.config.constants.mass;
    // After a cut the velocity is known, and to be lost soon: it brakes while it can.
    let has_place = cx.situation.has_place || estimate.tether_is_gone;
    let (lean, share) = if has_place { (LEAN, 1.0) } else { (LEAN_BLIND, SHARE_BLIND) };
    let pulls = outside(tension, cx) * S::lit(share);
    let side =
        (way * S::lit(HOLD) - cx.situation.navigation.drift().0 * S::lit(BRAKE) - pulls) * mass;
    let force = leaning(up, &side, S::lit(lean));
    let mut attitude = cx.thrust(force, handover.heading);
    attitude.thrust = up / estimate.attitude.cos_tilt().max(S::lit(COS_TILT_MIN));
    Setpoints { attitude, ..unchanged }
}

/// What pulls sideways beside the thrust, m/s². A line of fixed length pulls as much as one leans on it: that is not
/// leant against.
fn outside<S: Scalar>(tension: S, cx: &Context<'_, S>) -> V3<S> {
    let estimate = &cx.situation.estimate;
    let constants = &cx.config.constants;
    let is_taut = estimate.tether.is_some_and(|tether| tether.is_taut);
    let most = match constants.radial_control {
        // What was felt last was the line.
        _ if estimate.tether_is_gone => S::zero(),
        RadialControl::FixedLength if is_taut => S::zero(),
        RadialControl::FixedLength | RadialControl::Free => S::lit(AIR_MOST),
        RadialControl::Winch => S::lit(AIR_MOST) + tension / constants.mass,
    };
    let World(felt) = estimate.attitude.to_world(cx.situation.navigation.outside());
    let level = V3::new(felt.x, felt.y, S::zero());
    so3::limit_norm(level, most)
}
