//! Flying along a plan by the position loop, and making a new plan of a command. For every mode that knows where it is.

use super::descent::{descend, fly_level};
use super::feasible;
use super::refusal::{check_heading, denied, rejected};
use super::{Context, Handover, Refusal, Setpoints};
use crate::control::{PositionInput, RadialControl};
use crate::frames::{V3, World};
use crate::math::so3;
use crate::scalar::Scalar;
use crate::signal::{Action, FlightReference, SphericalPoint};
use crate::supervisor::GroundState;
use crate::time::OUTER_DT;
use crate::trajectory::{Plan, STREAM_TIME, direction_of};

/// Set-points closer than this in every coordinate are the same, m.
pub(super) const SAME_PLACE: f64 = 0.01;
/// A set-point of a stream further from the reference than this, m, is flown to first; and how much faster than
/// CRUISE it may be.
const STREAM_NEAR: f32 = 1.0;
const STREAM_FAST: f32 = 2.0;
/// How far one set-point moves the reference at once, m: it joins the stream without a jump.
const STREAM_CATCH_UP: f32 = 0.05;
/// Slack on a fixed length: within this share of it the link is looked for radially, further in by position.
const NEARLY_TAUT: f64 = 0.85;
/// Radial speed that looks for the link, m/s.
const SEEK_NEAR: f64 = 0.3;
const SEEK_FAR: f64 = 0.4;
/// Given length and that of a fixed tether may differ by so much, m.
const LENGTH_TOLERANCE: f32 = 0.3;

/// Holds where the vehicle is.
pub(super) fn stay<S: Scalar>(handover: &mut Handover<S>, cx: &Context<'_, S>) {
    if let Some(position) = cx.situation.estimate.position {
        handover.plan = Plan::stay(position);
    }
}

/// One step along the plan.
pub(super) fn fly<S: Scalar>(
    handover: &mut Handover<S>,
    tension: S,
    cx: &Context<'_, S>,
) -> Setpoints<S> {
    let unchanged = cx.unchanged(tension);
    if cx.ground() == GroundState::OnGround {
        return unchanged;
    }
    let situation = cx.situation;
    let Some(smoothed) = situation.smoothed else {
        // The failsafe table ends it: at once on a tether, after a while without motion capture.
        return match cx.config.constants.radial_control {
            RadialControl::Free => fly_level(handover, S::zero(), tension, &V3::zeros(), cx),
            RadialControl::Winch | RadialControl::FixedLength => descend(handover, tension, cx),
        };
    };
    let dt = S::lit(OUTER_DT);
    let (position, velocity) = handover.plan.step(dt);
    let dither = cx.dither(tension);
    let tension = tension + dither;
    let reference = FlightReference { position, velocity, yaw: handover.heading, tension };
    let (direction, length) = direction_of(&position);
    let mixer = situation.mixer;
    let mut input = PositionInput {
        position: smoothed.position,
        velocity: smoothed.velocity,
        wind: situation.estimate.air_force,
        direction,
        reference_velocity: velocity,
        length,
        length_rate: so3::dot(&direction.0, &velocity.0),
        tension,
        radial_control: cx.config.constants.radial_control,
        hold_integral: mixer.thrust_is_saturated || mixer.tilt_is_saturated,
    };
    let constants = &cx.config.constants;
    // The loop pulls along the chord: with the tension of the line's middle.
    let growth = constants.line.growth(-smoothed.position.0.z);
    input.tension = tension + growth;
    let is_taut = || situation.estimate.tether.is_none_or(|t| t.is_taut);
    match constants.radial_control {
        RadialControl::Winch => {
            let felt = (smoothed.tension - growth).max(S::zero());
            input.tension = (input.tension + felt) * S::lit(0.5);
        }
        RadialControl::FixedLength if !is_taut() => {
            // Slack: out gently; far inside the sphere by position alone.
            let distance = so3::norm(&smoothed.position.0);
            if distance >= constants.tether_length * S::lit(NEARLY_TAUT) {
                input.length_rate = S::lit(SEEK_NEAR);
            } else {
                input.radial_control = RadialControl::Winch;
                input.tension = S::zero();
                input.length = distance;
                input.length_rate = S::lit(SEEK_FAR);
            }
        }
        RadialControl::FixedLength | RadialControl::Free => {}
    }
    let asked = cx.config.position.step(&mut handover.position, &input, dt);
    let attitude = cx.thrust(asked.force.0, handover.heading);
    Setpoints { attitude, reference: Some(reference), dither, ..unchanged }
}

