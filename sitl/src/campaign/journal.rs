//! Which flights are flown already? A line for each, written as it ends: who kills a campaign loses the flights
//! that are in the air, and no more.
//!
//! The first line says what the campaign is, each further one is a [`Row`]. A last line without its end was torn
//! when the campaign was killed, and is flown again.

use super::row::{Header, Row};
use super::shard::Shard;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{ErrorKind, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

const NAME: &str = "journal.jsonl";

/// The first line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Start {
    /// The campaign.
    pub header: Header,
    /// The part of it that is flown here.
    pub shard: Shard,
}

/// What stands in a folder.
#[derive(Debug)]
pub struct Flown {
    /// What was begun.
    pub start: Start,
    /// What of it is flown, in the order of the flights.
    pub rows: Vec<Row>,
    /// Bytes up to the end of the last whole line.
    whole: u64,
}

impl Flown {
    /// Reads a folder's journal; `None` if nothing was begun.
    ///
    /// # Errors
    /// One line naming the file and what in it is no journal.
    pub fn read(folder: &Path) -> Result<Option<Self>, String> {
        let path = folder.join(NAME);
        let name = path.display();
        let text = match fs::read(&path) {
            Ok(bytes) => bytes,
            Err(e) if e.kind() == ErrorKind::NotFound => return Ok(None),
            Err(e) => return Err(format!("{name}: {e}")),
        };
        let Some(end) = text.iter().rposition(|&byte| byte == b'\n') else { return Ok(None) };
        let whole = text.get(..end).unwrap_or_default();
        let mut lines = whole.split(|&byte| byte == b'\n').enumerate();
        let wrong = |line: usize, e: &dyn std::fmt::Display| format!("{name}:{}: {e}", line + 1);
        let first = lines.next().map_or(&[][..], |(_, line)| line);
        let start: Start = serde_json::from_slice(first)
            .map_err(|_| wrong(0, &"not a campaign's journal, or another version's"))?;
        let mut seen = BTreeSet::new();
        let mut rows: Vec<Row> = Vec::new();
        for (i, line) in lines {
            let row: Row = serde_json::from_slice(line).map_err(|e| wrong(i, &e))?;
            let is_of_it = row.index < start.header.flights
                && start.shard.has(row.index)
                && row.varied.len() == start.header.varied.len()
                && row.figures.len() == start.header.figures.len();
            if !is_of_it {
                return Err(wrong(
                    i,
                    &format!("flight {} is not one of shard {}", row.index, start.shard),
                ));
            }
            if !seen.insert(row.index) {
                return Err(wrong(i, &format!("flight {} a second time", row.index)));
            }
            rows.push(row);
        }
        rows.sort_by_key(|row| row.index);
        Ok(Some(Self { start, rows, whole: end as u64 + 1 }))
    }

    /// How many flights are not flown yet.
    pub fn missing(&self) -> u64 {
        self.start.shard.count(self.start.header.flights).saturating_sub(self.rows.len() as u64)
    }
}

/// A journal that is written.
#[derive(Debug)]
pub struct Journal {
    file: File,
    path: PathBuf,
}

impl Journal {
    /// Opens a folder's journal for this process alone.
    ///
    /// # Errors
    /// One line naming the file.
    pub fn open(folder: &Path) -> Result<Self, String> {
        let path = folder.join(NAME);
        let named = |e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
        let file = OpenOptions::new().create(true).truncate(false).write(true).open(&path);
        let file = file.map_err(|e| named(&e))?;
        // Some network file systems know no locks; there the user takes care.
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            return Err(named(&"another process flies into this folder"));
        }
        Ok(Self { file, path })
    }

    /// Begins it anew.
    ///
    /// # Errors
    /// One line naming the file.
    pub fn begin(&mut self, start: &Start) -> Result<(), String> {
        self.cut(0)?;
        let line = serde_json::to_string(start).map_err(|e| e.to_string())?;
        self.write(line)
    }

    /// Goes on after what was read.
    ///
    /// # Errors
    /// One line naming the file.
    pub fn go_on(&mut self, flown: &Flown) -> Result<(), String> {
        self.cut(flown.whole)
    }

    /// One more flight.
    ///
    /// # Errors
    /// One line naming the file.
    pub fn append(&mut self, row: &Row) -> Result<(), String> {
        self.write(row.to_line()?)
    }

    fn cut(&mut self, length: u64) -> Result<(), String> {
        let cut = self.file.set_len(length).and_then(|()| self.file.seek(SeekFrom::End(0)));
        cut.map(drop).map_err(|e| format!("{}: {e}", self.path.display()))
    }

    /// In one call, so that a line is whole or the last.
    fn write(&mut self, mut line: String) -> Result<(), String> {
        line.push('\n');
        let written = self.file.write_all(line.as_bytes());
        written.map_err(|e| format!("{}: {e}", self.path.display()))
    }
}
