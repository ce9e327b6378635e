//! A campaign in a few figures: how many passed, how sure that is, and how every figure is spread.

use super::row::{Cell, Header, Kind, Row, content_hash};
use crate::metrics::Interval;
use serde::Serialize;
use std::collections::BTreeMap;

/// A share with the interval that holds the true one in 95 of 100 campaigns, after Wilson.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Share {
    /// What was seen.
    pub share: f64,
    /// Lower bound.
    pub wilson_95_low: f64,
    /// Upper bound.
    pub wilson_95_high: f64,
}

/// How a figure is spread over the flights that have it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Figure {
    /// Flights that have it.
    pub count: usize,
    /// Mean.
    pub mean: f64,
    /// 5th percentile.
    pub p5: f64,
    /// Median.
    pub p50: f64,
    /// 95th percentile.
    pub p95: f64,
    /// Largest.
    pub max: f64,
}

/// `summary.json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// What the campaign shows.
    pub title: String,
    /// Name of its file.
    pub campaign: String,
    /// Name of its scenario's file.
    pub scenario: String,
    /// The campaign's seed.
    pub seed: u64,
    /// Commit of the simulator, if it is a release of one.
    pub revision: Option<String>,
    /// Flights of the whole campaign.
    pub flights: u64,
    /// Flights in this table.
    pub flown: usize,
    /// Flown to the end, not lost, within all limits.
    pub passed: usize,
    /// The others.
    pub failed: usize,
    /// Of these, lost or not flown to the end.
    pub incomplete: usize,
    /// Passed of flown.
    pub pass_share: Share,
    /// Why they failed, and how many.
    pub reasons: BTreeMap<String, usize>,
    /// Every figure that any flight has.
    pub figures: BTreeMap<String, Figure>,
    /// [`content_hash`].
    pub content_sha256: String,
}

/// Of a table, or a part of it.
#[must_use]
pub fn summary(header: &Header, rows: &[Row]) -> Summary {
    let count = |is: fn(&Row) -> bool| rows.iter().filter(|row| is(row)).count();
    let passed = count(|row| row.pass);
    let share = Interval::of_share(passed, rows.len());
    let mut reasons = BTreeMap::new();
    for row in rows.iter().filter(|row| !row.pass) {
        *reasons.entry(row.reason.clone()).or_default() += 1;
    }
    let columns = header.figures.iter().enumerate().filter(|(_, c)| c.kind == Kind::Number);
    let figures = columns.filter_map(|(i, column)| {
        let numbers = rows.iter().filter_map(|row| match row.figures.get(i) {
            Some(Some(Cell::Number(x))) => Some(*x),
            _ => None,
        });
        Some((column.name.clone(), figure(numbers.collect())?))
    });
    Summary {
        title: header.title.clone(),
        campaign: header.campaign.clone(),
        scenario: header.scenario.clone(),
        seed: header.seed,
        revision: header.revision.clone(),
        flights: header.flights,
        flown: rows.len(),
        passed,
        failed: rows.len() - passed,
        incomplete: count(|row| !row.complete),
        pass_share: Share {
            share: share.middle,
            wilson_95_low: share.least,
            wilson_95_high: share.most,
        },
        reasons,
        figures: figures.collect(),
        content_sha256: content_hash(header, rows),
    }
}

/// `None` without values.
fn figure(mut values: Vec<f64>) -> Option<Figure> {
    values.sort_by(f64::total_cmp);
    let max = *values.last()?;
    let count = values.len();
    let mean = values.iter().sum::<f64>() / count as f64;
    let at = |share| percentile(&values, share).unwrap_or(max);
    Some(Figure { count, mean, p5: at(0.05), p50: at(0.5), p95: at(0.95), max })
}

/// Between the two values that the share falls between, in proportion: NumPy's default.
fn percentile(sorted: &[f64], share: f64) -> Option<f64> {
    let place = share * (sorted.len().checked_sub(1)? as f64);
    let below = *sorted.get(place.floor() as usize)?;
    let above = *sorted.get(place.ceil() as usize)?;
    Some(below + (above - below) * place.fract())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_those_of_numpy() {
        // numpy.percentile([4, 1, 3, 2, 10], [5, 50, 95]).
        let f = figure(vec![4.0, 1.0, 3.0, 2.0, 10.0]).unwrap();
        for (got, want) in [(f.p5, 1.2), (f.p50, 3.0), (f.p95, 8.8), (f.max, 10.0), (f.mean, 4.0)] {
            assert!((got - want).abs() < 1e-12, "{f:?}");
        }
        assert_eq!(figure(Vec::new()), None);
        assert!((figure(vec![7.0]).unwrap().p95 - 7.0).abs() < 1e-12);
    }
}
