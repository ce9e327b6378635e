//! Scores as Markdown.

use super::data::{DataSet, FlightEntry};
use super::grid::Grid;
use super::methods::Method;
use super::score::{CellScore, Figure, Quartiles, Score};
use crate::campaign::Share;
use std::fmt::Write;

const NONE: &str = "–";
/// Of figures; those without a place before the point need more.
const DIGITS: i32 = 2;

/// A quantity: its name, the factor from its unit to the shown one, and where its figures are.
struct Quantity {
    name: &'static str,
    factor: f64,
    cell: fn(&CellScore) -> Option<Figure>,
    all: fn(&Score) -> Option<Quartiles>,
}

const DEGREES: f64 = 180.0 / std::f64::consts::PI;

const QUANTITIES: [Quantity; 5] = [
    Quantity { name: "position, m", factor: 1.0, cell: |c| c.position_m, all: |s| s.position_m },
    Quantity {
        name: "elevation, °",
        factor: DEGREES,
        cell: |c| c.elevation_rad,
        all: |s| s.elevation_rad,
    },
    Quantity {
        name: "azimuth, °",
        factor: DEGREES,
        cell: |c| c.azimuth_rad,
        all: |s| s.azimuth_rad,
    },
    Quantity { name: "tension, N", factor: 1.0, cell: |c| c.tension_n, all: |s| s.tension_n },
    Quantity {
        name: "attitude, °",
        factor: DEGREES,
        cell: |c| c.attitude_rad,
        all: |s| s.attitude_rad,
    },
];

/// Two significant digits, without an exponent.
fn short(x: f64) -> String {
    let places = if x.abs() < 1e-9 { DIGITS } else { DIGITS - 1 - x.abs().log10().floor() as i32 };
    format!("{x:.*}", places.clamp(0, 4) as usize)
}

fn quartiles(all: Option<Quartiles>, factor: f64) -> String {
    all.map_or_else(
        || NONE.to_owned(),
        |Quartiles { p25, p50, p75 }| {
            format!("{} ({}–{})", short(p50 * factor), short(p25 * factor), short(p75 * factor))
        },
    )
}

fn figure(figure: Option<Figure>, factor: f64) -> String {
    match figure {
        None => NONE.to_owned(),
        Some(Figure { rms, low_95: Some(low), high_95: Some(high) }) => {
            format!("{} ({}–{})", short(rms * factor), short(low * factor), short(high * factor))
        }
        Some(Figure { rms, .. }) => short(rms * factor),
    }
}

fn percent(Share { share, wilson_95_low, wilson_95_high }: Share) -> String {
    let all = [share, wilson_95_low, wilson_95_high].map(|x| format!("{:.0}", 100.0 * x));
    let [share, low, high] = all;
    format!("{share} ({low}–{high})")
}

fn heads(text: &mut String, first: &str, heads: impl IntoIterator<Item = impl AsRef<str>>) {
    let _ = write!(text, "| {first} |");
    let mut count = 1;
    for head in heads {
        let _ = write!(text, " {} |", head.as_ref());
        count += 1;
    }
    let _ = writeln!(text, "\n|{}", "---|".repeat(count));
}

/// A row for each estimator: medians over the cells.
fn overall<'a>(text: &mut String, scores: impl Iterator<Item = &'a Score>) {
    let names = QUANTITIES.iter().map(|quantity| quantity.name);
    heads(text, "estimator", ["flights"].into_iter().chain(names).chain(["error²/σ²", "lost, %"]));
    for score in scores {
        let _ = write!(text, "| {} | {} |", score.name, score.flights.len());
        for quantity in &QUANTITIES {
            let _ = write!(text, " {} |", quartiles((quantity.all)(score), quantity.factor));
        }
        let sure = quartiles(score.position_consistency, 1.0);
        let lost = if score.flights.is_empty() { NONE.to_owned() } else { percent(score.lost) };
        let _ = writeln!(text, " {sure} | {lost} |");
    }
}

/// One estimator: all cells together, then each.
#[must_use]
pub fn one(score: &Score) -> String {
    let mut text = String::new();
    overall(&mut text, std::iter::once(score));
    text.push('\n');
    let names = QUANTITIES.iter().map(|quantity| quantity.name);
    heads(&mut text, "cell", names.chain(["error²/σ²", "answered, %", "lost, %"]));
    for cell in &score.cells {
        let _ = write!(text, "| {} |", cell.cell);
        for quantity in &QUANTITIES {
            let _ = write!(text, " {} |", figure((quantity.cell)(cell), quantity.factor));
        }
        let sure = cell.position_consistency.map_or_else(|| NONE.to_owned(), short);
        let _ = writeln!(text, " {sure} | {:.0} | {} |", 100.0 * cell.answered, percent(cell.lost));
    }
    text
}

/// All of them beside each other: medians over the cells, then position, elevation and tension of each cell, and what can't
/// be flown.
#[must_use]
pub fn page(data: &DataSet, grid: &Grid, scores: &[(Method, Score)]) -> String {
    let flights = &data.manifest.flights;
    let ended = flights.iter().filter(|flight| flight.ended.is_some()).count();
    let mut text = format!(
        "{} flights, of which {ended} did not end as they were to: a cut line, a vehicle that is lost. {} more have no \
         moment that is scored, since their take-off failed, and are left out.\n\n",
        flights.len(),
        data.manifest.left_out.len()
    );
    overall(&mut text, scores.iter().map(|(_, score)| score));
    for quantity in QUANTITIES.iter().filter(|quantity| !quantity.name.starts_with('a')) {
        let gives = |score: &Score| score.cells.iter().any(|cell| (quantity.cell)(cell).is_some());
        let giving: Vec<_> = scores.iter().map(|(_, score)| score).filter(|s| gives(s)).collect();
        let _ = writeln!(text, "\n### {}\n", capital(quantity.name));
        heads(&mut text, "cell", giving.iter().map(|score| score.name.as_str()));
        for name in cells(flights) {
            let _ = write!(text, "| {name} |");
            for score in &giving {
                let cell = score.cells.iter().find(|cell| cell.cell == name);
                let shown = figure(cell.and_then(quantity.cell), quantity.factor);
                let lost =
                    cell.filter(|cell| cell.lost.share > 0.0).map_or_else(String::new, |cell| {
                        let count = (cell.lost.share * cell.flights as f64).round();
                        format!(" **{count} lost**")
                    });
                let _ = write!(text, " {shown}{lost} |");
            }
            text.push('\n');
        }
    }
    does_not_apply(&mut text, flights);
    text.push_str(
        "\n### What cannot be flown\n\n| line and vehicle | the firmware's answer |\n|---|---|\n",
    );
    for left_out in &grid.left_out {
        let _ = writeln!(text, "| {} | refused: {} |", left_out.name, left_out.refused);
    }
    text
}

fn capital(name: &str) -> String {
    let mut letters = name.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}

fn cells(flights: &[FlightEntry]) -> Vec<&str> {
    let mut names: Vec<&str> = flights.iter().map(|flight| flight.cell.as_str()).collect();
    names.dedup();
    names
}

fn does_not_apply(text: &mut String, flights: &[FlightEntry]) {
    text.push_str("\n### Where a method does not apply\n\n| method | flights without it | why |\n|---|---|---|\n");
    for method in Method::ALL {
        let whys: Vec<_> =
            flights.iter().filter_map(|flight| method.why_not(&flight.about)).collect();
        if let Some(why) = whys.first() {
            let _ = writeln!(
                text,
                "| {} | {} of {} | {why} |",
                method.name(),
                whys.len(),
                flights.len()
            );
        }
    }
}
