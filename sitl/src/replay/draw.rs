//! How far two runs over the same inputs are apart, drawn.

use super::run::Replayed;
use crate::report::chart::{ESTIMATE, Line, Panel, Points, TRUTH, draw};
use plotters::prelude::*;
use std::error::Error;
use std::path::Path;

const SIZE: (u32, u32) = (1200, 900);

/// Positions, attitudes and throttles over time, as SVG.
///
/// # Errors
/// The drawing's error.
pub fn draw_difference(replayed: &Replayed, path: &Path) -> Result<(), Box<dyn Error>> {
    let root = SVGBackend::new(path, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let areas = root.split_evenly((3, 1));
    let [position, attitude, throttle] = areas.as_slice() else { return Ok(()) };
    let degrees: Points =
        replayed.attitude.iter().map(|(time, angle)| (*time, angle.to_degrees())).collect();
    let mean = |pick: fn(&[f64; 2]) -> f64| -> Points {
        replayed.throttle.iter().map(|(time, both)| (*time, pick(both))).collect()
    };
    let one = |points: Points| [Line::new("", ESTIMATE, points)];
    draw(
        position,
        &Panel::new("Distance of the estimated positions", "time, s", "m"),
        &one(replayed.position.clone()),
    )?;
    draw(
        attitude,
        &Panel::new("Angle between the estimated attitudes", "time, s", "deg"),
        &one(degrees),
    )?;
    let lines = [
        Line::new("recorded", TRUTH, mean(|both| both[0])),
        Line::new("replayed", ESTIMATE, mean(|both| both[1])),
    ];
    draw(throttle, &Panel::new("Mean throttle", "time, s", ""), &lines)?;
    root.present()?;
    Ok(())
}
