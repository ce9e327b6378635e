//! Campaigns: a part of one flown into a folder of its own, and the parts joined.

use crate::input::wrong;
use pyo3::prelude::*;
use serde_json::{Map, Value, json};
use std::path::PathBuf;
use tautline_sitl::campaign::{
    Campaign, Cell, Header, Merged, Row, Session, Settings, Shard, merge, write_tables,
};

/// Failed flights that a part keeps with their logs.
const KEEP_LOGS: usize = 5;

/// Flights of a campaign.
#[pyfunction]
pub fn campaign_size(file: PathBuf) -> PyResult<u64> {
    Campaign::load(&file).map(|campaign| campaign.flights()).map_err(wrong)
}

/// Flies the `index`-th of `count` parts, from 1, or what is missing of it.
#[pyfunction]
pub fn campaign_shard(
    py: Python,
    file: PathBuf,
    out: PathBuf,
    index: u64,
    count: u64,
) -> PyResult<u64> {
    let campaign = Campaign::load(&file).map_err(wrong)?;
    let shard = Shard { part: index, of: count };
    let settings = Settings { out, shard, jobs: 1, resume: true, keep_logs: KEEP_LOGS };
    let fly = || {
        let rows = Session::open(&campaign, &settings)?.fly(|_| {})?;
        campaign.finish(&settings, &rows)?;
        Ok(rows.len() as u64)
    };
    py.detach(fly).map_err(|e: String| wrong(e))
}

/// Joins the parts: tables in `out`; a JSON text with the summary and the rows.
#[pyfunction]
pub fn campaign_merge(py: Python, folders: Vec<PathBuf>, out: PathBuf) -> PyResult<String> {
    let join = || {
        let Merged { header, rows } = merge(&folders)?;
        let summary = write_tables(&out, &header, &rows)?;
        let rows: Vec<Value> = rows.iter().map(|row| object(&header, row)).collect();
        serde_json::to_string(&json!({ "summary": summary, "rows": rows }))
            .map_err(|e| e.to_string())
    };
    py.detach(join).map_err(|e: String| wrong(e))
}

/// A row by the names of its columns, as the Parquet table has them.
fn object(header: &Header, row: &Row) -> Value {
    let cell = |cell: &Option<Cell>| serde_json::to_value(cell).unwrap_or_default();
    let mut object = Map::new();
    object.insert("index".into(), json!(row.index));
    object.insert("seed".into(), json!(row.seed));
    let varied = header.varied.iter().zip(&row.varied);
    object.extend(varied.map(|(column, value)| (column.name.clone(), cell(value))));
    object.insert("complete".into(), json!(row.complete));
    object.insert("pass".into(), json!(row.pass));
    object.insert("reason".into(), json!(row.reason));
    let figures = header.figures.iter().zip(&row.figures);
    object.extend(figures.map(|(column, value)| (column.name.clone(), cell(value))));
    Value::Object(object)
}
