//! TautBench: the same data twice, scores that are what they should be, and nothing wrong scored silently.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::float_cmp,
    reason = "tests"
)]

#[path = "tautbench/data.rs"]
mod data;
#[path = "tautbench/refusals.rs"]
mod refusals;
#[path = "tautbench/scores.rs"]
mod scores;

use std::fs;
use std::path::{Path, PathBuf};
use tautline_sitl::tautbench::{DataSet, Table};

/// The flights that the repository holds.
fn sample() -> DataSet {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../sitl/tautbench/sample");
    DataSet::open(&folder).unwrap()
}

/// A folder of a test's own, anew.
fn folder(name: &str) -> PathBuf {
    let path =
        std::env::temp_dir().join(format!("tautline-tautbench-{name}-{}", std::process::id()));
    let _ = fs::remove_dir_all(&path);
    path
}

/// A folder of estimates: of each flight of the sample, what is made of its truth.
fn estimates(name: &str, of: impl Fn(&Table) -> Table) -> PathBuf {
    let (data, out) = (sample(), folder(name));
    fs::create_dir_all(&out).unwrap();
    for flight in &data.manifest.flights {
        let text = of(&data.truth(flight).unwrap()).to_csv();
        fs::write(out.join(format!("{}.csv", flight.name)), text).unwrap();
    }
    out
}

/// These columns of a table.
fn columns(table: &Table, names: &[&str]) -> Table {
    let at: Vec<_> = names.iter().map(|name| table.at(name).unwrap()).collect();
    let pick = |row: &Vec<Option<f64>>| at.iter().map(|at| row[*at]).collect();
    let mut picked = Table::new(names.iter().copied());
    picked.rows = table.rows.iter().map(pick).collect();
    picked
}

const PLACE: [&str; 4] = ["time_s", "north_m", "east_m", "down_m"];
