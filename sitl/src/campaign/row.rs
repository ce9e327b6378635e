//! A flight as one line of the table, and what the whole table hashes to.

use crate::metrics::Summary;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::fmt::Write;

/// A value of the table; what is missing is `None`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Cell {
    /// Yes or no.
    Flag(bool),
    /// A figure.
    Number(f64),
    /// Words.
    Text(String),
}

/// What the cells of a column are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// [`Cell::Flag`].
    Flag,
    /// [`Cell::Number`].
    Number,
    /// [`Cell::Text`].
    Text,
}

/// A column of the table.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Column {
    /// A varied key's path, or a figure's name with its unit.
    pub name: String,
    /// What stands in it.
    pub kind: Kind,
}

/// What a table is of: two tables with the same header belong to the same campaign.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    /// What the campaign shows.
    pub title: String,
    /// Name of its file, without folders.
    pub campaign: String,
    /// Name of its scenario's file, without folders.
    pub scenario: String,
    /// SHA-256 of both files and the number of flights, hexadecimal.
    pub identity: String,
    /// The campaign's seed.
    pub seed: u64,
    /// Flights of all shards together.
    pub flights: u64,
    /// Commit of the simulator, if it is a release of one.
    pub revision: Option<String>,
    /// Varied keys.
    pub varied: Vec<Column>,
    /// Figures of a flight.
    pub figures: Vec<Column>,
}

impl Header {
    /// Why the flights of the two do not belong into one table, if so.
    ///
    /// # Errors
    /// One line.
    pub fn same_campaign(&self, other: &Self) -> Result<(), String> {
        if self.identity != other.identity {
            return Err(
                "another campaign: the file, its scenario or the number of flights differs".into(),
            );
        }
        if self.revision != other.revision {
            let of = |header: &Self| header.revision.clone().unwrap_or_else(|| "unknown".into());
            return Err(format!(
                "flown by another simulator: commit {} and {}",
                of(self),
                of(other)
            ));
        }
        if self != other {
            return Err("another campaign: seed, names or columns differ".into());
        }
        Ok(())
    }
}

/// One flight.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Row {
    /// Which flight of the campaign, from 0.
    pub index: u64,
    /// Seed that it flew with.
    pub seed: u64,
    /// The mission was flown to its end and the vehicle was not lost.
    pub complete: bool,
    /// That, and within all limits.
    pub pass: bool,
    /// Why not, if not.
    pub reason: String,
    /// As [`Header::varied`].
    pub varied: Vec<Option<Cell>>,
    /// As [`Header::figures`]; what is not finite is missing.
    pub figures: Vec<Option<Cell>>,
}

impl Row {
    /// The row in one line, every float to its last bit.
    ///
    /// # Errors
    /// Never, as far as known.
    pub fn to_line(&self) -> Result<String, String> {
        serde_json::to_string(self).map_err(|e| e.to_string())
    }
}

/// SHA-256 of the names of the columns and of all rows in the order of their indices, hexadecimal.
#[must_use]
pub fn content_hash(header: &Header, rows: &[Row]) -> String {
    let mut sorted: Vec<_> = rows.iter().collect();
    sorted.sort_by_key(|row| row.index);
    let mut hash = Sha256::new();
    for column in header.varied.iter().chain(&header.figures) {
        hash.update(format!("{}\n", column.name));
    }
    for row in sorted {
        hash.update(row.to_line().unwrap_or_default());
        hash.update("\n");
    }
    hexadecimal(&hash.finalize())
}

pub(crate) fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

/// Names of the table where the summary's own do not say it all.
const NAMES: [(&str, &str); 4] = [
    ("place_kept_0", "place_kept_level"),
    ("place_kept_1", "place_kept_vertical"),
    ("taut_second_rms", "taut_second_rms_n_or_rad"),
    ("taut_second_max", "taut_second_max_n_or_rad"),
];

/// The columns of every figure that a flight can have.
pub(super) fn figure_columns() -> Vec<Column> {
    let kind = |value: &Value| match value {
        Value::Bool(_) => Kind::Flag,
        Value::String(_) => Kind::Text,
        _ => Kind::Number,
    };
    let columns = flat(&Summary::with_every_figure()).into_iter();
    columns.map(|(name, value)| Column { kind: kind(&value), name }).collect()
}

/// A flight's figures in these columns.
pub(super) fn figures(summary: &Summary, columns: &[Column]) -> Vec<Option<Cell>> {
    let mut flat = flat(summary);
    let mut take = |name: &str| {
        let at = flat.iter().position(|(other, _)| other == name)?;
        match flat.swap_remove(at).1 {
            Value::Bool(x) => Some(Cell::Flag(x)),
            Value::Number(x) => x.as_f64().map(Cell::Number),
            Value::String(x) => Some(Cell::Text(x)),
            _ => None,
        }
    };
    columns.iter().map(|column| take(&column.name)).collect()
}

/// Groups by their names before the figures', in the order of the names.
fn flat(summary: &Summary) -> Vec<(String, Value)> {
    fn walk(name: String, value: Value, into: &mut Vec<(String, Value)>) {
        let below = |key: String| if name.is_empty() { key } else { format!("{name}_{key}") };
        match value {
            Value::Object(map) => {
                map.into_iter().for_each(|(key, value)| walk(below(key), value, into));
            }
            Value::Array(items) => {
                let items = items.into_iter().enumerate();
                items.for_each(|(i, value)| walk(below(i.to_string()), value, into));
            }
            value => into.push((name, value)),
        }
    }
    let mut flat = Vec::new();
    walk(String::new(), serde_json::to_value(summary).unwrap_or_default(), &mut flat);
    for (name, _) in &mut flat {
        if let Some((_, better)) = NAMES.iter().find(|(own, _)| own == name) {
            *name = (*better).to_owned();
        }
    }
    flat.sort_by(|(a, _), (b, _)| a.cmp(b));
    flat
}
