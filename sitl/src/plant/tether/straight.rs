//! A straight link without mass of its own between its ends: pulls, or pushes as a strut, or both as a bar.
//!
//! At a fixed length a unilateral spring and damper; on a winch the drum's tension. The line's weight is counted as on
//! a shallow catenary: half of it hangs on the vehicle, and the tension grows by weight per length times height from
//! the station to the vehicle, so that its middle carries half of that more than the drum.

use super::super::{GRAVITY, V3};
use super::drag::drag;
use super::station::Drum;
use super::{End, TetherModel};

/// What a straight link does.
#[derive(Clone, Copy, Debug, Default)]
pub struct Straight {
    /// From the station towards the vehicle; zero: nothing pulls.
    pub along: V3,
    /// Along the link at its middle, N; negative where it pushes.
    pub tension: f64,
    /// What the tension changes from there to each end, N.
    pub half_weight: f64,
    /// Unstretched, m.
    pub length: f64,
}

impl Straight {
    /// At the station and at the vehicle, N. A slack line holds neither end.
    pub fn end_tensions(&self) -> [f64; 2] {
        let more = if self.tension == 0.0 { 0.0 } else { self.half_weight };
        [self.tension - more, self.tension + more]
    }
}

/// The air's force on the line, which changes slowly: looked up once per millisecond.
#[derive(Clone, Copy, Debug, Default)]
pub struct Air {
    /// N.
    pub drag: V3,
    /// Velocity of the air, m/s; `None`: already felt.
    pub wind: Option<V3>,
}

/// Shortest distance at which the line has a direction, m.
pub const SHORTEST: f64 = 0.05;
/// A straight link swings about its lower end: of its drag the vehicle carries a third.
pub const DRAG_SHARE: f64 = 1.0 / 3.0;

/// The link, and its force on the vehicle, N, from a base that moves at `base_velocity` m/s. `drum`: none at a fixed `length`, m.
#[inline(always)]
pub fn straight(
    model: &TetherModel,
    drum: Option<Drum>,
    length: f64,
    base: (V3, V3),
    end: &End,
    air: &mut Air,
) -> (Straight, V3) {
    let way = end.position - base.0;
    let distance = way.norm();
    if model.is_broken || distance < SHORTEST {
        return (Straight { length: distance, ..Straight::default() }, V3::zeros());
    }
    let along = way / distance;
    let velocity = end.velocity - base.1;
    let outward = velocity.dot(&along);
    let weight = model.line_density * GRAVITY;
    let half_weight = -0.5 * weight * way.z;
    let (tension, length) = match drum {
        None => (elastic(model, length, distance - length, outward), length),
        Some(drum) => {
            let most = drum.model.length_max;
            let end_stop = elastic(model, most, distance - most, outward);
            let held = (drum.wanted + drum.model.friction(outward)).max(0.0);
            (held + half_weight + end_stop, distance)
        }
    };
    if let Some(wind) = air.wind.take() {
        let over = velocity - wind;
        air.drag = drag(model.diameter, length * DRAG_SHARE, &along, &over);
    }
    let mut force = air.drag - along * tension;
    force.z += 0.5 * weight * length;
    (Straight { along, tension, half_weight, length }, force)
}

fn elastic(model: &TetherModel, length: f64, stretch: f64, outward: f64) -> f64 {
    if stretch <= 0.0 && !model.pushes || stretch >= 0.0 && !model.pulls {
        return 0.0;
    }
    let k = model.stiffness / length;
    let damping = 2.0 * model.damping_ratio * (k * model.reference_mass).sqrt();
    let force = k * stretch + damping * outward;
    let low = if model.pushes { f64::NEG_INFINITY } else { 0.0 };
    let high = if model.pulls { f64::INFINITY } else { 0.0 };
    force.clamp(low, high)
}
