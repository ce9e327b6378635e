//! One chart: lines with names over two labelled axes.

use super::legend;
use plotters::coord::Shift;
use plotters::prelude::*;
use std::borrow::Cow;
use std::error::Error;
use std::ops::Range;

/// A place to draw on.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
/// Points.
pub type Points = Vec<(f64, f64)>;

/// Room that a chart's axes and title take, and the letters of its legend, pixels.
pub(super) const MARGIN: u32 = 12;
pub(super) const CAPTION: u32 = 20;
pub(super) const X_LABELS: u32 = 42;
pub(super) const Y_LABELS: u32 = 54;
pub(super) const FONT: u32 = 15;

/// Colours, one meaning each.
pub const TRUTH: RGBColor = RGBColor(30, 30, 30);
/// For a truth that ripples: the estimate must show through.
pub const TRUTH_FAINT: RGBColor = RGBColor(165, 165, 165);
/// What the firmware believes.
pub const ESTIMATE: RGBColor = RGBColor(200, 60, 40);
/// Set-points.
pub const SETPOINT: RGBColor = RGBColor(40, 110, 200);
/// A third series beside truth and estimate.
pub const THIRD: RGBColor = RGBColor(40, 140, 90);

/// How a series is drawn.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Stroke {
    Solid,
    Dashed,
    Dots,
}

/// One line with its name; an empty name stays out of the legend.
#[derive(Clone)]
pub struct Line {
    pub(super) name: Cow<'static, str>,
    colour: RGBColor,
    pub(super) points: Points,
    stroke: Stroke,
}

impl Line {
    /// Solid.
    pub fn new(name: impl Into<Cow<'static, str>>, colour: RGBColor, points: Points) -> Self {
        Self { name: name.into(), colour, points, stroke: Stroke::Solid }
    }
    /// Dashed.
    #[must_use]
    pub fn dashed(self) -> Self {
        Self { stroke: Stroke::Dashed, ..self }
    }
    /// A dot for each point: figures that somebody printed.
    #[must_use]
    pub fn dots(self) -> Self {
        Self { stroke: Stroke::Dots, ..self }
    }
    /// Whether the eye sees it between its points, too.
    pub(super) fn is_joined(&self) -> bool {
        self.stroke != Stroke::Dots
    }
}

/// Texts of one chart.
pub struct Panel {
    /// Above it.
    pub title: Cow<'static, str>,
    /// Along it, with unit.
    pub x: &'static str,
    /// Beside it, with unit.
    pub y: &'static str,
}

impl Panel {
    /// All three.
    pub fn new(title: impl Into<Cow<'static, str>>, x: &'static str, y: &'static str) -> Self {
        Self { title: title.into(), x, y }
    }
}

/// Range of a coordinate over all lines, with a margin.
pub fn bounds(lines: &[Line], pick: impl Fn(&(f64, f64)) -> f64) -> Range<f64> {
    let values =
        lines.iter().flat_map(|line| line.points.iter().map(&pick)).filter(|v| v.is_finite());
    let (low, high) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    if low > high {
        return 0.0..1.0;
    }
    let margin = ((high - low) * 0.05).max(1e-3 + 0.02 * high.abs().max(low.abs()));
    (low - margin)..(high + margin)
}

/// At most about this many points per line: enough for a picture. A gap at what is not finite.
pub(super) fn thin(points: &Points) -> impl Iterator<Item = (f64, f64)> + Clone + '_ {
    let step = (points.len() / 800).max(1);
    points.iter().copied().step_by(step).filter(|(x, y)| x.is_finite() && y.is_finite())
}

/// Axes as wide as the lines.
pub fn draw(area: &Area, panel: &Panel, lines: &[Line]) -> Result<(), Box<dyn Error>> {
    plot(area, panel, lines, (bounds(lines, |p| p.0), bounds(lines, |p| p.1)), &[])
}

/// On given axes, with dots.
pub fn plot(
    area: &Area,
    panel: &Panel,
    lines: &[Line],
    (x_range, y_range): (Range<f64>, Range<f64>),
    marks: &[(f64, f64)],
) -> Result<(), Box<dyn Error>> {
    let legend = legend::roomiest(lines, (&x_range, &y_range), area.dim_in_pixel());
    let mut chart = ChartBuilder::on(area)
        .caption(&panel.title, ("sans-serif", CAPTION))
        .margin(MARGIN)
        .x_label_area_size(X_LABELS)
        .y_label_area_size(Y_LABELS)
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
        let points = thin(&line.points);
        let drawn = match line.stroke {
            Stroke::Solid => chart.draw_series(LineSeries::new(points, colour.stroke_width(2)))?,
            Stroke::Dashed => {
                chart.draw_series(DashedLineSeries::new(points, 7, 5, colour.stroke_width(2)))?
            }
            Stroke::Dots => {
                chart.draw_series(points.map(|at| Circle::new(at, 4, colour.filled())))?
            }
        };
        if !line.name.is_empty() {
            drawn.label(line.name.as_ref()).legend(move |(x, y)| {
                PathElement::new(vec![(x, y), (x + 22, y)], colour.stroke_width(2))
            });
        }
    }
    chart.draw_series(marks.iter().map(|&at| Circle::new(at, 5, SETPOINT.filled())))?;
    if lines.iter().all(|line| line.name.is_empty()) {
        return Ok(());
    }
    chart
        .configure_series_labels()
        .position(legend)
        .background_style(WHITE.mix(0.85))
        .border_style(RGBColor(180, 180, 180))
        .label_font(("sans-serif", FONT))
        .draw()?;
    Ok(())
}
