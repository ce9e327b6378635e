//! Measured against predicted.

use super::identify::{AHEAD, Identified, SKIPPED, recommend};
use super::prepare::{Prepared, RATE};
use crate::report::chart::{ESTIMATE, Line, Panel, Points, THIRD, TRUTH, draw};
use plotters::prelude::*;
use std::error::Error;
use std::path::Path;

/// s of the validation half in the close view.
const CLOSE: f64 = 8.0;

/// The best predictor and a simulation over the validation half, whole and close.
///
/// # Errors
/// The drawing's error.
pub fn draw_predictions(
    data: &Prepared,
    found: &[Result<Identified, String>],
    path: &Path,
) -> Result<(), Box<dyn Error>> {
    let mean = data.means.last().copied().unwrap_or(0.0);
    let series = |values: &[f64], until: f64| -> Points {
        let rows = values.iter().enumerate().map(|(i, y)| (i as f64 / RATE, y + mean));
        rows.skip(SKIPPED).take_while(|(t, _)| *t <= until).collect()
    };
    let best = recommend(found);
    let simulated = found.iter().flatten().find(|m| m.name.starts_with("process"));
    let root = SVGBackend::new(path, (1200, 820)).into_drawing_area();
    root.fill(&WHITE)?;
    let (top, bottom) = root.split_vertically(410);
    for (area, title, until) in
        [(top, "Thrust, validation half", f64::INFINITY), (bottom, "Its first seconds", CLOSE)]
    {
        let mut lines = vec![Line::new("measured", TRUTH, series(&data.validation.output, until))];
        if let Some(m) = simulated {
            let name = format!("{}, simulated: fit {:.1} %", m.name, m.fit);
            lines.push(Line::new(name, THIRD, series(&m.predicted, until)));
        }
        if let Some(m) = best {
            let name = format!("{}, {AHEAD} samples ahead: fit {:.1} %", m.name, m.fit);
            lines.push(Line::new(name, ESTIMATE, series(&m.predicted, until)));
        }
        draw(&area, &Panel::new(title, "time, s", "N"), &lines)?;
    }
    root.present()?;
    Ok(())
}
