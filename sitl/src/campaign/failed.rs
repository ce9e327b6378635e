//! Failed flights: each one's scenario as a file, its log, and the command that flies it again.

use super::file::Campaign;
use super::outcome::LONGEST;
use super::parallel;
use super::row::Row;
use crate::flight::Flight;
use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

const FOLDER: &str = "failed";

/// A failed flight that was kept.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Kept {
    /// Which flight.
    pub index: u64,
    /// Its seed.
    pub seed: u64,
    /// Why it failed.
    pub reason: String,
    /// What was drawn, as a scenario's file.
    pub scenario: PathBuf,
    /// What the vehicle logged.
    pub log: PathBuf,
}

impl Kept {
    /// Flies it again, to the same end.
    #[must_use]
    pub fn command(&self) -> String {
        let path = self.scenario.display().to_string();
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "/._-".contains(c);
        let path = if path.chars().all(is_plain) {
            path
        } else {
            format!("'{}'", path.replace('\'', r"'\''"))
        };
        format!("cargo sitl --headless --scenario {path} --seed {} --duration {LONGEST}", self.seed)
    }
}

/// Keeps the first `count` flights that failed: `failed/flight-000123.toml` and its log beside it.
///
/// # Errors
/// One line naming the file.
pub fn keep_failed(
    campaign: &Campaign,
    rows: &[Row],
    out: &Path,
    count: usize,
    jobs: usize,
) -> Result<Vec<Kept>, String> {
    let failed: Vec<_> = rows.iter().filter(|row| !row.pass).take(count).collect();
    if failed.is_empty() {
        return Ok(Vec::new());
    }
    let folder = out.join(FOLDER);
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let keep = |row: &&Row| keep(campaign, row, &folder);
    parallel::map(&failed, jobs, keep, |_| {}).into_iter().collect()
}

fn keep(campaign: &Campaign, row: &Row, folder: &Path) -> Result<Kept, String> {
    let path = |ending: &str| folder.join(format!("flight-{:06}.{ending}", row.index));
    let kept = Kept {
        index: row.index,
        seed: row.seed,
        reason: row.reason.clone(),
        scenario: path("toml"),
        log: path("ulg"),
    };
    let named = |path: &Path, e: io::Error| format!("{}: {e}", path.display());
    fs::write(&kept.scenario, campaign.scenario_text(row.index)?)
        .map_err(|e| named(&kept.scenario, e))?;
    let scenario = campaign.scenario(row.index)?;
    let params = scenario.params().map_err(|e| e.0)?;
    let file = File::create(&kept.log).map_err(|e| named(&kept.log, e))?;
    let log = BufWriter::with_capacity(1 << 16, file);
    let mut flight = Flight::new(&scenario, params, row.seed, log).map_err(|e| e.0)?;
    flight.fly(LONGEST);
    flight.finish_log().map_err(|e| named(&kept.log, e))?;
    Ok(kept)
}

/// What an earlier campaign kept in a folder.
pub(super) fn files(out: &Path) -> impl Iterator<Item = PathBuf> {
    let entries = fs::read_dir(out.join(FOLDER)).into_iter().flatten().flatten();
    entries.map(|entry| entry.path()).filter(|path| {
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        name.starts_with("flight-") && (name.ends_with(".toml") || name.ends_with(".ulg"))
    })
}
