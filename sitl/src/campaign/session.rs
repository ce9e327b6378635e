//! A campaign, or a shard of it, flown into a folder: journal, tables, failed flights.

use super::failed::{self, Kept, keep_failed};
use super::file::Campaign;
use super::journal::{Flown, Journal, Start};
use super::parallel;
use super::row::{Header, Row};
use super::shard::Shard;
use super::summary::{Summary, summary};
use super::table::write_parquet;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// Names of the results in a folder.
const TABLE: &str = "flights.parquet";
const SUMMARY: &str = "summary.json";

/// Where and how.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Folder of the results.
    pub out: PathBuf,
    /// Which part.
    pub shard: Shard,
    /// Threads.
    pub jobs: usize,
    /// Go on with what the folder holds.
    pub resume: bool,
    /// At most so many failed flights are kept with their logs.
    pub keep_logs: usize,
}

/// A folder with what is flown of a campaign, open for what is not.
#[derive(Debug)]
pub struct Session<'a> {
    campaign: &'a Campaign,
    settings: &'a Settings,
    journal: Journal,
    /// Flown before.
    rows: Vec<Row>,
    /// Not yet flown.
    pending: Vec<u64>,
}

impl<'a> Session<'a> {
    /// Prepares a folder, or continues it.
    ///
    /// # Errors
    /// One line: too many shards, a folder that cannot be written, one that holds something else.
    pub fn open(campaign: &'a Campaign, settings: &'a Settings) -> Result<Self, String> {
        let Settings { out, shard, resume, .. } = settings;
        let flights = campaign.flights();
        if shard.part < 1 || shard.part > shard.of || shard.of > flights {
            return Err(format!("--shard {shard}: there are {flights} flights to share"));
        }
        fs::create_dir_all(out).map_err(|e| format!("{}: {e}", out.display()))?;
        let start = Start { header: campaign.header().clone(), shard: *shard };
        let mut journal = Journal::open(out)?;
        let flown = Flown::read(out)?;
        let rows = match flown {
            Some(flown) if *resume => {
                is_of(&flown.start, &start).map_err(|e| format!("{}: {e}", out.display()))?;
                journal.go_on(&flown)?;
                flown.rows
            }
            Some(flown) if flown.missing() > 0 => {
                return Err(format!(
                    "{} holds an unfinished campaign ({} of its flights are missing): --resume goes on with it",
                    out.display(),
                    flown.missing()
                ));
            }
            _ => {
                remove_results(out)?;
                journal.begin(&start)?;
                Vec::new()
            }
        };
        let flown: BTreeSet<_> = rows.iter().map(|row| row.index).collect();
        let of_shard = (0..flights).filter(|&index| shard.has(index));
        let pending = of_shard.filter(|index| !flown.contains(index)).collect();
        Ok(Self { campaign, settings, journal, rows, pending })
    }

    /// What was flown before.
    #[must_use]
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// How many flights there are to fly.
    #[must_use]
    pub fn pending(&self) -> usize {
        self.pending.len()
    }

    /// Flies what is missing; `each` is called with every flight as it ends. All rows, in the order of the flights.
    ///
    /// # Errors
    /// The journal cannot be written: one line naming it.
    pub fn fly(mut self, mut each: impl FnMut(&Row)) -> Result<Vec<Row>, String> {
        let is_stopped = AtomicBool::new(false);
        let mut failure = None;
        let (campaign, journal) = (self.campaign, &mut self.journal);
        let flown = parallel::map(
            &self.pending,
            self.settings.jobs,
            |&index| (!is_stopped.load(Ordering::Relaxed)).then(|| campaign.fly(index)),
            |row| {
                let Some(row) = row else { return };
                if failure.is_some() {
                    return;
                }
                match journal.append(row) {
                    Ok(()) => each(row),
                    Err(e) => {
                        failure = Some(e);
                        is_stopped.store(true, Ordering::Relaxed);
                    }
                }
            },
        );
        if let Some(e) = failure {
            return Err(e);
        }
        self.rows.extend(flown.into_iter().flatten());
        self.rows.sort_by_key(|row| row.index);
        Ok(self.rows)
    }
}

/// Why what stands in the folder cannot be continued.
fn is_of(old: &Start, new: &Start) -> Result<(), String> {
    old.header.same_campaign(&new.header)?;
    if old.shard != new.shard {
        return Err(format!("holds shard {}, not {}", old.shard, new.shard));
    }
    Ok(())
}

/// Results of an earlier campaign say nothing of this one.
fn remove_results(out: &Path) -> Result<(), String> {
    let old = [TABLE, SUMMARY].map(|name| out.join(name)).into_iter().chain(failed::files(out));
    for path in old.filter(|path| path.exists()) {
        fs::remove_file(&path).map_err(|e| format!("{}: {e}", path.display()))?;
    }
    Ok(())
}

/// Writes `flights.parquet` and `summary.json`.
///
/// # Errors
/// One line naming the file.
pub fn write_tables(out: &Path, header: &Header, rows: &[Row]) -> Result<Summary, String> {
    fs::create_dir_all(out).map_err(|e| format!("{}: {e}", out.display()))?;
    write_parquet(&out.join(TABLE), header, rows)?;
    let summary = summary(header, rows);
    let path = out.join(SUMMARY);
    let text = serde_json::to_string_pretty(&summary).map_err(|e| e.to_string())?;
    fs::write(&path, text + "\n").map_err(|e| format!("{}: {e}", path.display()))?;
    Ok(summary)
}

impl Campaign {
    /// Writes all results of a session: tables, and the failed flights with their logs.
    ///
    /// # Errors
    /// One line naming the file.
    pub fn finish(
        &self,
        settings: &Settings,
        rows: &[Row],
    ) -> Result<(Summary, Vec<Kept>), String> {
        let summary = write_tables(&settings.out, self.header(), rows)?;
        let kept = keep_failed(self, rows, &settings.out, settings.keep_logs, settings.jobs)?;
        Ok((summary, kept))
    }
}
