//! The data set on disk: a manifest, and for each flight its readings and its truth.

use super::columns::Table;
use super::grid::{Cell, Grid};
use super::record::{Recorded, has_scored, record};
use crate::campaign::{hexadecimal, parallel};
use crate::scenario::{Scenario, TetherKind};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::fs;
use std::path::{Path, PathBuf};

const MANIFEST: &str = "manifest.json";
/// Of the data set's files.
const FORMAT: u32 = 1;

/// `manifest.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// Of the data set's files.
    pub format: u32,
    /// Commit of the simulator, if it is a release of one.
    pub revision: Option<String>,
    /// In the order of the grid, then of the seeds.
    pub flights: Vec<FlightEntry>,
    /// Without a moment that is scored: a take-off that failed.
    pub left_out: Vec<Unscored>,
}

/// A flight that is not part of the data.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Unscored {
    /// As of the others.
    pub name: String,
    /// What became of it.
    pub ended: String,
}

/// One flight.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FlightEntry {
    /// Of its files, `NAME.readings.parquet` and `NAME.truth.parquet`, and of the file of its estimates.
    pub name: String,
    /// Of the grid.
    pub cell: String,
    /// Of the cell.
    pub group: String,
    /// Everything random in it.
    pub seed: u64,
    /// From the first step.
    pub duration_s: f64,
    /// Of whoever estimates: what stands in the scenario, too.
    pub about: About,
    /// Why it was lost or its mission not flown to the end, if so; it is scored all the same.
    pub ended: Option<String>,
    /// SHA-256 of the scenario with every key, as TOML.
    pub scenario_sha256: String,
    /// SHA-256 of the file.
    pub readings_sha256: String,
    /// The same.
    pub truth_sha256: String,
}

/// What an estimator may know of vehicle and line before the flight.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct About {
    /// Of the vehicle.
    pub mass_kg: f64,
    /// Whether a winch reels the line; otherwise its length is fixed.
    pub has_winch: bool,
    /// Where it is fixed.
    pub line_length_m: Option<f64>,
    /// Of the line.
    pub line_density_kgpm: f64,
}

impl About {
    fn of(scenario: &Scenario) -> Self {
        let has_winch = scenario.tether.kind == TetherKind::Winch;
        Self {
            mass_kg: scenario.vehicle.mass,
            has_winch,
            line_length_m: (!has_winch).then_some(scenario.tether.length),
            line_density_kgpm: scenario.tether.line_density,
        }
    }
}

/// SHA-256, hexadecimal.
#[must_use]
pub fn sha256(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

/// Where it is written, and what beside.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The folder; made if it is not there.
    pub out: PathBuf,
    /// Flights of a cell.
    pub seeds: u64,
    /// Also each flight's log, some 25 times as large as the rest.
    pub logs: bool,
    /// Flights at the same time.
    pub jobs: usize,
}

/// Flies the cells and writes the data set; `each` is called after every flight with whether it was flown to its end.
///
/// # Errors
/// One line naming the file, or the flight.
pub fn generate(
    cells: &[&Cell],
    settings: &Settings,
    mut each: impl FnMut(bool),
) -> Result<Manifest, String> {
    let out = &settings.out;
    if out.join(MANIFEST).exists() {
        return Err(format!("{}: holds a data set already", out.display()));
    }
    fs::create_dir_all(out).map_err(|e| format!("{}: {e}", out.display()))?;
    let flights: Vec<_> =
        cells.iter().flat_map(|cell| (1..=settings.seeds).map(move |seed| (*cell, seed))).collect();
    let fly = |(cell, seed): &(&Cell, u64)| write_flight(cell, *seed, settings);
    let flown = parallel::map(&flights, settings.jobs, fly, |entry| {
        each(matches!(entry, Ok(Flown::Scored(entry)) if entry.ended.is_none()));
    });
    let mut manifest = Manifest {
        format: FORMAT,
        revision: Some(env!("TAUTLINE_REVISION").to_owned()).filter(|r| !r.is_empty()),
        flights: Vec::new(),
        left_out: Vec::new(),
    };
    for flight in flown {
        match flight? {
            Flown::Scored(entry) => manifest.flights.push(*entry),
            Flown::Unscored(flight) => manifest.left_out.push(flight),
        }
    }
    let text = serde_json::to_string_pretty(&manifest).map_err(|e| e.to_string())?;
    write(&out.join(MANIFEST), format!("{text}\n").as_bytes())?;
    Ok(manifest)
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), String> {
    fs::write(path, bytes).map_err(|e| format!("{}: {e}", path.display()))
}

