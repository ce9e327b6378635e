//! Pictures shaped like the papers'.

use crate::bench::planar::{LawKind, PlanarSummary, Row, Trace};
use crate::report::chart::{
    ESTIMATE, Line, Panel, Points, SETPOINT, THIRD, TRUTH, bounds, draw, plot,
};
use plotters::prelude::*;
use std::borrow::Cow;
use std::error::Error;
use std::path::Path;

type Drawn = Result<(), Box<dyn Error>>;

/// Runs of the same kind with their names.
pub struct TimeSeries {
    runs: Vec<(String, Trace)>,
    law: LawKind,
}

impl TimeSeries {
    /// One name for each.
    pub fn new(traces: Vec<Trace>, names: impl IntoIterator<Item = String>, law: LawKind) -> Self {
        Self { runs: names.into_iter().zip(traces).collect(), law }
    }
}

const COLOURS: [RGBColor; 3] = [SETPOINT, THIRD, ESTIMATE];

fn over(trace: &Trace, pick: impl Fn(&Row) -> f64) -> Points {
    trace.rows.iter().map(|row| (row.time, pick(row))).collect()
}

/// Names the second output.
fn second(law: LawKind) -> (&'static str, &'static str, f64) {
    match law {
        LawKind::Force => ("Link force", "N", 1.0),
        _ => ("Pitch", "deg", 180.0 / std::f64::consts::PI),
    }
}

fn second_of(law: LawKind, row: &Row) -> f64 {
    let (.., scale) = second(law);
    scale * if law == LawKind::Force { row.link_force } else { row.state[2] }
}

/// Both outputs over their references, and the inputs.
pub fn tracking(series: &TimeSeries, path: &Path) -> Drawn {
    let root = SVGBackend::new(path, (1200, 760)).into_drawing_area();
    root.fill(&WHITE)?;
    let areas = root.split_evenly((2, 2));
    let [elevation, output, thrust, torque] = areas.as_slice() else { return Ok(()) };
    let (name, unit, scale) = second(series.law);
    let lines = |pick: &dyn Fn(&Row) -> f64, setpoint: Option<&dyn Fn(&Row) -> f64>| -> Vec<Line> {
        let mut lines = Vec::new();
        for ((run, trace), colour) in series.runs.iter().zip(COLOURS) {
            if let Some(setpoint) = setpoint {
                let name = if lines.is_empty() { "reference" } else { "" };
                lines.push(Line::new(name, TRUTH, over(trace, setpoint)).dashed());
            }
            lines.push(Line::new(run.clone(), colour, over(trace, pick)));
        }
        lines
    };
    let degrees = |row: &Row| row.state[0].to_degrees();
    let setpoint = |row: &Row| row.elevation_reference.to_degrees();
    draw(elevation, &Panel::new("Elevation", "time, s", "deg"), &lines(&degrees, Some(&setpoint)))?;
    let law = series.law;
    draw(
        output,
        &Panel::new(name, "time, s", unit),
        &lines(&|row| second_of(law, row), Some(&|row| row.second_reference * scale)),
    )?;
    draw(thrust, &Panel::new("Thrust", "time, s", "N"), &lines(&|r| r.thrust, None))?;
    draw(torque, &Panel::new("Torque", "time, s", "N m"), &lines(&|r| r.torque, None))?;
    root.present()?;
    Ok(())
}

/// Duration, value, mean and deviation of whole run and phases.
type ScanPoint = (f64, f64, [(f64, f64); 4]);

/// One parameter over its range: whole run and three phases, three durations.
pub struct ScanPanel {
    what: Cow<'static, str>,
    points: Vec<ScanPoint>,
}

impl ScanPanel {
    /// Empty.
    pub fn new(what: impl Into<Cow<'static, str>>) -> Self {
        Self { what: what.into(), points: Vec::new() }
    }
    /// A run; one that was lost leaves a gap, as in the articles.
    pub fn add(&mut self, duration: f64, value: f64, s: &PlanarSummary) {
        if !s.is_lost() {
            let phases = s.article.map(|p| (p.mean(), p.deviation()));
            self.points.push((duration, value, phases));
        }
    }
}

