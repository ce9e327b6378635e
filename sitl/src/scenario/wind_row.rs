//! `[wind] table`: rows of three or four numbers.

use super::key::{KeyValue, rows_in_order};
use serde::{Deserialize, Serialize};

/// Time, s, speed, m/s, direction, rad from North, and down, m/s: none where the file leaves it out.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq)]
#[serde(from = "Written", into = "[f64; 4]")]
pub struct WindRow(pub [f64; 4]);

/// As a file may have it.
#[derive(Deserialize)]
#[serde(untagged, expecting = "a row of three or four numbers: s, m/s, rad, and down, m/s")]
enum Written {
    Whole([f64; 4]),
    Level([f64; 3]),
}

impl From<Written> for WindRow {
    fn from(written: Written) -> Self {
        match written {
            Written::Whole(row) => Self(row),
            Written::Level([time, speed, from]) => Self([time, speed, from, 0.0]),
        }
    }
}

impl From<WindRow> for [f64; 4] {
    fn from(row: WindRow) -> Self {
        row.0
    }
}

impl KeyValue for Vec<WindRow> {
    fn check(&self, path: &str, _: Option<(f64, f64)>) -> Result<(), String> {
        rows_in_order(path, self.iter().map(|row| &row.0))
    }
}