/// A move in world or tether coordinates, or a pause; the tension asked for, N, if one was.
pub(super) fn command<S: Scalar>(
    handover: &mut Handover<S>,
    action: &Action,
    cx: &Context<'_, S>,
) -> Result<Option<S>, Refusal> {
    match *action {
        Action::Pause => {
            stay(handover, cx);
            Ok(None)
        }
        Action::MoveTo { ned, yaw } => go_to(handover, ned, yaw, cx).map(|()| None),
        Action::MoveTether { elevation, azimuth, length, tension } => {
            let now = end(handover, cx)?;
            if let Some(tension) = tension {
                check_tension(tension, cx)?;
            }
            let wanted = tension.unwrap_or(handover.tension.to_f32());
            let to = SphericalPoint {
                elevation: elevation.unwrap_or(now.elevation),
                azimuth: azimuth.unwrap_or(now.azimuth),
                length: length.unwrap_or(now.length),
            };
            go(handover, &to, wanted, cx)?;
            Ok(tension.map(S::from_f32))
        }
        _ => Err(super::refusal::not_here(action)),
    }
}

/// Where the present plan ends.
fn end<S: Scalar>(
    handover: &Handover<S>,
    cx: &Context<'_, S>,
) -> Result<SphericalPoint<f32>, Refusal> {
    if !cx.is_in_air() {
        return Err(rejected("Move refused: not in Tether Hold in the air"));
    }
    Ok(SphericalPoint::from_world(&handover.plan.end()).to_f32())
}

fn check_tension<S: Scalar>(tension: f32, cx: &Context<'_, S>) -> Result<(), Refusal> {
    let p = cx.params;
    if tension >= p.tension_min && tension <= p.tension_max {
        Ok(())
    } else {
        Err(denied("Move refused: tension out of range"))
    }
}

fn go_to<S: Scalar>(
    handover: &mut Handover<S>,
    ned: [Option<f32>; 3],
    yaw: Option<f32>,
    cx: &Context<'_, S>,
) -> Result<(), Refusal> {
    let here = end(handover, cx)?.to_world().0;
    let [north, east, down] = ned;
    check_heading(yaw)?;
    if ned.iter().any(Option::is_some) {
        let to =
            World(V3::new(north.unwrap_or(here.x), east.unwrap_or(here.y), down.unwrap_or(here.z)));
        let mut to = SphericalPoint::from_world(&to);
        if cx.config.constants.radial_control == RadialControl::FixedLength {
            to.length = cx.params.tether_length;
        }
        let tension = handover.tension.to_f32();
        go(handover, &to, tension, cx)?;
    }
    if let Some(yaw) = yaw {
        handover.heading = S::from_f32(yaw);
    }
    Ok(())
}

