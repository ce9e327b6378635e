//! The part of a step's output by which somebody on the ground decides what to ask next.

use serde::{Deserialize, Serialize};
use tautline_firmware::math::so3::norm;
use tautline_firmware::signal::PlanarReference;
use tautline_firmware::supervisor::{GroundState, Mode};
use tautline_firmware::vehicle::StepOutput;

/// Rates of a reference below this are rest.
const REST: f32 = 1e-6;

/// After a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Status {
    /// Flight mode, as MAVLink's HEARTBEAT gives it.
    pub custom_mode: u32,
    /// Motors may turn.
    pub is_armed: bool,
    /// All arming checks pass.
    pub is_armable: bool,
    /// Not on the ground.
    pub is_in_air: bool,
    /// Speed of the reference, m/s; `None` without one.
    pub reference_speed: Option<f32>,
    /// Taut-link reference, if there is one: elevation, rad, and second output, rad or N.
    pub taut: Option<TautPoint>,
    /// Height estimate over the anchor, m.
    pub height: f32,
    /// Position estimate from the anchor, NED, m.
    pub position: Option<[f32; 3]>,
    /// Tension asked of the winch, N.
    pub winch_tension: f32,
}

/// Where a taut-link reference is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TautPoint {
    /// rad.
    pub elevation: f32,
    /// Pitch, rad, or force, N.
    pub second: f32,
    /// It does not move.
    pub rests: bool,
}

fn point(reference: PlanarReference<f32>) -> TautPoint {
    let ([elevation, rate, ..], [second, slope, _]) = (reference.elevation, reference.second);
    let is_small = |x: f32| x.abs() < REST;
    TautPoint { elevation, second, rests: is_small(rate) && is_small(slope) }
}

impl Status {
    /// After this step.
    #[must_use]
    pub fn of(out: &StepOutput) -> Self {
        Self {
            custom_mode: out.mode.rule().custom_mode,
            is_armed: out.is_armed,
            is_armable: out.is_armable,
            is_in_air: out.ground == GroundState::InAir,
            reference_speed: out.reference.map(|r| norm(&r.velocity.0)),
            taut: out.taut_reference.map(point),
            height: out.estimate.height,
            position: out.estimate.position.map(|p| p.0.into()),
            winch_tension: out.actuation.winch.tension,
        }
    }

    /// Whether this is the flight mode.
    #[must_use]
    pub fn is_in(&self, mode: Mode) -> bool {
        self.custom_mode == mode.rule().custom_mode
    }
}