/// A row for each parameter; a column for the whole run and each phase.
pub fn scan(panels: &[ScanPanel], title: &str, path: &Path) -> Drawn {
    let height = 300 * panels.len() as u32 + 40;
    let root = SVGBackend::new(path, (1500, height)).into_drawing_area();
    root.fill(&WHITE)?;
    let root = root.titled(title, ("sans-serif", 24))?;
    let areas = root.split_evenly((panels.len(), 4));
    for (panel, row) in panels.iter().zip(areas.chunks(4)) {
        let columns = ["whole run", "phase 1: transient", "phase 2: step", "phase 3: steady"];
        for (phase, (area, column)) in row.iter().zip(columns).enumerate() {
            let mut lines = Vec::new();
            for (duration, colour) in super::journal::DURATIONS.into_iter().zip(COLOURS) {
                let pick = |side: f64| -> Points {
                    panel
                        .points
                        .iter()
                        .filter(|(d, ..)| d.to_bits() == duration.to_bits())
                        .filter_map(|(_, x, phases)| {
                            phases.get(phase).map(|(mean, dev)| (*x, mean + side * dev))
                        })
                        .collect()
                };
                let name = if phase == 0 { format!("{duration} s") } else { String::new() };
                lines.push(Line::new(name, colour, pick(0.0)));
                lines.push(Line::new("", colour.mix_with_white(), pick(1.0)).dashed());
                lines.push(Line::new("", colour.mix_with_white(), pick(-1.0)).dashed());
            }
            let text = format!("{}: {column}", panel.what);
            let caption = Panel::new(text, "", "error, 1");
            draw(area, &caption, &lines)?;
        }
    }
    root.present()?;
    Ok(())
}

trait Pale {
    fn mix_with_white(&self) -> RGBColor;
}
impl Pale for RGBColor {
    fn mix_with_white(&self) -> RGBColor {
        let pale = |c: u8| 255 - (255 - c) / 2;
        RGBColor(pale(self.0), pale(self.1), pale(self.2))
    }
}

/// Truth, estimate and reference under noise, and the inputs.
pub fn noisy(traces: &[Trace], path: &Path) -> Drawn {
    let Some(trace) = traces.first() else { return Ok(()) };
    let root = SVGBackend::new(path, (1200, 1060)).into_drawing_area();
    root.fill(&WHITE)?;
    let areas = root.split_evenly((3, 2));
    let [elevation, force, pitch, rate, error, thrust] = areas.as_slice() else { return Ok(()) };
    let degrees = |x: f64| x.to_degrees();
    let three = |truth: &dyn Fn(&Row) -> f64,
                 estimate: &dyn Fn(&Row) -> f64,
                 setpoint: Option<&dyn Fn(&Row) -> f64>| {
        let mut lines = vec![
            Line::new("estimate", ESTIMATE, over(trace, estimate)),
            Line::new("truth", TRUTH, over(trace, truth)),
        ];
        if let Some(setpoint) = setpoint {
            lines.push(Line::new("reference", SETPOINT, over(trace, setpoint)).dashed());
        }
        lines
    };
    let caption = |title: &'static str, unit| Panel::new(title, "time, s", unit);
    draw(
        elevation,
        &caption("Elevation", "deg"),
        &three(
            &|r| degrees(r.state[0]),
            &|r| degrees(r.estimate[0]),
            Some(&|r| degrees(r.elevation_reference)),
        ),
    )?;
    draw(
        force,
        &caption("Link force", "N"),
        &three(&|r| r.link_force, &|r| r.link_force_estimate, Some(&|r| r.second_reference)),
    )?;
    draw(
        pitch,
        &caption("Pitch", "deg"),
        &three(&|r| degrees(r.state[2]), &|r| degrees(r.estimate[2]), None),
    )?;
    draw(
        rate,
        &caption("Elevation rate", "rad/s"),
        &three(&|r| r.state[1], &|r| r.estimate[1], None),
    )?;
    let errors = [
        Line::new("elevation, deg", SETPOINT, over(trace, |r| degrees(r.elevation_error()))),
        Line::new("link force, N", ESTIMATE, over(trace, |r| r.second_reference - r.link_force)),
    ];
    draw(error, &caption("Tracking errors", "deg, N"), &errors)?;
    let inputs = [
        Line::new("thrust, N", SETPOINT, over(trace, |r| r.thrust)),
        Line::new("torque, N m", ESTIMATE, over(trace, |r| r.torque)),
    ];
    draw(thrust, &caption("Inputs", "N, N m"), &inputs)?;
    root.present()?;
    Ok(())
}

