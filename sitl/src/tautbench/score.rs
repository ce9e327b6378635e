//! An estimator over the whole data set: each cell's figures over its flights with their 95 % intervals, and all cells
//! together.

use super::columns::Table;
use super::data::{DataSet, FlightEntry};
use super::errors::{Errors, compare};
use super::estimates::Estimates;
use crate::campaign::{Share, parallel};
use crate::metrics::Interval;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// One flight's errors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FlightScore {
    /// Of the manifest.
    pub flight: String,
    /// Of the grid.
    pub cell: String,
    /// Of the cell.
    pub group: String,
    /// How far off.
    #[serde(flatten)]
    pub errors: Errors,
}

/// A figure of a cell: root mean square over its flights, between the bounds that hold it in 95 of 100 cases.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Figure {
    /// The figure itself.
    pub rms: f64,
    /// By Student's distribution of the squares; `None` for a single flight.
    pub low_95: Option<f64>,
    /// The same.
    pub high_95: Option<f64>,
}

/// Errors of several flights, in the units of [`Errors`].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CellScore {
    /// Of the grid.
    pub cell: String,
    /// Of the cell.
    pub group: String,
    /// How many.
    pub flights: usize,
    /// m.
    pub position_m: Option<Figure>,
    /// rad.
    pub elevation_rad: Option<Figure>,
    /// rad.
    pub azimuth_rad: Option<Figure>,
    /// N.
    pub tension_n: Option<Figure>,
    /// rad.
    pub attitude_rad: Option<Figure>,
    /// Mean over the flights.
    pub position_consistency: Option<f64>,
    /// Mean over the flights.
    pub tension_consistency: Option<f64>,
    /// Mean over the flights.
    pub answered: f64,
    /// Of the flights, after Wilson.
    pub lost: Share,
}

/// How a figure is spread over the cells.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Quartiles {
    /// A quarter of the cells is below.
    pub p25: f64,
    /// Half of them.
    pub p50: f64,
    /// Three quarters.
    pub p75: f64,
}

/// An estimator's whole result.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Score {
    /// Its name.
    pub name: String,
    /// All flights.
    pub flights: Vec<FlightScore>,
    /// In the order of the manifest.
    pub cells: Vec<CellScore>,
    /// Over the cells, m.
    pub position_m: Option<Quartiles>,
    /// rad.
    pub elevation_rad: Option<Quartiles>,
    /// rad.
    pub azimuth_rad: Option<Quartiles>,
    /// N.
    pub tension_n: Option<Quartiles>,
    /// rad.
    pub attitude_rad: Option<Quartiles>,
    /// 1 where it knows how sure it is.
    pub position_consistency: Option<Quartiles>,
    /// Of all flights, after Wilson.
    pub lost: Share,
}

/// A flight's estimates against its truth.
///
/// # Errors
/// One line: what is wrong with the table, or with the truth.
pub fn score_flight(
    data: &DataSet,
    flight: &FlightEntry,
    table: &Table,
) -> Result<FlightScore, String> {
    let estimates = Estimates::check(table, flight.duration_s)?;
    let truth = data.truth(flight)?;
    let errors = compare(&truth, &estimates).map_err(|e| format!("{}: {e}", flight.name))?;
    Ok(FlightScore {
        flight: flight.name.clone(),
        cell: flight.cell.clone(),
        group: flight.group.clone(),
        errors,
    })
}

/// A folder with a file of estimates for each flight: `NAME.csv` or `NAME.parquet`.
///
/// # Errors
/// One line naming the file that is missing or wrong.
pub fn score_folder(data: &DataSet, name: &str, folder: &Path) -> Result<Score, String> {
    let one = |flight: &FlightEntry| {
        let file = |end: &str| folder.join(format!("{}.{end}", flight.name));
        let path = [file("csv"), file("parquet")].into_iter().find(|path| path.exists());
        let path = path.ok_or_else(|| {
            format!("{}: no such file, nor one that ends in .parquet", file("csv").display())
        })?;
        let table = Table::read(&path)?;
        score_flight(data, flight, &table).map_err(|e| format!("{}: {e}", path.display()))
    };
    let scores = parallel::map(&data.manifest.flights, parallel::cores(), one, |_| {});
    Ok(summarize(name, scores.into_iter().collect::<Result<_, _>>()?))
}

