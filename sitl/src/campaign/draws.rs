//! What does a flight get? Draws that follow from the campaign's seed, the key and the flight's index alone.
//!
//! Each number comes from a hash of these three, not from a stream: no flight waits for another's draws, and one
//! more key leaves those of the others alone. Flights that differ in the grid alone share seed and draws, so that
//! what differs between them is the grid's doing.

use super::distribution::Distribution;
use super::path::KeyPath;
use serde::Deserialize;
use sha2::{Digest, Sha256};
use toml::{Table, Value};

/// How uniform and normal keys are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sampling {
    /// Each flight on its own.
    #[default]
    Random,
    /// Each key's range is cut into as many equally likely parts as there are seeds, and each part drawn once.
    LatinHypercube,
}

/// One key of `[vary]`.
#[derive(Clone, Debug)]
pub struct Varied {
    /// As it stands in the file.
    pub name: String,
    /// The same, understood.
    pub path: KeyPath,
    /// What it is drawn from.
    pub distribution: Distribution,
    /// Which part of its range each seed gets; empty without a Latin hypercube.
    parts: Vec<u32>,
}

/// All of `[vary]`, in the order of the names.
#[derive(Clone, Debug)]
pub struct Draws {
    /// The campaign's seed.
    seed: u64,
    /// The keys.
    pub keys: Vec<Varied>,
    /// Points of the grid.
    pub points: u64,
}

impl Draws {
    /// Reads and checks `[vary]`.
    ///
    /// # Errors
    /// One line that names the key.
    pub fn new(vary: Table, sampling: Sampling, seed: u64, seeds: u64) -> Result<Self, String> {
        let mut written = Vec::new();
        flatten(String::new(), vary, &mut written);
        written.sort_by(|(a, _), (b, _)| a.cmp(b));
        let mut keys: Vec<Varied> = Vec::new();
        let mut points: u64 = 1;
        for (name, value) in written {
            let wrong = |what: String| format!("vary.\"{name}\": {what}");
            let path = KeyPath::parse(&name)
                .ok_or_else(|| wrong("expected a scenario's key, as \"wind.speed\"".into()))?;
            if let Some(other) = keys.iter().find(|other| other.path.overlaps(&path)) {
                return Err(wrong(format!("overlaps vary.\"{}\"", other.name)));
            }
            let distribution = Distribution::parse(value).map_err(wrong)?;
            let mut parts = Vec::new();
            if let Distribution::Grid(values) = &distribution {
                points = points.saturating_mul(values.len() as u64);
            } else if sampling == Sampling::LatinHypercube {
                parts = shuffled(seed, &name, seeds);
            }
            keys.push(Varied { name, path, distribution, parts });
        }
        Ok(Self { seed, keys, points })
    }

    /// What the flight gets, in the order of the keys.
    #[must_use]
    pub fn of(&self, index: u64) -> Vec<Value> {
        let (ordinal, mut point) = (index / self.points, index % self.points);
        // The last key of the grid changes fastest.
        let mut values: Vec<_> =
            self.keys.iter().rev().map(|key| self.draw(key, ordinal, &mut point)).collect();
        values.reverse();
        values
    }

    fn draw(&self, key: &Varied, ordinal: u64, point: &mut u64) -> Value {
        if let Distribution::Grid(values) = &key.distribution {
            let count = values.len().max(1) as u64;
            let value = values.get((*point % count) as usize);
            *point /= count;
            return value.cloned().unwrap_or(Value::Boolean(false));
        }
        let random = unit(hash(self.seed, &key.name, "draw", ordinal));
        let part = usize::try_from(ordinal).ok().and_then(|i| key.parts.get(i));
        let share =
            part.map_or(random, |&part| (f64::from(part) + random) / key.parts.len() as f64);
        key.distribution.quantile(share).unwrap_or(f64::NAN).into()
    }
}

/// `[vary.wind] speed = …` is `"wind.speed" = …`.
fn flatten(before: String, table: Table, into: &mut Vec<(String, Value)>) {
    for (key, value) in table {
        let name = if before.is_empty() { key } else { format!("{before}.{key}") };
        match value {
            Value::Table(inner) if !inner.is_empty() && !Distribution::is_meant(&inner) => {
                flatten(name, inner, into);
            }
            value => into.push((name, value)),
        }
    }
}

fn hash(seed: u64, key: &str, purpose: &str, ordinal: u64) -> u64 {
    let text = format!("{purpose}\n{seed}\n{ordinal}\n{key}");
    let bytes = Sha256::digest(text);
    bytes.first_chunk().copied().map_or(0, u64::from_le_bytes)
}

/// Within 0 and 1, without either.
fn unit(bits: u64) -> f64 {
    ((bits >> 12) as f64 + 0.5) / (1_u64 << 52) as f64
}

/// The numbers from 0 to `count`, each once.
fn shuffled(seed: u64, key: &str, count: u64) -> Vec<u32> {
    let mut numbers: Vec<u32> = (0..count).filter_map(|i| u32::try_from(i).ok()).collect();
    numbers.sort_by_cached_key(|&i| hash(seed, key, "part", u64::from(i)));
    numbers
}
