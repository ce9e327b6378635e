//! The picture of a flight: map, height, tether angles, tension.

use super::read::{FlightData, Series};
use plotters::coord::Shift;
use plotters::prelude::*;
use std::error::Error;
use std::ops::Range;
use std::path::Path;

const TRUTH: RGBColor = RGBColor(30, 30, 30);
/// For a truth that ripples: the estimate must show through.
const TRUTH_FAINT: RGBColor = RGBColor(165, 165, 165);
const ESTIMATE: RGBColor = RGBColor(200, 60, 40);
const SETPOINT: RGBColor = RGBColor(40, 110, 200);
const SIZE: (u32, u32) = (1200, 900);

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// One line with its name.
struct Line {
    name: &'static str,
    colour: RGBColor,
    points: Series,
}

impl Line {
    fn new(name: &'static str, colour: RGBColor, points: Series) -> Self {
        Self { name, colour, points }
    }
}

/// Texts of one chart.
struct Panel {
    title: &'static str,
    x: &'static str,
    y: &'static str,
    legend: SeriesLabelPosition,
}

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
    let panel = Panel {
        title: "Height over the anchor",
        x: "time, s",
        y: "m",
        legend: SeriesLabelPosition::LowerMiddle,
    };
    over_time(height, &panel, &lines)?;

    let [true_elevation, true_azimuth, true_tension] = &data.true_tether;
    let [elevation, azimuth, estimated_tension] = &data.tether;
    let degrees = |s: &Series| s.iter().map(|&(t, a)| (t, a.to_degrees())).collect::<Series>();
    let lines = [
        Line::new("truth", TRUTH, degrees(true_elevation)),
        Line::new("estimate", ESTIMATE, degrees(elevation)),
        Line::new("", TRUTH, degrees(true_azimuth)),
        Line::new("", ESTIMATE, degrees(azimuth)),
    ];
    let title = "Tether elevation (upper) and azimuth (lower)";
    over_time(
        angles,
        &Panel { title, x: "time, s", y: "deg", legend: SeriesLabelPosition::UpperMiddle },
        &lines,
    )?;

    let lines = [
        Line::new("truth", TRUTH_FAINT, true_tension.clone()),
        Line::new("estimate", ESTIMATE, estimated_tension.clone()),
        Line::new("asked of the winch", SETPOINT, data.winch.clone()),
    ];
    let panel = Panel {
        title: "Tether tension",
        x: "time, s",
        y: "N",
        legend: SeriesLabelPosition::LowerMiddle,
    };
    over_time(tension, &panel, &lines)?;
    root.present()?;
    Ok(())
}

fn bounds(lines: &[Line], pick: impl Fn(&(f64, f64)) -> f64) -> Range<f64> {
    let values =
        lines.iter().flat_map(|line| line.points.iter().map(&pick)).filter(|v| v.is_finite());
    let (low, high) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    if low > high {
        return 0.0..1.0;
    }
    let margin = ((high - low) * 0.05).max(0.1);
    (low - margin)..(high + margin)
}

/// At most about this many points per line: enough for a picture.
fn thin(points: &Series) -> impl Iterator<Item = (f64, f64)> + '_ {
    points.iter().copied().step_by((points.len() / 800).max(1))
}

fn over_time(area: &Area, panel: &Panel, lines: &[Line]) -> Result<(), Box<dyn Error>> {
    plot(area, panel, lines, (bounds(lines, |p| p.0), bounds(lines, |p| p.1)), &[])
}

fn plot(
    area: &Area,
    panel: &Panel,
    lines: &[Line],
    (x_range, y_range): (Range<f64>, Range<f64>),
    marks: &[(f64, f64)],
) -> Result<(), Box<dyn Error>> {
    let mut chart = ChartBuilder::on(area)
        .caption(panel.title, ("sans-serif", 20))
        .margin(12)
        .x_label_area_size(42)
        .y_label_area_size(54)
        .build_cartesian_2d(x_range, y_range)?;
    chart
        .configure_mesh()
        .x_desc(panel.x)
        .y_desc(panel.y)
        .light_line_style(RGBColor(240, 240, 240))
        .label_style(("sans-serif", 15))
        .axis_desc_style(("sans-serif", 16))
        .draw()?;
    for line in lines {
        let colour = line.colour;
        let drawn =
            chart.draw_series(LineSeries::new(thin(&line.points), colour.stroke_width(2)))?;
        if !line.name.is_empty() {
            drawn.label(line.name).legend(move |(x, y)| {
                PathElement::new(vec![(x, y), (x + 22, y)], colour.stroke_width(2))
            });
        }
    }
    chart.draw_series(marks.iter().map(|&at| Circle::new(at, 5, SETPOINT.filled())))?;
    chart
        .configure_series_labels()
        .position(panel.legend.clone())
        .background_style(WHITE.mix(0.85))
        .border_style(RGBColor(180, 180, 180))
        .label_font(("sans-serif", 15))
        .draw()?;
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
    let panel = Panel {
        title: "Map (the dot is the anchor)",
        x: "East, m",
        y: "North, m",
        legend: SeriesLabelPosition::MiddleRight,
    };
    plot(area, &panel, &lines, (x_range, y_range), &[(0.0, 0.0)])
}
