//! What the full-state filter sees, and what that is worth: the force's change along the line, and three filters over one
//! gusty hold.

use crate::flight::Flight;
use crate::report::chart::{ESTIMATE, Line, Panel, Points, SETPOINT, THIRD, TRUTH, draw};
use crate::scenario::Scenario;
use nalgebra::Vector3;
use plotters::prelude::*;
use std::error::Error;
use std::path::Path;
use tautline_firmware::supervisor::{GroundState, Mode};

/// In the hold, s.
const SHOWN: f64 = 40.0;
/// Before it, s.
const SETTLING: f64 = 5.0;
/// Between two samples, s: the mean over them.
const SAMPLE: f64 = 0.1;
/// For the force, s.
const FORCE_SHOWN: f64 = 12.0;

/// One flight's hold.
#[derive(Default)]
struct Hold {
    /// Error of the estimate over time, level, m.
    error: Points,
    /// East and North, true and estimated.
    path: [Points; 2],
    /// What is felt but thrust, level: away from the anchor, and to the right of that, N.
    force: Points,
}

/// Ready to draw.
pub struct FullStatePicture {
    moved: Hold,
    still: Hold,
    simple: Hold,
}

impl FullStatePicture {
    /// Flies them.
    pub fn fly(seed: u64) -> Result<Self, String> {
        Ok(Self {
            moved: hold("", seed)?,
            still: hold("TET_DITHER = 0", seed)?,
            simple: hold("EST_KIND = 0", seed)?,
        })
    }

    /// Four panels.
    pub fn draw(&self, path: &Path) -> Result<(), Box<dyn Error>> {
        let root = SVGBackend::new(path, (1200, 860)).into_drawing_area();
        root.fill(&WHITE)?;
        let areas = root.split_evenly((2, 2));
        let [force, change, error, plan] = areas.as_slice() else { return Ok(()) };
        let (out, right) = ("away from the anchor, N", "to the right, N");
        let samples = &self.moved.force;
        let reach = samples.iter().fold(0.0_f64, |least, p| least.min(p.0)) - 0.5;
        let line = |from: f64, to: f64| {
            Line::new("the line's direction", TRUTH, vec![(from, 0.0), (to, 0.0)]).dashed()
        };
        draw(
            force,
            &Panel::new("Level force without thrust, 12 s, wind from the side", out, right),
            &[Line::new("samples of 0.1 s", SETPOINT, samples.clone()), line(reach, 0.0)],
        )?;
        let steps: Points = samples
            .windows(5)
            .filter_map(|w| Some((w.last()?, w.first()?)))
            .map(|(b, a)| (b.0 - a.0, b.1 - a.1))
            .collect();
        draw(
            change,
            &Panel::new("Its change over 0.4 s lies along the line", out, right),
            &[Line::new("change", SETPOINT, steps), line(-4.0, 4.0)],
        )?;
        draw(
            error,
            &Panel::new("Error of the place, level, wind of 5 m/s with gusts", "time, s", "m"),
            &[
                Line::new("simple filter", ESTIMATE, self.simple.error.clone()),
                Line::new("full state, still tension", THIRD, self.still.error.clone()),
                Line::new("full state, moving tension", SETPOINT, self.moved.error.clone()),
            ],
        )?;
        let [truth, estimate] = &self.moved.path;
        let [simple_truth, simple] = &self.simple.path;
        draw(
            plan,
            &Panel::new(
                "Seen from above: where it is, where it thinks it is",
                "East, m",
                "North, m",
            ),
            &[
                Line::new("true, flown by the full state", TRUTH, truth.clone()),
                Line::new("full state", SETPOINT, estimate.clone()),
                Line::new("true, flown by the simple filter", TRUTH, simple_truth.clone()).dashed(),
                Line::new("simple filter", ESTIMATE, simple.clone()),
            ],
        )?;
        root.present()?;
        Ok(())
    }
}

fn hold(params: &str, seed: u64) -> Result<Hold, String> {
    let text = format!(
        r#"
        [wind]
        speed = 5
        gusts = true
        from = 1.57
        [params]
        {params}
        [[mission]]
        do = "arm"
        [[mission]]
        do = "takeoff"
        altitude = 7.07
        [[mission]]
        do = "hold"
        seconds = 60
        "#
    );
    let scenario = Scenario::parse(&text, "full-state picture").map_err(|e| e.0)?;
    let parameters = scenario.params().map_err(|e| e.0)?;
    let mut flight = Flight::unrecorded(&scenario, parameters, seed).map_err(|e| e.0)?;
    let mut hold = Hold::default();
    let (mut began, mut sum, mut count) = (None, Vector3::zeros(), 0.0);
    while flight.world.time() < 200.0 {
        flight.step(&mut |_| {});
        let (out, now) = (flight.output(), flight.world.time());
        if out.mode != Mode::TetherHold || out.ground != GroundState::InAir {
            continue;
        }
        let time = now - *began.get_or_insert(now) - SETTLING;
        let (Some(imu), Some(position)) = (&out.sensors.imu, &out.estimate.position) else {
            continue;
        };
        if time > SHOWN {
            return Ok(hold);
        }
        let wide = |v: &Vector3<f32>| v.map(f64::from);
        let attitude = out.estimate.attitude.0.map(f64::from);
        let mut own = wide(&imu.value.accel.0) * f64::from(parameters.mass);
        own.z += f64::from(out.estimate.thrust);
        sum += attitude * own;
        count += 1.0;
        if time < 0.0 || count * 1e-3 < SAMPLE {
            if time < 0.0 {
                (sum, count) = (Vector3::zeros(), 0.0);
            }
            continue;
        }
        let plant = &flight.world.environment.plant;
        let (truth, estimate) = (plant.from_anchor(), wide(&position.0));
        let away = Vector3::new(truth.x, truth.y, 0.0).normalize();
        let force = sum / count;
        (sum, count) = (Vector3::zeros(), 0.0);
        if time < FORCE_SHOWN {
            let right = Vector3::new(-away.y, away.x, 0.0);
            hold.force.push((force.dot(&away), force.dot(&right)));
        }
        let off = estimate - truth;
        hold.error.push((time, off.x.hypot(off.y)));
        let [flown, thought] = &mut hold.path;
        flown.push((truth.y, truth.x));
        thought.push((estimate.y, estimate.x));
    }
    Err("full-state picture: the hold was not flown to its end".into())
}
