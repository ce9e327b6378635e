//! Every scenario of `sitl/scenarios/`, flown once: how well, in `tests/snapshots/`, one file each.
//!
//! A moved number fails here and shows in the diff of whoever moves it. After a change that shall move
//! numbers: `UPDATE_SNAPSHOTS=1 cargo test -p tautline-tests --test snapshots`, then read the diff as code.
//! Four digits, on purpose: a flight is the same to the bit on the same machine, and another compiler's
//! rounding stays below.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::{env, fs, io};
use tautline_sitl::campaign::parallel;
use tautline_sitl::flight::{Flight, Progress};
use tautline_sitl::scenario::Scenario;

const SEED: u64 = 1;
const LONGEST: f64 = 600.0;
const REFRESH: &str = "UPDATE_SNAPSHOTS=1 cargo test -p tautline-tests --test snapshots";

fn files(folder: &str, ending: &str) -> BTreeMap<String, PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let entries = fs::read_dir(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    entries
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == ending))
        .map(|path| (path.file_stem().unwrap().to_str().unwrap().to_owned(), path))
        .collect()
}

/// `0.1234`, `12.34`: four significant digits.
fn digits(x: f64) -> String {
    if x == 0.0 {
        return "0".into();
    }
    let places = (3 - x.abs().log10().floor() as i32).max(0) as usize;
    format!("{x:.places$}")
}

/// One line a figure, `group.name value`.
fn lines(out: &mut String, name: &str, value: &Value) {
    match value {
        Value::Object(map) => {
            for (key, value) in map {
                let name = if name.is_empty() { key.clone() } else { format!("{name}.{key}") };
                lines(out, &name, value);
            }
        }
        Value::Number(x) => writeln!(out, "{name} {}", digits(x.as_f64().unwrap())).unwrap(),
        Value::Null => {}
        other => writeln!(out, "{name} {other}").unwrap(),
    }
}

fn fly(path: &Path) -> String {
    let scenario = Scenario::load(path).unwrap();
    let params = scenario.params().unwrap();
    let mut flight = Flight::new(&scenario, params, SEED, io::sink()).unwrap();
    flight.fly(LONGEST);
    let mut text = format!("seed {SEED}\n");
    let end = match flight.mission.progress() {
        Progress::Done => "done".to_owned(),
        Progress::Flying => "not finished".to_owned(),
        Progress::Failed(why) => why.clone(),
    };
    writeln!(text, "mission {end}").unwrap();
    writeln!(text, "time_s {}", digits(flight.world.time())).unwrap();
    lines(&mut text, "", &serde_json::to_value(flight.metrics.summary()).unwrap());
    text
}

/// What differs, line by line.
fn difference(was: &str, is: &str) -> String {
    let only = |mark, a: &str, b: &str| -> String {
        let there: Vec<_> = b.lines().collect();
        a.lines().filter(|l| !there.contains(l)).map(|l| format!("  {mark} {l}\n")).collect()
    };
    only('-', was, is) + &only('+', is, was)
}

#[test]
fn every_scenario_flies_as_well_as_its_snapshot_says() {
    let scenarios = files("../sitl/scenarios", "toml");
    let snapshots = files("snapshots", "txt");
    let all: Vec<_> = scenarios.iter().collect();
    let flown = parallel::map(&all, parallel::cores(), |(_, path)| fly(path), |_| {});
    let mut moved = String::new();
    for ((name, _), is) in all.iter().zip(&flown) {
        if env::var_os("UPDATE_SNAPSHOTS").is_some() {
            let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("snapshots");
            fs::write(folder.join(format!("{name}.txt")), is).unwrap();
            continue;
        }
        let was =
            snapshots.get(*name).map_or(String::new(), |path| fs::read_to_string(path).unwrap());
        if was != *is {
            write!(moved, "{name}:\n{}", difference(&was, is)).unwrap();
        }
    }
    let is_stale = |name: &&String| !scenarios.contains_key(*name);
    let stale: Vec<_> = snapshots.keys().filter(is_stale).collect();
    assert!(stale.is_empty(), "snapshots without a scenario: {stale:?}");
    assert!(moved.is_empty(), "moved; if that is meant: {REFRESH}\n{moved}");
}

#[test]
fn figures_have_four_digits_whatever_their_size() {
    for (x, text) in [(0.0, "0"), (0.123_456, "0.1235"), (-12.345_6, "-12.35"), (1e-3, "0.001000")]
    {
        assert_eq!(digits(x), text);
    }
    assert_eq!(digits(123_456.7), "123457");
}
