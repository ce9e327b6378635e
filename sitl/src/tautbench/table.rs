//! Every method of the firmware over a data set.

use super::data::{DataSet, FlightEntry};
use super::grid::Grid;
use super::methods::{self, Method};
use super::score::{FlightScore, Score, score_flight, summarize};
use crate::campaign::parallel;
use crate::replay::read;

/// Flies every flight again, to the byte as the data has it, and runs the methods over its recorded inputs; `each` is called
/// after every flight.
///
/// # Errors
/// One line naming the flight: data of another simulator, or a folder that is not whole.
pub fn table(data: &DataSet, mut each: impl FnMut(bool)) -> Result<Vec<(Method, Score)>, String> {
    let grid = Grid::shipped()?;
    let flights = &data.manifest.flights;
    let one = |flight: &FlightEntry| scores(data, &grid, flight);
    let scored = parallel::map(flights, parallel::cores(), one, |one| each(one.is_ok()));
    let scored: Vec<_> = scored.into_iter().flat_map(split).collect::<Result<_, _>>()?;
    let of = |method| {
        let own = scored.iter().filter(|(other, _)| *other == method);
        (method, summarize(method.name(), own.map(|(_, score)| score.clone()).collect()))
    };
    Ok(Method::ALL.into_iter().map(of).collect())
}

type Scored = Vec<(Method, FlightScore)>;

fn split(scored: Result<Scored, String>) -> Vec<Result<(Method, FlightScore), String>> {
    match scored {
        Ok(all) => all.into_iter().map(Ok).collect(),
        Err(e) => vec![Err(e)],
    }
}

fn scores(data: &DataSet, grid: &Grid, flight: &FlightEntry) -> Result<Scored, String> {
    let named = |e: String| format!("{}: {e}", flight.name);
    let recorded = data.fly_again(grid, flight)?;
    let (items, gap) = read(&recorded.log).map_err(named)?;
    if let Some(gap) = gap {
        return Err(named(gap));
    }
    let said = methods::run(&items, &flight.about).map_err(named)?;
    let score = |(method, table): (Method, super::Table)| {
        let score = score_flight(data, flight, &table);
        score.map(|score| (method, score)).map_err(|e| named(format!("{}: {e}", method.name())))
    };
    said.into_iter().map(score).collect()
}
