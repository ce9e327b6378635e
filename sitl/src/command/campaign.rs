//! `cargo sitl campaign`.

use super::Failure;
use super::progress::Progress;
use crate::campaign::{
    Campaign, Figure, Merged, Session, Settings, Shard, Summary, merge, parallel, write_tables,
};
use clap::{Args, Subcommand};
use std::path::PathBuf;

/// Options of a campaign.
#[derive(Debug, Args)]
#[command(
    args_conflicts_with_subcommands = true,
    after_help = "Examples:\n  cargo sitl campaign sitl/campaigns/spread.toml --out out\n  cargo sitl campaign sitl/campaigns/spread.toml --shard 2/4 --resume --out part-2\n  cargo sitl campaign merge part-1 part-2 part-3 part-4 --out whole"
)]
pub struct Options {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    fly: Option<Fly>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Join the folders of all shards of a campaign.
    #[command(after_help = "Example:\n  cargo sitl campaign merge part-1 part-2 --out whole")]
    Merge(Merge),
}

#[derive(Debug, Args)]
struct Merge {
    /// Folders of the shards
    #[arg(value_name = "DIR", required = true)]
    folders: Vec<PathBuf>,
    /// Where the joined results go
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

#[derive(Debug, Args)]
struct Fly {
    /// Scenario, seeds, what varies, limits: docs/campaigns.md
    #[arg(value_name = "FILE.toml")]
    file: PathBuf,
    /// Flights at the same time [default: as many as there are cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// Only the I-th of N parts
    #[arg(long, value_name = "I/N", default_value_t = Shard::WHOLE)]
    shard: Shard,
    /// Only the first so many seeds
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    seeds: Option<u64>,
    /// Go on with what DIR holds; fly what is missing
    #[arg(long)]
    resume: bool,
    /// Keep the logs of the first so many failed flights
    #[arg(long, value_name = "N", default_value_t = 20)]
    keep_logs: usize,
    /// Where the results go
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

/// Flies them all, or joins what was flown.
pub fn run(options: &Options) -> Result<(), Failure> {
    match (&options.command, &options.fly) {
        (Some(Command::Merge(options)), _) => join(options),
        (None, Some(options)) => fly(options),
        (None, None) => Err(Failure::Usage("campaign: expected FILE.toml or merge".into())),
    }
}

fn fly(options: &Fly) -> Result<(), Failure> {
    let campaign = Campaign::load_some(&options.file, options.seeds).map_err(Failure::Usage)?;
    let settings = Settings {
        out: options.out.clone(),
        shard: options.shard,
        jobs: options.jobs.map_or_else(parallel::cores, usize::from),
        resume: options.resume,
        keep_logs: options.keep_logs,
    };
    let session = Session::open(&campaign, &settings).map_err(Failure::Usage)?;
    let flown = session.rows().len();
    let part = if settings.shard == Shard::WHOLE {
        String::new()
    } else {
        format!(", shard {} of {}", settings.shard, campaign.flights())
    };
    let before = if flown > 0 { format!(", {flown} flown before") } else { String::new() };
    say!("{}: {} flights{part}{before}", campaign.header().title, flown + session.pending());
    let mut progress = Progress::new(session.pending() as u64);
    let rows = session.fly(|row| progress.count(row.pass)).map_err(Failure::Run)?;
    progress.close();
    let (summary, kept) = campaign.finish(&settings, &rows).map_err(Failure::Run)?;
    show(&summary);
    for kept in &kept {
        say!("Flight {} failed: {}\n  {}", kept.index, kept.reason, kept.command());
    }
    if summary.failed > kept.len() {
        say!("{} more failed.", summary.failed - kept.len());
    }
    say!("Results: {}", options.out.display());
    verdict(&summary)
}

fn join(options: &Merge) -> Result<(), Failure> {
    let is_shard = |folder: &&PathBuf| match (folder.canonicalize(), options.out.canonicalize()) {
        (Ok(folder), Ok(out)) => folder == out,
        _ => false,
    };
    if let Some(shard) = options.folders.iter().find(is_shard) {
        return Err(Failure::Usage(format!("--out {}: is one of the shards", shard.display())));
    }
    let Merged { header, rows } = merge(&options.folders).map_err(Failure::Usage)?;
    let summary = write_tables(&options.out, &header, &rows).map_err(Failure::Run)?;
    say!("{}: {} flights of {} folders", header.title, rows.len(), options.folders.len());
    show(&summary);
    say!("Results: {}", options.out.display());
    verdict(&summary)
}

fn show(summary: &Summary) {
    say!("{:34} {:>10} {:>10} {:>10} {:>10}", "", "p5", "p50", "p95", "max");
    for (name, Figure { p5, p50, p95, max, .. }) in &summary.figures {
        say!("{name:34} {p5:10.4} {p50:10.4} {p95:10.4} {max:10.4}");
    }
    let share = &summary.pass_share;
    say!(
        "{} of {} flights passed: {:.2} %, between {:.2} and {:.2} % with 95 % confidence (Wilson).",
        summary.passed,
        summary.flown,
        100.0 * share.share,
        100.0 * share.wilson_95_low,
        100.0 * share.wilson_95_high
    );
    for (reason, count) in &summary.reasons {
        say!("{count:6} x {reason}");
    }
    say!("Content: sha256 {}", summary.content_sha256);
}

fn verdict(summary: &Summary) -> Result<(), Failure> {
    if summary.failed == 0 {
        return Ok(());
    }
    Err(Failure::Run(format!("{} of {} flights failed", summary.failed, summary.flown)))
}
