//! `cargo sitl experiment`.

use super::Failure;
use crate::experiment::{EXPERIMENTS, Experiment, Overrides, find};
use clap::Args;
use std::fs;
use std::path::PathBuf;

/// Options of an experiment.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  cargo sitl experiment --list\n  cargo sitl experiment planar-compression --plot out\n  cargo sitl experiment planar-nominal --set rate_hz=250 --json"
)]
pub struct Options {
    /// Which one
    #[arg(value_name = "KEY", required_unless_present = "list")]
    key: Option<String>,
    /// Print all keys
    #[arg(long)]
    list: bool,
    /// Change a setting; wins over the experiment's own
    #[arg(long, value_name = "PATH=VALUE")]
    set: Vec<String>,
    /// Seed of the random numbers
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print one JSON object instead of the table
    #[arg(long)]
    json: bool,
    /// Write the pictures there
    #[arg(long, value_name = "DIR")]
    plot: Option<PathBuf>,
}

/// Runs one, or lists all.
pub fn run(options: &Options) -> Result<(), Failure> {
    let Some(key) = options.key.as_deref().filter(|_| !options.list) else {
        for e in &EXPERIMENTS {
            say!("{:<22} {} ({}): {}", e.key, e.paper, e.figure, e.about);
        }
        return Ok(());
    };
    let experiment = find(key).ok_or_else(|| {
        Failure::Usage(format!("{key}: no such experiment; cargo sitl experiment --list"))
    })?;
    let sets = options
        .set
        .iter()
        .map(|set| match set.split_once('=') {
            Some((path, value)) => Ok((path.trim().to_owned(), value.trim().to_owned())),
            None => Err(Failure::Usage(format!("--set {set}: not PATH=VALUE"))),
        })
        .collect::<Result<Vec<_>, _>>()?;
    show(experiment, options, Overrides { sets, seed: options.seed })
}

fn show(experiment: &Experiment, options: &Options, overrides: Overrides) -> Result<(), Failure> {
    let report = (experiment.run)(&overrides).map_err(Failure::Usage)?;
    if options.json {
        say!("{}", report.json(experiment.key, overrides.seed, &overrides.sets));
    } else {
        say!("{} ({}): {}", experiment.paper, experiment.figure, experiment.about);
        for line in &report.lines {
            say!("{}", line.text());
        }
        for note in &report.notes {
            say!("{note}");
        }
    }
    if let Some(folder) = &options.plot {
        let named = |e: &dyn std::fmt::Display| Failure::Run(format!("{}: {e}", folder.display()));
        fs::create_dir_all(folder).map_err(|e| named(&e))?;
        for picture in &report.pictures {
            let path = folder.join(picture.name);
            (picture.draw)(&path).map_err(|e| named(&e))?;
            if !options.json {
                say!("Picture: {}", path.display());
            }
        }
    }
    if report.passes() {
        Ok(())
    } else {
        let failed = report.lines.iter().filter(|line| !line.passes()).count();
        Err(Failure::Run(format!("{}: {failed} figures are not as they should be", experiment.key)))
    }
}