/// The vehicle at instants of the step; colour is time, width of the link its force, dashes tension.
pub fn strobe(trace: &Trace, length: f64, path: &Path) -> Drawn {
    let root = SVGBackend::new(path, (1000, 620)).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .caption(
            "Stroboscopic view, 2 s to 4.5 s: dashed link in tension, solid in compression",
            ("sans-serif", 20),
        )
        .margin(12)
        .x_label_area_size(42)
        .y_label_area_size(54)
        .build_cartesian_2d(-1.25 * length..1.25 * length, -0.15 * length..1.35 * length)?;
    chart
        .configure_mesh()
        .x_desc("x, m")
        .y_desc("z, m")
        .light_line_style(RGBColor(240, 240, 240))
        .label_style(("sans-serif", 15))
        .axis_desc_style(("sans-serif", 16))
        .draw()?;
    let (begin, end) = (2.0, 4.5);
    let count = 14;
    let strongest = trace.rows.iter().map(|r| r.link_force.abs()).fold(1e-9, f64::max);
    for k in 0..=count {
        let share = f64::from(k) / f64::from(count);
        let time = begin + (end - begin) * share;
        let Some(row) = trace.rows.iter().find(|r| r.time >= time) else { break };
        let colour = HSLColor(0.66 * (1.0 - share), 0.8, 0.42);
        let [phi, _, theta, _] = row.state;
        let at = (length * phi.cos(), length * phi.sin());
        // Thinner under tension, wider under compression, as a bar would be.
        let width = (3.0 - 2.2 * row.link_force / strongest).max(0.6).round() as u32;
        let link = vec![(0.0, 0.0), at];
        if row.link_force >= 0.0 {
            let dashes = DashedLineSeries::new(link, 6, 5, colour.stroke_width(width));
            chart.draw_series(dashes)?;
        } else {
            chart.draw_series(LineSeries::new(link, colour.stroke_width(width)))?;
        }
        let thrust = 0.018 * row.thrust;
        let tip = (at.0 + thrust * theta.sin(), at.1 + thrust * theta.cos());
        let half = 0.14 * length;
        let beam = vec![
            (at.0 - half * theta.cos(), at.1 + half * theta.sin()),
            (at.0 + half * theta.cos(), at.1 - half * theta.sin()),
        ];
        chart.draw_series(LineSeries::new(beam, colour.stroke_width(4)))?;
        chart.draw_series(LineSeries::new(vec![at, tip], colour.stroke_width(2)))?;
        chart.draw_series(std::iter::once(Circle::new(tip, 3, colour.filled())))?;
    }
    let mut marks = Vec::new();
    for k in [0, count / 2, count] {
        let share = f64::from(k) / f64::from(count);
        marks.push((share, HSLColor(0.66 * (1.0 - share), 0.8, 0.42)));
    }
    for (share, colour) in marks {
        let x = length * (-1.15 + 0.55 * share);
        chart.draw_series(std::iter::once(Circle::new((x, 1.27 * length), 6, colour.filled())))?;
        let label = format!("{:.2} s", begin + (end - begin) * share);
        chart.draw_series(std::iter::once(Text::new(
            label,
            (x + 0.03 * length, 1.295 * length),
            ("sans-serif", 15),
        )))?;
    }
    root.present()?;
    Ok(())
}

/// Outputs over references, inputs.
pub fn controller(trace: &Trace, path: &Path) -> Drawn {
    let series = TimeSeries {
        runs: vec![("flown, from wrong initial state and estimate".into(), trace.clone())],
        law: LawKind::Force,
    };
    tracking(&series, path)
}

