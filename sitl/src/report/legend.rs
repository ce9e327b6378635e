//! Where a legend covers the least.

use super::chart::{CAPTION, FONT, Line, MARGIN, X_LABELS, Y_LABELS, thin};
use plotters::prelude::SeriesLabelPosition;
use std::ops::Range;

/// Of a letter, as a share of its height.
const LETTER: f64 = 0.55;
/// The stroke before a name and the frame round all, pixels.
const FRAME: (f64, f64) = (48.0, 14.0);

/// Places by preference, with the share of the free width and height that lies before them.
fn places() -> [(SeriesLabelPosition, [f64; 2]); 9] {
    use SeriesLabelPosition as P;
    [
        (P::UpperRight, [1.0, 0.0]),
        (P::UpperLeft, [0.0, 0.0]),
        (P::LowerRight, [1.0, 1.0]),
        (P::LowerLeft, [0.0, 1.0]),
        (P::UpperMiddle, [0.5, 0.0]),
        (P::LowerMiddle, [0.5, 1.0]),
        (P::MiddleRight, [1.0, 0.5]),
        (P::MiddleLeft, [0.0, 0.5]),
        (P::MiddleMiddle, [0.5, 0.5]),
    ]
}

/// Points as the eye sees them, a few pixels apart, as shares of width and height from the upper left corner.
fn seen(line: &Line, x: &Range<f64>, y: &Range<f64>) -> Vec<[f64; 2]> {
    const STEPS: u32 = 16;
    let share =
        |(a, b): (f64, f64)| [(a - x.start) / (x.end - x.start), (y.end - b) / (y.end - y.start)];
    let points: Vec<_> = thin(&line.points).map(share).collect();
    if !line.is_joined() {
        return points;
    }
    let between = points.iter().zip(points.iter().skip(1)).flat_map(|([a, b], [c, d])| {
        (0..STEPS).map(move |i| {
            let part = f64::from(i) / f64::from(STEPS);
            [a + (c - a) * part, b + (d - b) * part]
        })
    });
    between.collect()
}

/// The place at which the legend of these lines hides the fewest of them, on an area of so many pixels.
pub fn roomiest(
    lines: &[Line],
    (x, y): (&Range<f64>, &Range<f64>),
    (width, height): (u32, u32),
) -> SeriesLabelPosition {
    let named = lines.iter().filter(|line| !line.name.is_empty());
    let (rows, longest) = named
        .fold((0, 0), |(rows, longest), line| (rows + 1, longest.max(line.name.chars().count())));
    let inner = [
        f64::from(width.saturating_sub(Y_LABELS + 2 * MARGIN)),
        f64::from(height.saturating_sub(X_LABELS + CAPTION + 2 * MARGIN)),
    ];
    let font = f64::from(FONT);
    let size = [longest as f64 * font * LETTER + FRAME.0, f64::from(rows) * font * 1.3 + FRAME.1];
    let [wide, high] = [size[0] / inner[0].max(1.0), size[1] / inner[1].max(1.0)];
    let points: Vec<_> = lines.iter().flat_map(|line| seen(line, x, y)).collect();
    let hidden = |[a, b]: [f64; 2]| {
        let (left, top) = ((1.0 - wide) * a, (1.0 - high) * b);
        let is_hidden = |[px, py]: &&[f64; 2]| {
            (left..=left + wide).contains(px) && (top..=top + high).contains(py)
        };
        points.iter().filter(is_hidden).count()
    };
    let [first, ..] = places();
    let best = places().into_iter().min_by_key(|(_, at)| hidden(*at));
    best.unwrap_or(first).0
}

#[cfg(test)]
mod tests {
    use super::super::chart::TRUTH;
    use super::*;

    fn at(points: Vec<(f64, f64)>) -> SeriesLabelPosition {
        let lines = [Line::new("a name", TRUTH, points)];
        roomiest(&lines, (&(0.0..1.0), &(0.0..1.0)), (600, 380))
    }

    #[test]
    fn a_legend_goes_where_no_line_is() {
        use SeriesLabelPosition as P;
        assert!(matches!(at(vec![(0.0, 0.1), (1.0, 0.1)]), P::UpperRight));
        assert!(matches!(at(vec![(0.0, 0.0), (1.0, 1.0)]), P::UpperLeft));
        assert!(matches!(at(vec![(0.0, 0.95), (1.0, 0.95)]), P::LowerRight));
        let corners = vec![(0.0, 0.0), (0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (0.0, 0.0)];
        assert!(matches!(at(corners), P::MiddleMiddle));
    }
}