/// The cells' figures, and all together.
#[must_use]
pub fn summarize(name: &str, flights: Vec<FlightScore>) -> Score {
    let mut names: Vec<&str> = Vec::new();
    for flight in &flights {
        if names.last() != Some(&flight.cell.as_str()) {
            names.push(&flight.cell);
        }
    }
    let of_cell = |name: &&str| {
        let flights: Vec<_> = flights.iter().filter(|flight| flight.cell == **name).collect();
        cell(name, &flights)
    };
    let cells: Vec<_> = names.iter().map(of_cell).collect();
    let over = |of: fn(&CellScore) -> Option<f64>| quartiles(cells.iter().filter_map(of).collect());
    let lost = flights.iter().filter(|flight| flight.errors.lost).count();
    Score {
        name: name.to_owned(),
        position_m: over(|cell| Some(cell.position_m?.rms)),
        elevation_rad: over(|cell| Some(cell.elevation_rad?.rms)),
        azimuth_rad: over(|cell| Some(cell.azimuth_rad?.rms)),
        tension_n: over(|cell| Some(cell.tension_n?.rms)),
        attitude_rad: over(|cell| Some(cell.attitude_rad?.rms)),
        position_consistency: over(|cell| cell.position_consistency),
        lost: share(lost, flights.len()),
        cells,
        flights,
    }
}

fn cell(name: &str, flights: &[&FlightScore]) -> CellScore {
    let values = |of: fn(&Errors) -> Option<f64>| -> Vec<f64> {
        flights.iter().filter_map(|flight| of(&flight.errors)).collect()
    };
    let mean = |of: fn(&Errors) -> Option<f64>| {
        let values = values(of);
        (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
    };
    let figure = |of: fn(&Errors) -> Option<f64>| figure(&values(of));
    CellScore {
        cell: name.to_owned(),
        group: flights.first().map(|flight| flight.group.clone()).unwrap_or_default(),
        flights: flights.len(),
        position_m: figure(|errors| errors.position_rms_m),
        elevation_rad: figure(|errors| errors.elevation_rms_rad),
        azimuth_rad: figure(|errors| errors.azimuth_rms_rad),
        tension_n: figure(|errors| errors.tension_rms_n),
        attitude_rad: figure(|errors| errors.attitude_rms_rad),
        position_consistency: mean(|errors| errors.position_consistency),
        tension_consistency: mean(|errors| errors.tension_consistency),
        answered: mean(|errors| Some(errors.answered)).unwrap_or(0.0),
        lost: share(flights.iter().filter(|flight| flight.errors.lost).count(), flights.len()),
    }
}

fn figure(values: &[f64]) -> Option<Figure> {
    match (Interval::of_rms(values), values) {
        (Some(all), _) => {
            Some(Figure { rms: all.middle, low_95: Some(all.least), high_95: Some(all.most) })
        }
        (None, [one]) => Some(Figure { rms: *one, low_95: None, high_95: None }),
        _ => None,
    }
}

fn share(happened: usize, count: usize) -> Share {
    let interval = Interval::of_share(happened, count);
    Share { share: interval.middle, wilson_95_low: interval.least, wilson_95_high: interval.most }
}

fn quartiles(mut values: Vec<f64>) -> Option<Quartiles> {
    values.sort_by(f64::total_cmp);
    let at =
        |share: f64| values.get((share * (values.len() as f64 - 1.0)).round() as usize).copied();
    Some(Quartiles { p25: at(0.25)?, p50: at(0.5)?, p75: at(0.75)? })
}