/// A set-point of a stream: one that moves is followed as it is, if it is near and slow enough; else it is a place to
/// go to. `None` for where the reference is.
pub(super) fn follow<S: Scalar>(
    handover: &mut Handover<S>,
    ned: [Option<f32>; 3],
    velocity: Option<[f32; 3]>,
    yaw: Option<f32>,
    cx: &Context<'_, S>,
) -> Result<(), Refusal> {
    let is_place = ned.iter().any(Option::is_some);
    let Some(velocity) = velocity.filter(|v| !is_place || v.iter().any(|speed| *speed != 0.0))
    else {
        return go_to(handover, ned, yaw, cx);
    };
    let planned = end(handover, cx)?.to_world().0;
    check_heading(yaw)?;
    let single = |v: &V3<S>| v.map(Scalar::to_f32);
    let here = cx.situation.setpoints.reference.map_or(planned, |r| single(&r.position.0));
    let [north, east, down] = ned;
    let mut from = V3::new(north.unwrap_or(here.x), east.unwrap_or(here.y), down.unwrap_or(here.z));
    let mut velocity = V3::from(velocity);
    let off = from - here;
    if so3::norm(&off) > STREAM_NEAR {
        return go_to(handover, ned, yaw, cx);
    }
    from = here + so3::limit_norm(off, STREAM_CATCH_UP);
    if so3::norm(&velocity) > STREAM_FAST * cx.params.cruise_speed {
        return Err(denied("Set-point refused: too fast"));
    }
    if cx.config.constants.radial_control == RadialControl::FixedLength {
        let up = from / so3::norm(&from).max(0.1);
        from = up * cx.params.tether_length;
        velocity = so3::reject(&velocity, &up);
    }
    let ahead = from + velocity * STREAM_TIME as f32;
    check(&SphericalPoint::from_world(&World(ahead)), handover.tension.to_f32(), cx)?;
    let wide = |v: V3<f32>| World(v.map(S::from_f32));
    handover.plan = Plan::stream(wide(from), wide(velocity));
    if let Some(yaw) = yaw {
        handover.heading = S::from_f32(yaw);
    }
    Ok(())
}

/// Whether a place may be flown to.
fn check<S: Scalar>(
    to: &SphericalPoint<f32>,
    tension: f32,
    cx: &Context<'_, S>,
) -> Result<(), Refusal> {
    let p = cx.params;
    let within = |x: f32, lo: f32, hi: f32| x >= lo && x <= hi;
    if !(to.elevation.is_finite() && to.length.is_finite() && to.azimuth.abs() < 100.0) {
        return Err(denied("Move refused: not a number"));
    }
    let is_free = cx.config.constants.radial_control == RadialControl::Free;
    let (low, high) = (p.elevation_min - 0.01, p.elevation_max + 0.01);
    if !is_free && !within(to.elevation, low, high) {
        return Err(denied("Move refused: elevation out of range"));
    }
    let nearest = if is_free { 0.1 } else { 1.0 };
    if !within(to.length, nearest, p.length_max) {
        return Err(denied("Move refused: length out of range"));
    }
    let place = to.to_world().0;
    if p.has_fence() && !p.is_inside_fence(place, -place.z) {
        return Err(denied("Move refused: beyond the fence"));
    }
    let is_fixed = cx.config.constants.radial_control == RadialControl::FixedLength;
    if is_fixed && (to.length - p.tether_length).abs() > LENGTH_TOLERANCE {
        return Err(denied("Move refused: the tether has a fixed length"));
    }
    feasible::check(&feasible::MOVE, to, tension, cx)
}

fn go<S: Scalar>(
    handover: &mut Handover<S>,
    to: &SphericalPoint<f32>,
    tension: f32,
    cx: &Context<'_, S>,
) -> Result<(), Refusal> {
    check(to, tension, cx)?;
    let to = SphericalPoint {
        elevation: S::from_f32(to.elevation),
        azimuth: S::from_f32(to.azimuth),
        length: S::from_f32(to.length),
    };
    // Programs repeat their set-point many times a second: only a new place is a new move.
    let away = to.to_world().0 - handover.plan.end().0;
    if away.iter().all(|d| d.abs() <= S::lit(SAME_PLACE)) {
        return Ok(());
    }
    let reference = cx.situation.setpoints.reference;
    let from = reference.map_or(handover.plan.end(), |r| r.position);
    handover.plan = cx.config.planner.go(from, to);
    Ok(())
}