/// The first 0.7 s of the observer.
pub fn observer_zoom(trace: &Trace, path: &Path) -> Drawn {
    let root = SVGBackend::new(path, (1200, 760)).into_drawing_area();
    root.fill(&WHITE)?;
    let areas = root.split_evenly((2, 3));
    let early = Trace {
        rows: trace.rows.iter().filter(|r| r.time <= 0.7).copied().collect(),
        summary: trace.summary,
    };
    let panels = [
        ("Elevation", "rad"),
        ("Elevation rate", "rad/s"),
        ("Pitch", "rad"),
        ("Pitch rate", "rad/s"),
    ];
    for (k, (area, (title, unit))) in areas.iter().zip(panels).enumerate() {
        let of = |x: &[f64; 4]| x.get(k).copied().unwrap_or(0.0);
        let lines = [
            Line::new("truth", TRUTH, over(&early, |r| of(&r.state))),
            Line::new("estimate", ESTIMATE, over(&early, |r| of(&r.estimate))).dashed(),
        ];
        draw(area, &Panel::new(title, "time, s", unit), &lines)?;
    }
    if let [.., force, residual] = areas.as_slice() {
        let lines = [
            Line::new("truth", TRUTH, over(&early, |r| r.link_force)),
            Line::new("estimate", ESTIMATE, over(&early, |r| r.link_force_estimate)).dashed(),
        ];
        draw(force, &Panel::new("Link force", "time, s", "N"), &lines)?;
        let lines = [
            Line::new("branch A", SETPOINT, over(&early, |r| r.residuals[0])),
            Line::new("branch B", THIRD, over(&early, |r| r.residuals[1])),
        ];
        draw(residual, &Panel::new("Prediction errors", "time, s", "m/s²"), &lines)?;
    }
    root.present()?;
    Ok(())
}

/// Error over the sampling rate, both logarithmic; a line that ends was lost below that rate.
pub fn forms(curves: &[(&'static str, &'static str, Points)], path: &Path) -> Drawn {
    let root = SVGBackend::new(path, (1500, 520)).into_drawing_area();
    root.fill(&WHITE)?;
    let areas = root.split_evenly((1, 3));
    let colours = [TRUTH, SETPOINT, THIRD, RGBColor(150, 90, 170), ESTIMATE];
    for (group, area) in curves.chunks(5).zip(&areas) {
        let lines: Vec<Line> = group
            .iter()
            .zip(colours)
            .map(|((_, form, points), colour)| Line::new(*form, colour, points.clone()))
            .collect();
        let dots: Points = group.iter().flat_map(|(.., points)| points.clone()).collect();
        let title = group.first().map_or("", |(name, ..)| name);
        let panel = Panel::new(
            title,
            "log10 of the rate in Hz",
            "log10 of the largest elevation error in rad",
        );
        let x = bounds(&lines, |p| p.0);
        let y = bounds(&lines, |p| p.1);
        let room = (y.end - y.start) * 0.35;
        plot(area, &panel, &lines, (x, y.start..y.end + room), &dots)?;
    }
    root.present()?;
    Ok(())
}

/// Largest elevation error over the motors' time constant, without and with it in the observer; a line that
/// ends was lost beyond.
pub fn lags(curves: &[(bool, String, Points)], path: &Path) -> Drawn {
    let root = SVGBackend::new(path, (1200, 460)).into_drawing_area();
    root.fill(&WHITE)?;
    let areas = root.split_evenly((1, 2));
    for (area, modelled) in areas.iter().zip([false, true]) {
        let shown = curves.iter().filter(|(is_modelled, ..)| *is_modelled == modelled);
        let lines: Vec<Line> = shown
            .enumerate()
            .map(|(k, (_, name, points))| {
                let colour = COLOURS.get(k % COLOURS.len()).copied().unwrap_or(TRUTH);
                let line = Line::new(name.clone(), colour, points.clone());
                if k < COLOURS.len() { line } else { line.dashed() }
            })
            .collect();
        let title = if modelled { "Observer told of the lag" } else { "Observer not told" };
        let panel =
            Panel::new(title, "time constant of the motors, s", "largest elevation error, deg");
        draw(area, &panel, &lines)?;
    }
    root.present()?;
    Ok(())
}
