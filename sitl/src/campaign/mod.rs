//! Monte-Carlo: the same scenario over many seeds, checked against limits.

pub mod parallel;

use crate::flight::{Flight, Progress};
use crate::metrics::Summary;
use crate::scenario::Scenario;
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

/// A campaign file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Campaign {
    /// What it shows.
    pub title: String,
    /// Scenario, beside this file.
    pub scenario: PathBuf,
    /// First seed.
    #[serde(default = "one")]
    pub first_seed: u64,
    /// How many.
    pub seeds: u64,
    /// Every flight must keep them.
    #[serde(default)]
    pub limits: Limits,
}

fn one() -> u64 {
    1
}

/// Largest values; absent ones are only reported.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Limits {
    /// m.
    pub hold_horizontal_rms_m: Option<f64>,
    /// m.
    pub hold_vertical_rms_m: Option<f64>,
    /// m/s.
    pub touch_down_mps: Option<f64>,
    /// Sideways, m/s.
    pub touch_down_drift_mps: Option<f64>,
    /// From where it stood, m.
    pub touch_down_from_pad_m: Option<f64>,
    /// rad.
    pub tilt_max_rad: Option<f64>,
    /// rad.
    pub attitude_rms_rad: Option<f64>,
}

/// One flight.
#[derive(Clone, Debug, Serialize)]
pub struct Outcome {
    /// Its seed.
    pub seed: u64,
    /// The mission was flown to its end and the vehicle was not lost.
    pub complete: bool,
    /// Within all limits.
    pub pass: bool,
    /// Why not, if not.
    pub reason: String,
    /// Figures.
    #[serde(flatten)]
    pub summary: Summary,
}

/// Longest flight, simulated s.
const LONGEST: f64 = 600.0;

impl Campaign {
    /// Reads a campaign and its scenario.
    ///
    /// # Errors
    /// One line naming the file.
    pub fn load(path: &Path) -> Result<(Self, Scenario), String> {
        let name = path.display();
        let text = std::fs::read_to_string(path).map_err(|e| format!("{name}: {e}"))?;
        let campaign: Self = toml::from_str(&text)
            .map_err(|e| format!("{name}: {}", e.message().replace('\n', " ")))?;
        if campaign.seeds == 0 || campaign.seeds > 100_000 {
            return Err(format!("{name}: seeds = {} is outside 1 to 100000", campaign.seeds));
        }
        let beside = path.parent().unwrap_or(Path::new(".")).join(&campaign.scenario);
        let scenario = Scenario::load(&beside).map_err(|e| e.0)?;
        if scenario.mission.is_empty() {
            return Err(format!("{}: mission is empty: nobody would fly", beside.display()));
        }
        Ok((campaign, scenario))
    }

    /// The seeds of one shard, `index` of `count`, counted from 1.
    #[must_use]
    pub fn shard(&self, index: u64, count: u64) -> Vec<u64> {
        (0..self.seeds).filter(|i| i % count == index - 1).map(|i| self.first_seed + i).collect()
    }

    /// Flies the seeds on `jobs` threads; `each` is called with every flight as it ends.
    pub fn run(
        &self,
        scenario: &Scenario,
        seeds: &[u64],
        jobs: usize,
        each: impl FnMut(&Outcome),
    ) -> Vec<Outcome> {
        parallel::map(seeds, jobs, |&seed| fly(scenario, seed, &self.limits), each)
    }
}

/// The same flight as [`fly`], with its log in a file.
///
/// # Errors
/// Of the scenario or the file.
pub fn log(scenario: &Scenario, seed: u64, path: &Path) -> Result<(), String> {
    let params = scenario.params().map_err(|e| e.0)?;
    let name = |e: io::Error| format!("{}: {e}", path.display());
    let file = BufWriter::with_capacity(1 << 16, File::create(path).map_err(name)?);
    let mut flight = Flight::new(scenario, params, seed, file).map_err(|e| e.0)?;
    flight.fly(LONGEST);
    flight.finish_log().map_err(name).map(drop)
}

/// One flight, checked.
#[must_use]
pub fn fly(scenario: &Scenario, seed: u64, limits: &Limits) -> Outcome {
    let flight = scenario.params().and_then(|params| Flight::unrecorded(scenario, params, seed));
    let mut flight = match flight {
        Ok(flight) => flight,
        Err(e) => {
            let summary = crate::metrics::Metrics::default().summary();
            return Outcome { seed, complete: false, pass: false, reason: e.0, summary };
        }
    };
    flight.fly(LONGEST);
    let summary = flight.metrics.summary();
    let mut reason = match (flight.mission.progress(), summary.lost) {
        (_, Some(why)) => format!("lost: {why}"),
        (Progress::Done, None) => String::new(),
        (Progress::Failed(why), None) => why.clone(),
        (Progress::Flying, None) => "not finished".into(),
    };
    let complete = reason.is_empty();
    let bounds = [
        ("hold_horizontal_rms_m", summary.hold_horizontal_rms_m, limits.hold_horizontal_rms_m),
        ("hold_vertical_rms_m", summary.hold_vertical_rms_m, limits.hold_vertical_rms_m),
        ("touch_down_mps", summary.touch_down_mps, limits.touch_down_mps),
        ("touch_down_drift_mps", summary.touch_down_drift_mps, limits.touch_down_drift_mps),
        ("touch_down_from_pad_m", summary.touch_down_from_pad_m, limits.touch_down_from_pad_m),
        ("tilt_max_rad", Some(summary.tilt_max_rad), limits.tilt_max_rad),
        ("attitude_rms_rad", summary.attitude_rms_rad, limits.attitude_rms_rad),
    ];
    for (name, value, limit) in bounds {
        if let (true, Some(limit)) = (complete, limit)
            && !value.is_some_and(|value| value <= limit)
        {
            reason = format!("{name} over {limit}");
        }
    }
    Outcome { seed, complete, pass: reason.is_empty(), reason, summary }
}
