//! A campaign's file, checked whole before the first flight, and its flights.

use super::distribution::Distribution;
use super::draws::{Draws, Sampling, Varied};
use super::outcome::{Limits, fly};
use super::path::KeyPath;
use super::row::{self, Cell, Column, Header, Kind, Row};
use crate::metrics::Metrics;
use crate::scenario::{Scenario, toml_error};
use serde::Deserialize;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// Most seeds.
const SEEDS_MAX: u64 = 100_000;
/// Most flights.
const FLIGHTS_MAX: u64 = 1_000_000;

/// As it stands in the file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    title: String,
    scenario: PathBuf,
    #[serde(default = "one")]
    first_seed: u64,
    seeds: u64,
    #[serde(default)]
    sampling: Sampling,
    #[serde(default)]
    vary: Table,
    #[serde(default)]
    limits: Limits,
}

fn one() -> u64 {
    1
}

/// A campaign: a scenario, seeds, what varies, limits.
#[derive(Clone, Debug)]
pub struct Campaign {
    header: Header,
    /// Every flight must keep them.
    limits: Limits,
    draws: Draws,
    /// The scenario's file.
    scenario: Table,
}

impl Campaign {
    /// Reads a campaign and its scenario and checks every flight of it.
    ///
    /// # Errors
    /// One line naming the file and the key.
    pub fn load(path: &Path) -> Result<Self, String> {
        Self::load_some(path, None)
    }

    /// The same with the first so many of its seeds. The flights are those of the whole campaign.
    ///
    /// # Errors
    /// One line naming the file and the key.
    pub fn load_some(path: &Path, seeds: Option<u64>) -> Result<Self, String> {
        let name = path.display().to_string();
        let text = std::fs::read_to_string(path).map_err(|e| format!("{name}: {e}"))?;
        let mut written: Written =
            toml::from_str(&text).map_err(|e| toml_error(&name, &text, &e))?;
        let beside = path.parent().unwrap_or(Path::new(".")).join(&written.scenario);
        let shown = beside.display().to_string();
        let base = std::fs::read_to_string(&beside).map_err(|e| format!("{shown}: {e}"))?;
        // By its lines: what is wrong in the scenario itself is not the campaign's fault.
        Scenario::parse(&base, &shown).map_err(|e| e.0)?;
        written.scenario = beside;
        let count = seeds.unwrap_or(written.seeds).min(written.seeds);
        let campaign = Self::new(written, count, path, [&text, &base]);
        campaign.map_err(|e| format!("{name}: {e}"))
    }

    /// `texts` are those of the campaign's and of the scenario's file.
    fn new(written: Written, count: u64, path: &Path, texts: [&str; 2]) -> Result<Self, String> {
        let (first, seeds) = (written.first_seed, written.seeds);
        if seeds == 0 || seeds > SEEDS_MAX {
            return Err(format!("seeds = {seeds} is outside 1 to {SEEDS_MAX}"));
        }
        let draws = Draws::new(written.vary, written.sampling, first, seeds)?;
        let flights = count.saturating_mul(draws.points);
        if flights > FLIGHTS_MAX {
            let points = draws.points;
            return Err(format!(
                "{count} seeds, {points} points of vary: over {FLIGHTS_MAX} flights"
            ));
        }
        let header = Header {
            title: written.title,
            campaign: file_name(path),
            scenario: file_name(&written.scenario),
            identity: identity(texts, flights),
            seed: first,
            flights,
            revision: Some(env!("TAUTLINE_REVISION").to_owned()).filter(|r| !r.is_empty()),
            varied: draws.keys.iter().map(column).collect(),
            figures: row::figure_columns(),
        };
        let [_, base] = texts;
        let scenario = base.parse().map_err(|e: toml::de::Error| e.message().to_owned())?;
        let campaign = Self { header, limits: written.limits, draws, scenario };
        campaign.check_keys()?;
        campaign.check_flights()?;
        Ok(campaign)
    }

    /// Every key on its own, at the ends of its range: what is wrong with it is said of the key.
    fn check_keys(&self) -> Result<(), String> {
        for key in &self.draws.keys {
            for value in key.distribution.extremes() {
                let wrong = |e: String| format!("vary.\"{}\" = {value}: {e}", key.name);
                self.with([(&key.path, value.clone())]).and_then(to_scenario).map_err(wrong)?;
            }
        }
        Ok(())
    }

