//! `cargo sitl scenario`.

use super::Failure;
use crate::scenario::{Scenario, reference, template};
use clap::Args;
use std::path::PathBuf;

/// Options.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  cargo sitl scenario --template > mine.toml\n  cargo sitl scenario mine.toml"
)]
#[group(required = true, multiple = false)]
pub struct Options {
    /// Check a file and its parameters
    #[arg(value_name = "FILE.toml")]
    file: Option<PathBuf>,
    /// Print a file with every key, its unit, range and default
    #[arg(long)]
    template: bool,
    /// Print docs/scenarios.md
    #[arg(long)]
    reference: bool,
}

/// Prints or checks.
pub fn run(options: &Options) -> Result<(), Failure> {
    if options.template {
        say!("{}", template().trim_end());
    } else if options.reference {
        say!("{}", reference().trim_end());
    } else if let Some(file) = &options.file {
        let scenario = Scenario::load(file).map_err(|e| Failure::Usage(e.0))?;
        for warning in scenario
            .params()
            .and_then(|params| scenario.contradictions(&params))
            .map_err(|e| Failure::Usage(e.0))?
        {
            eprintln!("warning: {warning}");
        }
        say!(
            "{}: a scenario of {} steps and {} faults",
            file.display(),
            scenario.mission.len(),
            scenario.fault.len()
        );
    }
    Ok(())
}
