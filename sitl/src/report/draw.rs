//! The picture of a flight: the charts that its log has something for.

use super::chart::{Area, Line, Panel, bounds, draw, plot};
use super::panels::Kind;
use super::read::FlightData;
use super::timeline::draw_timeline;
use clap::ValueEnum;
use plotters::prelude::*;
use std::error::Error;
use std::path::Path;

/// Of a chart, pixels.
const SIZE: (u32, u32) = (600, 440);
/// Of the title.
const TITLE: u32 = 40;

/// Draws a log's flight as SVG: these charts, or, if none is named, every one that the log has something for.
///
/// # Errors
/// One line naming the file, or what of it is not in the log.
pub fn draw_flight(
    data: &FlightData,
    title: &str,
    kinds: &[Kind],
    path: &Path,
) -> Result<(), String> {
    let kinds: Vec<Kind> = if kinds.is_empty() {
        Kind::value_variants().iter().copied().filter(|kind| kind.is_there(data)).collect()
    } else {
        if let Some(kind) = kinds.iter().find(|kind| !kind.is_there(data)) {
            let name = kind.to_possible_value();
            let name = name.as_ref().map_or("panel", |value| value.get_name());
            return Err(format!("{name}: nothing of it in this log"));
        }
        kinds.to_vec()
    };
    try_draw(data, title, &kinds, path).map_err(|e| format!("{}: {e}", path.display()))
}

fn try_draw(
    data: &FlightData,
    title: &str,
    kinds: &[Kind],
    path: &Path,
) -> Result<(), Box<dyn Error>> {
    let columns = if kinds.len() > 4 { 3 } else { kinds.len().min(2) };
    let rows = kinds.len().div_ceil(columns.max(1));
    let size = (SIZE.0 * columns as u32, SIZE.1 * rows as u32 + TITLE);
    let root = SVGBackend::new(path, size).into_drawing_area();
    root.fill(&WHITE)?;
    let root = root.titled(title, ("sans-serif", 26))?;
    for (area, kind) in root.split_evenly((rows, columns)).iter().zip(kinds) {
        match (kind, kind.cell(data)) {
            (Kind::Map, Some((panel, lines))) => draw_map(area, &panel, &lines)?,
            (_, Some((panel, lines))) => draw(area, &panel, &lines)?,
            (_, None) => draw_timeline(area, data)?,
        }
    }
    root.present()?;
    Ok(())
}

/// Both axes to the same scale.
fn draw_map(area: &Area, panel: &Panel, lines: &[Line]) -> Result<(), Box<dyn Error>> {
    let (xs, ys) = (bounds(lines, |p| p.0), bounds(lines, |p| p.1));
    let (width, height) = area.dim_in_pixel();
    let shape = (f64::from(width) - 78.0) / (f64::from(height) - 96.0);
    let half = ((xs.end - xs.start) / shape).max(ys.end - ys.start) / 2.0;
    let (cx, cy) = (f64::midpoint(xs.start, xs.end), f64::midpoint(ys.start, ys.end));
    let (x_range, y_range) = ((cx - half * shape)..(cx + half * shape), (cy - half)..(cy + half));
    plot(area, panel, lines, (x_range, y_range), &[(0.0, 0.0)])
}