    /// Every flight: keys that are right on their own need not go together, and a normal draw may leave a range.
    fn check_flights(&self) -> Result<(), String> {
        // Without anything varied all are the scenario itself.
        let flights = if self.draws.keys.is_empty() { 1 } else { self.header.flights };
        for index in 0..flights {
            let scenario = self.scenario(index).map_err(|e| format!("flight {index}: {e}"))?;
            if scenario.mission.is_empty() {
                return Err(format!(
                    "{}: mission is empty: nobody would fly",
                    self.header.scenario
                ));
            }
        }
        Ok(())
    }

    fn with<'a>(
        &self,
        values: impl IntoIterator<Item = (&'a KeyPath, Value)>,
    ) -> Result<Table, String> {
        let mut table = self.scenario.clone();
        for (path, value) in values {
            path.put(&mut table, value)?;
        }
        Ok(table)
    }

    /// What the table is of.
    #[must_use]
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// Every flight must keep them.
    #[must_use]
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// How many: seeds times points of the grid. Their indices begin with 0.
    #[must_use]
    pub fn flights(&self) -> u64 {
        self.header.flights
    }

    /// The seed that a flight flies with.
    #[must_use]
    pub fn seed(&self, index: u64) -> u64 {
        self.header.seed.wrapping_add(index / self.draws.points)
    }

    /// A flight's varied keys and their values, in the order of [`Header::varied`].
    #[must_use]
    pub fn drawn(&self, index: u64) -> Vec<(&str, Value)> {
        self.draws.keys.iter().map(|key| &*key.name).zip(self.draws.of(index)).collect()
    }

    fn table(&self, index: u64) -> Result<Table, String> {
        self.with(self.draws.keys.iter().map(|key| &key.path).zip(self.draws.of(index)))
    }

    /// A flight's scenario.
    ///
    /// # Errors
    /// One line naming the key; never for a flight of a campaign that was loaded.
    pub fn scenario(&self, index: u64) -> Result<Scenario, String> {
        self.table(index).and_then(to_scenario)
    }

    /// The same as a file.
    ///
    /// # Errors
    /// One line naming the key; never for a flight of a campaign that was loaded.
    pub fn scenario_text(&self, index: u64) -> Result<String, String> {
        toml::to_string(&self.table(index)?).map_err(|e| e.to_string())
    }

    /// Flies one.
    #[must_use]
    pub fn fly(&self, index: u64) -> Row {
        let seed = self.seed(index);
        let (complete, pass, reason, summary) = match self.scenario(index) {
            Ok(scenario) => {
                let outcome = fly(&scenario, seed, &self.limits);
                (outcome.complete, outcome.pass, outcome.reason, outcome.summary)
            }
            Err(e) => (false, false, e, Metrics::default().summary()),
        };
        let varied = self.draws.of(index).into_iter().zip(&self.header.varied);
        Row {
            index,
            seed,
            complete,
            pass,
            reason,
            varied: varied.map(|(value, column)| cell(&value, column.kind)).collect(),
            figures: row::figures(&summary, &self.header.figures),
        }
    }
}

fn file_name(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

/// Of everything that a flight follows from, the simulator apart.
fn identity(texts: [&str; 2], flights: u64) -> String {
    let mut hash = Sha256::new();
    for text in texts {
        hash.update((text.len() as u64).to_le_bytes());
        hash.update(text);
    }
    hash.update(flights.to_le_bytes());
    row::hexadecimal(&hash.finalize())
}

fn column(key: &Varied) -> Column {
    Column { name: key.name.clone(), kind: kind(&key.distribution) }
}

fn to_scenario(table: Table) -> Result<Scenario, String> {
    let scenario = Scenario::from_table(table)?;
    // The vehicle must be one that the firmware can be told of.
    scenario.params().map_err(|e| e.0)?;
    Ok(scenario)
}

fn number(value: &Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|x| x as f64))
}

/// What the values of a key are; mixed ones and lists are shown as their text.
fn kind(distribution: &Distribution) -> Kind {
    match distribution {
        Distribution::Grid(values) if values.iter().all(Value::is_bool) => Kind::Flag,
        Distribution::Grid(values) if !values.iter().all(|x| number(x).is_some()) => Kind::Text,
        _ => Kind::Number,
    }
}

fn cell(value: &Value, kind: Kind) -> Option<Cell> {
    match kind {
        Kind::Flag => value.as_bool().map(Cell::Flag),
        Kind::Number => number(value).map(Cell::Number),
        Kind::Text => {
            Some(Cell::Text(value.as_str().map_or_else(|| value.to_string(), str::to_owned)))
        }
    }
}
