//! A part of a campaign: some of its flights, into a folder of its own.

use crate::input::wrong;
use pyo3::prelude::*;
use std::path::PathBuf;
use tautline_sitl::campaign::Campaign;

/// Flights of a campaign.
#[pyfunction]
pub fn campaign_size(file: PathBuf) -> PyResult<u64> {
    Campaign::load(&file).map(|(campaign, _)| campaign.seeds).map_err(wrong)
}

/// Flies the `index`-th of `count` parts, from 1, one flight after the other; a line of JSON a flight.
#[pyfunction]
pub fn campaign_shard(
    py: Python,
    file: PathBuf,
    out: PathBuf,
    index: u64,
    count: u64,
) -> PyResult<u64> {
    if !(1..=count).contains(&index) {
        return Err(wrong(format!("part {index} of {count}: expected 1 <= I <= N")));
    }
    let (campaign, scenario) = Campaign::load(&file).map_err(wrong)?;
    let seeds = campaign.shard(index, count);
    let mut lines = String::new();
    for seed in &seeds {
        let seed = std::slice::from_ref(seed);
        let outcomes = py.detach(|| campaign.run(&scenario, seed, 1, |_| {}));
        for outcome in outcomes {
            lines.push_str(&serde_json::to_string(&outcome).map_err(wrong)?);
            lines.push('\n');
        }
        py.check_signals()?;
    }
    std::fs::create_dir_all(&out)?;
    std::fs::write(out.join("flights.jsonl"), lines)?;
    Ok(seeds.len() as u64)
}
