//! What a page shows of one instant.

use crate::flight::Flight;
use crate::plant::{Plant, V3};
use serde::Serialize;
use std::io::Write;
use tautline_firmware::signal::Event;
use tautline_firmware::supervisor::{FAILSAFES, GroundState};
use tautline_firmware::vehicle::StepOutput;

/// Texts that a page shows.
const TEXTS: usize = 8;

/// Truth, estimate and state. World axes NED, body axes FRD, quaternions `[w, x, y, z]` from body to world.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Snapshot {
    /// Simulated, since the first step, s.
    pub time_s: f64,
    /// As the mode table names it.
    pub mode: &'static str,
    /// Motors may turn.
    pub is_armed: bool,
    /// All arming checks pass.
    pub is_armable: bool,
    /// Not on the ground.
    pub is_in_air: bool,
    /// MAVLink system that has the command.
    pub commander: Option<u8>,
    /// Of each rotor, 0 to 1.
    pub throttle: Vec<f32>,
    /// Tension asked of the winch, N.
    pub winch_tension_n: f32,
    /// Where the vehicle really is, where somebody knows.
    pub truth: Option<Truth>,
    /// What the firmware believes.
    pub estimate: Estimate,
    /// As measured.
    pub battery: Option<Battery>,
    /// Rows of the failsafe table that are active.
    pub failures: Vec<&'static str>,
    /// Names of the faults that are active.
    pub faults: Vec<&'static str>,
    /// The last texts for the operator.
    pub texts: Vec<Text>,
}

/// The plant.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Truth {
    /// Of the centre of mass, world, m.
    pub position_m: [f64; 3],
    /// World, m/s.
    pub velocity_mps: [f64; 3],
    /// Body to world.
    pub attitude: [f64; 4],
    /// Of the ground end, world, m.
    pub anchor_m: [f64; 3],
    /// Anchor→vehicle above the horizontal, rad.
    pub elevation_rad: f64,
    /// Anchor→vehicle from North, rad.
    pub azimuth_rad: f64,
    /// Height over the ground, m.
    pub height_m: f64,
    /// At the vehicle, N.
    pub tension_n: f64,
    /// Line outside, m.
    pub line_length_m: f64,
    /// From the ground end to the vehicle, world, m; empty without a line.
    pub line_m: Vec<[f64; 3]>,
    /// Air at the vehicle, world, m/s.
    pub wind_mps: [f64; 3],
}

/// The firmware's.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// Body to world.
    pub attitude: [f32; 4],
    /// From the anchor, m; `None`: nobody knows.
    pub position_m: Option<[f32; 3]>,
    /// One standard deviation of each coordinate, m.
    pub position_sd_m: [f32; 3],
    /// What may have turned the heading unseen, rad.
    pub heading_sd_rad: f32,
    /// Over the anchor, m.
    pub height_m: f32,
    /// rad.
    pub elevation_rad: Option<f32>,
    /// rad.
    pub azimuth_rad: Option<f32>,
    /// N.
    pub tension_n: Option<f32>,
}

/// The battery.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Battery {
    /// V.
    pub voltage_v: f32,
    /// 0 to 1.
    pub remaining: f32,
}

/// A line for the operator.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Text {
    /// s.
    pub time_s: f64,
    /// As MAVLink counts: 2 is critical, 6 worth knowing.
    pub severity: u8,
    /// At most 50 bytes.
    pub text: String,
}

/// The last of them, oldest first.
#[must_use]
pub fn last_texts(events: &[(f64, Event)]) -> Vec<Text> {
    let last = events.get(events.len().saturating_sub(TEXTS)..).unwrap_or(&[]);
    let text = |(time, event): &(f64, Event)| Text {
        time_s: *time,
        severity: event.severity as u8,
        text: event.to_string(),
    };
    last.iter().map(text).collect()
}

impl Snapshot {
    /// After the last step.
    #[must_use]
    pub fn of<W: Write>(flight: &Flight<W>) -> Self {
        let (out, environment) = (flight.output(), &flight.world.environment);
        let active = FAILSAFES.iter().filter(|row| out.failures & row.failure.mask() != 0);
        Self {
            time_s: flight.world.time(),
            mode: out.mode.rule().name,
            is_armed: out.is_armed,
            is_armable: out.is_armable,
            is_in_air: out.ground == GroundState::InAir,
            commander: out.commander,
            throttle: out.actuation.throttle.iter().copied().collect(),
            winch_tension_n: out.actuation.winch.tension,
            truth: environment.has_truth().then(|| Truth::of(&environment.plant)),
            estimate: Estimate::of(out),
            battery: out
                .sensors
                .battery
                .map(|b| Battery { voltage_v: b.voltage, remaining: b.remaining }),
            failures: active.map(|row| row.text).collect(),
            faults: environment.active_faults(),
            texts: last_texts(&flight.events),
        }
    }
}

impl Truth {
    fn of(plant: &Plant) -> Self {
        let from_anchor = plant.from_anchor();
        let q = plant.body.attitude;
        Self {
            position_m: plant.body.position.into(),
            velocity_mps: plant.body.velocity.into(),
            attitude: [q.w, q.i, q.j, q.k],
            anchor_m: plant.anchor.position.into(),
            elevation_rad: (-from_anchor.z).atan2(from_anchor.x.hypot(from_anchor.y)),
            azimuth_rad: from_anchor.y.atan2(from_anchor.x),
            height_m: plant.height_over_ground(),
            tension_n: plant.tether.tension(),
            line_length_m: plant.tether.length(),
            line_m: line(plant),
            wind_mps: plant.wind.velocity.into(),
        }
    }
}

/// The nodes of a chain, or both ends.
fn line(plant: &Plant) -> Vec<[f64; 3]> {
    let model = &plant.model().tether;
    if !(model.pulls || model.pushes) {
        return Vec::new();
    }
    let nodes: Vec<[f64; 3]> = plant.tether.points().map(<[f64; 3]>::from).collect();
    if !nodes.is_empty() {
        return nodes;
    }
    if model.is_broken {
        return Vec::new();
    }
    let base: V3 = plant.anchor.position;
    vec![base.into(), (base + plant.end()).into()]
}

impl Estimate {
    fn of(out: &StepOutput) -> Self {
        let e = &out.estimate;
        Self {
            attitude: e.attitude.quaternion(),
            position_m: e.position.map(|p| p.0.into()),
            position_sd_m: e.position_sd.into(),
            heading_sd_rad: e.heading_sd,
            height_m: e.height,
            elevation_rad: e.tether.map(|t| t.elevation),
            azimuth_rad: e.tether.map(|t| t.azimuth),
            tension_n: e.tether.map(|t| t.tension),
        }
    }
}
