//! Curves in space, from above and aside. World NED in, drawn with height upwards.

use plotters::prelude::*;
use std::borrow::Cow;
use std::error::Error;
use std::ops::Range;
use std::path::Path;

/// One curve with its name.
pub struct Curve {
    name: Cow<'static, str>,
    colour: RGBColor,
    points: Vec<[f64; 3]>,
}

impl Curve {
    /// Points in NED, m.
    pub fn new(
        name: impl Into<Cow<'static, str>>,
        colour: RGBColor,
        points: Vec<[f64; 3]>,
    ) -> Self {
        Self { name: name.into(), colour, points }
    }
}

/// Equal scales on all axes, so that a circle looks like one.
fn ranges(curves: &[Curve]) -> [Range<f64>; 3] {
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    for point in curves.iter().flat_map(|curve| &curve.points) {
        for ((low, high), x) in low.iter_mut().zip(&mut high).zip(point) {
            *low = low.min(*x);
            *high = high.max(*x);
        }
    }
    let spans = low.iter().zip(high).map(|(l, h)| h - l);
    let half = 0.55 * spans.fold(0.1, f64::max);
    let mut ranges = [0.0..1.0, 0.0..1.0, 0.0..1.0];
    for ((range, l), h) in ranges.iter_mut().zip(low).zip(high) {
        let middle = if l <= h { 0.5 * (l + h) } else { 0.0 };
        *range = (middle - half)..(middle + half);
    }
    ranges
}

/// Draws them in one box, 900 by 760.
///
/// # Errors
/// The drawing's error.
pub fn curves(path: &Path, title: &str, curves: &[Curve]) -> Result<(), Box<dyn Error>> {
    let root = SVGBackend::new(path, (900, 760)).into_drawing_area();
    root.fill(&WHITE)?;
    let [north, east, down] = ranges(curves);
    let mut chart = ChartBuilder::on(&root)
        .caption(title, ("sans-serif", 22))
        .margin(16)
        .build_cartesian_3d(east, -down.end..-down.start, north)?;
    chart.with_projection(|mut view| {
        view.yaw = 0.7;
        view.pitch = 0.35;
        view.scale = 0.85;
        view.into_matrix()
    });
    chart
        .configure_axes()
        .light_grid_style(RGBColor(240, 240, 240))
        .label_style(("sans-serif", 15))
        .max_light_lines(3)
        .draw()?;
    for curve in curves {
        let colour = curve.colour;
        let step = (curve.points.len() / 2000).max(1);
        let points = curve.points.iter().step_by(step).map(|[n, e, d]| (*e, -d, *n));
        chart
            .draw_series(LineSeries::new(points, colour.stroke_width(2)))?
            .label(curve.name.as_ref())
            .legend(move |(x, y)| {
                PathElement::new(vec![(x, y), (x + 22, y)], colour.stroke_width(2))
            });
    }
    chart
        .configure_series_labels()
        .background_style(WHITE.mix(0.85))
        .border_style(RGBColor(180, 180, 180))
        .label_font(("sans-serif", 16))
        .draw()?;
    root.present()?;
    Ok(())
}
