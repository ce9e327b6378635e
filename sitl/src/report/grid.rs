//! Several charts on one sheet.

use super::chart::{Line, Panel, draw};
use plotters::prelude::*;
use std::error::Error;
use std::path::Path;

/// A chart and its lines.
pub type Cell = (Panel, Vec<Line>);

/// Rows by columns, left to right and down; each chart 600 by 380.
///
/// # Errors
/// The drawing's error.
pub fn grid(path: &Path, columns: usize, cells: &[Cell]) -> Result<(), Box<dyn Error>> {
    let columns = columns.max(1);
    let rows = cells.len().div_ceil(columns);
    let size = (600 * columns as u32, 380 * rows as u32);
    let root = SVGBackend::new(path, size).into_drawing_area();
    root.fill(&WHITE)?;
    for (area, (panel, lines)) in root.split_evenly((rows, columns)).iter().zip(cells) {
        draw(area, panel, lines)?;
    }
    root.present()?;
    Ok(())
}
