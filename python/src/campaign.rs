//! Campaigns in parts: each into a folder of its own, by whatever process, and all of them joined.

use crate::input::wrong;
use pyo3::prelude::*;
use pythonize::pythonize;
use std::path::PathBuf;
use tautline_sitl::campaign::{
    Campaign, Merged, Session, Settings, Shard, keep_failed, merge, write_tables,
};

/// Flights of a campaign.
#[pyfunction]
pub fn campaign_size(file: PathBuf) -> PyResult<u64> {
    Campaign::load(&file).map(|campaign| campaign.flights()).map_err(wrong)
}

/// Flies what is missing of the `index`-th of `count` parts, from 1, on this thread; how many flights the part has.
#[pyfunction]
pub fn campaign_shard(
    py: Python,
    file: PathBuf,
    out: PathBuf,
    index: u64,
    count: u64,
) -> PyResult<usize> {
    let shard = Shard { part: index, of: count };
    let settings = Settings { out, shard, jobs: 1, resume: true, keep_logs: 0 };
    py.detach(|| {
        let campaign = Campaign::load(&file)?;
        let rows = Session::open(&campaign, &settings)?.fly(|_| {})?;
        Ok(rows.len())
    })
    .map_err(|line: String| wrong(line))
}

/// Joins the folders of all parts into `flights.parquet` and `summary.json`, flies the first `keep_logs` flights that
/// failed once more with a log; the summary.
#[pyfunction]
pub fn campaign_merge<'py>(
    py: Python<'py>,
    file: PathBuf,
    folders: Vec<PathBuf>,
    out: PathBuf,
    keep_logs: usize,
    jobs: usize,
) -> PyResult<Bound<'py, PyAny>> {
    let summary = py
        .detach(|| {
            let campaign = Campaign::load(&file)?;
            let Merged { header, rows } = merge(&folders)?;
            header.same_campaign(campaign.header())?;
            let summary = write_tables(&out, &header, &rows)?;
            keep_failed(&campaign, &rows, &out, keep_logs, jobs)?;
            Ok(summary)
        })
        .map_err(|line: String| wrong(line))?;
    let object = serde_json::to_value(summary).map_err(wrong)?;
    Ok(pythonize(py, &object)?)
}
