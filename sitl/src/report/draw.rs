//! The picture of a flight: map, height, tether angles, tension.

use super::chart::{
    Area, ESTIMATE, Line, Panel, SETPOINT, THIRD, TRUTH, TRUTH_FAINT, bounds, draw, plot,
};
use super::read::{FlightData, Series};
use plotters::prelude::*;
use std::error::Error;
use std::path::Path;

const SIZE: (u32, u32) = (1200, 900);

/// Draws a log's flight as SVG.
///
/// # Errors
/// One line naming the file.
pub fn draw_flight(data: &FlightData, title: &str, path: &Path) -> Result<(), String> {
    try_draw(data, title, path).map_err(|e| format!("{}: {e}", path.display()))
}

fn try_draw(data: &FlightData, title: &str, path: &Path) -> Result<(), Box<dyn Error>> {
    let root = SVGBackend::new(path, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let root = root.titled(title, ("sans-serif", 26))?;
    let panels = root.split_evenly((2, 2));
    let [map, height, angles, tension] = panels.as_slice() else { return Ok(()) };
    draw_map(map, data)?;
    let [[_, _, true_down], [_, _, down], [_, _, wanted_down]] =
        [&data.truth, &data.estimate, &data.setpoint];
    let up = |s: &Series| s.iter().map(|&(t, z)| (t, -z)).collect::<Series>();
    let lines = [
        Line::new("truth", TRUTH, up(true_down)),
        Line::new("estimate", ESTIMATE, up(down)),
        Line::new("set-point", SETPOINT, up(wanted_down)),
    ];
    let panel = Panel::new("Height over the anchor", "time, s", "m")
        .legend(SeriesLabelPosition::LowerMiddle);
    draw(height, &panel, &lines)?;

    let [true_elevation, true_azimuth, true_tension] = &data.true_tether;
    let [elevation, azimuth, estimated_tension] = &data.tether;
    let degrees = |s: &Series| s.iter().map(|&(t, a)| (t, a.to_degrees())).collect::<Series>();
    let [by_inertia, force_by_inertia, setpoint] = &data.taut;
    let mut lines = vec![
        Line::new("truth", TRUTH, degrees(true_elevation)),
        Line::new("estimate", ESTIMATE, degrees(elevation)),
        Line::new("", TRUTH, degrees(true_azimuth)),
        Line::new("", ESTIMATE, degrees(azimuth)),
    ];
    if !by_inertia.is_empty() {
        lines.push(Line::new("by inertia alone", THIRD, degrees(by_inertia)));
        lines.push(Line::new("set-point", SETPOINT, degrees(setpoint)));
    }
    // Where the curves leave room.
    let legend = if by_inertia.is_empty() {
        SeriesLabelPosition::UpperMiddle
    } else {
        SeriesLabelPosition::UpperLeft
    };
    let title = "Tether elevation (upper) and azimuth (lower)";
    draw(angles, &Panel::new(title, "time, s", "deg").legend(legend), &lines)?;

    let mut lines = vec![
        Line::new("truth", TRUTH_FAINT, true_tension.clone()),
        Line::new("estimate", ESTIMATE, estimated_tension.clone()),
        Line::new("asked of the winch", SETPOINT, data.winch.clone()),
    ];
    if !force_by_inertia.is_empty() {
        lines.push(Line::new("by inertia alone", THIRD, force_by_inertia.clone()));
    }
    let panel =
        Panel::new("Tether tension", "time, s", "N").legend(SeriesLabelPosition::LowerMiddle);
    draw(tension, &panel, &lines)?;
    root.present()?;
    Ok(())
}

/// North up, East to the right, both to the same scale.
fn draw_map(area: &Area, data: &FlightData) -> Result<(), Box<dyn Error>> {
    let track = |[north, east, _]: &[Series; 3]| {
        east.iter().zip(north).map(|(&(_, e), &(_, n))| (e, n)).collect::<Series>()
    };
    let lines = [
        Line::new("truth", TRUTH, track(&data.truth)),
        Line::new("estimate", ESTIMATE, track(&data.estimate)),
        Line::new("set-point", SETPOINT, track(&data.setpoint)),
    ];
    let (xs, ys) = (bounds(&lines, |p| p.0), bounds(&lines, |p| p.1));
    let (width, height) = area.dim_in_pixel();
    let shape = (f64::from(width) - 78.0) / (f64::from(height) - 96.0);
    let half = ((xs.end - xs.start) / shape).max(ys.end - ys.start) / 2.0;
    let (cx, cy) = (f64::midpoint(xs.start, xs.end), f64::midpoint(ys.start, ys.end));
    let (x_range, y_range) = ((cx - half * shape)..(cx + half * shape), (cy - half)..(cy + half));
    let panel = Panel::new("Map (the dot is the anchor)", "East, m", "North, m")
        .legend(SeriesLabelPosition::MiddleRight);
    plot(area, &panel, &lines, (x_range, y_range), &[(0.0, 0.0)])
}
