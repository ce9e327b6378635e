//! Shards of one campaign, joined to the table of the whole.

use super::journal::Flown;
use super::row::{Header, Row};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A whole campaign.
#[derive(Clone, Debug)]
pub struct Merged {
    /// What it is.
    pub header: Header,
    /// All its flights, in their order.
    pub rows: Vec<Row>,
}

/// Joins the folders of all shards of a campaign.
///
/// # Errors
/// One line: a folder without a journal, one of another campaign, a flight that is there twice or not at all.
pub fn merge(folders: &[PathBuf]) -> Result<Merged, String> {
    let mut header: Option<Header> = None;
    let mut rows: BTreeMap<u64, (Row, &Path)> = BTreeMap::new();
    let mut unfinished = String::new();
    for folder in folders {
        let name = folder.display();
        let flown = Flown::read(folder)?
            .ok_or_else(|| format!("{name}: no campaign was flown into this folder"))?;
        let of = header.get_or_insert_with(|| flown.start.header.clone());
        of.same_campaign(&flown.start.header).map_err(|e| format!("{name}: {e}"))?;
        if flown.missing() > 0 {
            unfinished = format!("; {name} is unfinished: --resume goes on with it");
        }
        for row in flown.rows {
            let index = row.index;
            if let Some((_, other)) = rows.insert(index, (row, folder)) {
                return Err(format!("flight {index} is in {} and in {name}", other.display()));
            }
        }
    }
    let header = header.ok_or("no folder to merge")?;
    let missing = header.flights.saturating_sub(rows.len() as u64);
    if let Some(first) = (0..header.flights).find(|index| !rows.contains_key(index)) {
        return Err(format!(
            "{missing} of {} flights are missing, flight {first} first{unfinished}",
            header.flights
        ));
    }
    Ok(Merged { header, rows: rows.into_values().map(|(row, _)| row).collect() })
}