/// The readings as their file has them.
///
/// # Errors
/// Parquet's own.
pub fn readings_file(recorded: &Recorded) -> Result<Vec<u8>, String> {
    recorded.readings.to_parquet(true).map_err(|e| e.to_string())
}

enum Flown {
    Scored(Box<FlightEntry>),
    Unscored(Unscored),
}

fn write_flight(cell: &Cell, seed: u64, settings: &Settings) -> Result<Flown, String> {
    let name = format!("{}-{seed}", cell.name);
    let recorded = record(cell, seed).map_err(|e| format!("{name}: {e}"))?;
    if !has_scored(&recorded.truth) {
        return Ok(Flown::Unscored(Unscored { name, ended: recorded.why.unwrap_or_default() }));
    }
    let scenario = toml::to_string(&cell.scenario).map_err(|e| format!("{name}: {e}"))?;
    let readings = readings_file(&recorded)?;
    let truth = recorded.truth.to_parquet(false).map_err(|e| e.to_string())?;
    let at = |end: &str| settings.out.join(format!("{name}.{end}"));
    write(&at(READINGS), &readings)?;
    write(&at(TRUTH), &truth)?;
    if settings.logs {
        write(&at("ulg"), &recorded.log)?;
    }
    Ok(Flown::Scored(Box::new(FlightEntry {
        cell: cell.name.clone(),
        group: cell.group.clone(),
        seed,
        duration_s: recorded.truth.rows.last().and_then(|row| *row.first()?).unwrap_or(0.0),
        about: About::of(&cell.scenario),
        ended: recorded.why,
        scenario_sha256: sha256(scenario.as_bytes()),
        readings_sha256: sha256(&readings),
        truth_sha256: sha256(&truth),
        name,
    })))
}

const READINGS: &str = "readings.parquet";
const TRUTH: &str = "truth.parquet";

/// A data set that was read.
#[derive(Clone, Debug)]
pub struct DataSet {
    folder: PathBuf,
    /// What it holds.
    pub manifest: Manifest,
}

impl DataSet {
    /// Reads the manifest.
    ///
    /// # Errors
    /// One line naming the file.
    pub fn open(folder: &Path) -> Result<Self, String> {
        let path = folder.join(MANIFEST);
        let named = |e: String| format!("{}: {e}", path.display());
        let text = fs::read_to_string(&path).map_err(|e| named(e.to_string()))?;
        let manifest: Manifest = serde_json::from_str(&text).map_err(|e| named(e.to_string()))?;
        if manifest.format != FORMAT {
            return Err(named(format!("format {} is not {FORMAT}", manifest.format)));
        }
        if manifest.flights.is_empty() {
            return Err(named("holds no flight".into()));
        }
        Ok(Self { folder: folder.to_owned(), manifest })
    }

    /// The flight of this name.
    ///
    /// # Errors
    /// One line naming it.
    pub fn flight(&self, name: &str) -> Result<&FlightEntry, String> {
        let found = self.manifest.flights.iter().find(|flight| flight.name == name);
        found.ok_or_else(|| format!("{}: no flight {name}", self.folder.display()))
    }

    /// What an estimator may read.
    ///
    /// # Errors
    /// One line naming the file: unreadable, or another than the manifest's.
    pub fn readings(&self, flight: &FlightEntry) -> Result<Table, String> {
        self.read(flight, READINGS, &flight.readings_sha256)
    }

    /// What is so.
    ///
    /// # Errors
    /// One line naming the file: unreadable, or another than the manifest's.
    pub fn truth(&self, flight: &FlightEntry) -> Result<Table, String> {
        self.read(flight, TRUTH, &flight.truth_sha256)
    }

    fn read(&self, flight: &FlightEntry, end: &str, want: &str) -> Result<Table, String> {
        let path = self.folder.join(format!("{}.{end}", flight.name));
        let bytes = fs::read(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        if sha256(&bytes) != want {
            return Err(format!("{}: is not the file that {MANIFEST} names", path.display()));
        }
        Table::read(&path)
    }

    /// A flight flown anew, to the byte as it was recorded.
    ///
    /// # Errors
    /// One line: a cell that the grid lacks, or a simulator that flies it otherwise.
    pub fn fly_again(&self, grid: &Grid, flight: &FlightEntry) -> Result<Recorded, String> {
        let cell = grid.cells.iter().find(|cell| cell.name == flight.cell);
        let cell = cell.ok_or_else(|| format!("{}: the grid has no such cell", flight.name))?;
        let recorded = record(cell, flight.seed)?;
        if sha256(&readings_file(&recorded)?) != flight.readings_sha256 {
            return Err(format!(
                "{}: this simulator does not fly it as in {}: generate the data anew",
                flight.name,
                self.folder.display()
            ));
        }
        Ok(recorded)
    }
}
