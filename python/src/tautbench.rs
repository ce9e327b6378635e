//! A data set of TautBench: its readings one by one, and scores of what an estimator said of them.

use crate::input::wrong;
use crate::sensors::sensors;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use pythonize::pythonize;
use std::path::PathBuf;
use tautline_sitl::tautbench::{
    DataSet, FlightScore, TIME, Table, one, reading, score_flight, summarize,
};

/// A folder that `sitl tautbench generate` wrote.
#[pyclass(module = "tautline._native")]
pub struct TautBench(DataSet);

/// As JSON's own types.
fn object(
    py: Python<'_>,
    value: serde_json::Result<serde_json::Value>,
) -> PyResult<Bound<'_, PyAny>> {
    Ok(pythonize(py, &value.map_err(wrong)?)?)
}

#[pymethods]
impl TautBench {
    #[new]
    fn new(folder: PathBuf) -> PyResult<Self> {
        DataSet::open(&folder).map(Self).map_err(wrong)
    }

    /// The manifest's flights.
    fn flights<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        object(py, serde_json::to_value(&self.0.manifest.flights))
    }

    /// What an estimator may read of a flight, in the order of the times.
    fn readings<'py>(&self, py: Python<'py>, flight: &str) -> PyResult<Bound<'py, PyList>> {
        let flight = self.0.flight(flight).map_err(wrong)?;
        let table = py.detach(|| self.0.readings(flight)).map_err(wrong)?;
        let rows = table.rows.iter().filter_map(|row| reading(row));
        let rows =
            rows.map(|(time, read)| sensors(py, time, &read)).collect::<PyResult<Vec<_>>>()?;
        PyList::new(py, rows)
    }

    /// A flight's errors as JSON, of its estimates: times, s, names of the other columns, and a row of them for each time.
    fn score(
        &self,
        py: Python,
        flight: &str,
        times: Vec<f64>,
        names: Vec<String>,
        rows: Vec<Vec<Option<f64>>>,
    ) -> PyResult<String> {
        let flight = self.0.flight(flight).map_err(wrong)?;
        let mut table = Table::new([TIME].into_iter().chain(names.iter().map(String::as_str)));
        table.rows = times
            .into_iter()
            .zip(rows)
            .map(|(time, row)| std::iter::once(Some(time)).chain(row).collect())
            .collect();
        let score = py
            .detach(|| score_flight(&self.0, flight, &table))
            .map_err(|e| wrong(format!("{}: {e}", flight.name)))?;
        serde_json::to_string(&score).map_err(wrong)
    }
}

/// All flights' errors together: the object that `sitl tautbench score --json` prints, and its tables as Markdown.
#[pyfunction]
pub fn tautbench_summary<'py>(
    py: Python<'py>,
    name: &str,
    flights: Vec<String>,
) -> PyResult<Bound<'py, PyDict>> {
    let flights = flights.iter().map(|text| serde_json::from_str(text));
    let flights = flights.collect::<Result<Vec<FlightScore>, _>>().map_err(wrong)?;
    let score = summarize(name, flights);
    let all = PyDict::new(py);
    all.set_item("summary", object(py, serde_json::to_value(&score))?)?;
    all.set_item("markdown", one(&score))?;
    Ok(all)
}
