//! `cargo sitl export`.

use super::Failure;
use crate::mcap::export;
use clap::Args;
use std::fs::File;
use std::io::BufWriter;
use std::path::PathBuf;

/// Options of an export.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  cargo sitl export logs/flight-0001.ulg --out flight.mcap\n\nFoxglove and Rerun open the file."
)]
pub struct Options {
    /// A log, of the simulator, of a board or from elsewhere
    #[arg(value_name = "LOG.ulg")]
    log: PathBuf,
    /// The MCAP file; beside the log if it is not named
    #[arg(long, value_name = "FILE.mcap")]
    out: Option<PathBuf>,
    /// Take the stream of inputs that a replay needs along
    #[arg(long)]
    inputs: bool,
}

/// Writes the log anew.
pub fn run(options: &Options) -> Result<(), Failure> {
    let name = options.log.display();
    let named = |e: String| Failure::Usage(format!("{name}: {e}"));
    let bytes = std::fs::read(&options.log).map_err(|e| named(e.to_string()))?;
    let path = options.out.clone().unwrap_or_else(|| options.log.with_extension("mcap"));
    if std::fs::canonicalize(&path)
        .is_ok_and(|to| std::fs::canonicalize(&options.log).ok() == Some(to))
    {
        return Err(Failure::Usage(format!("--out {}: that is the log itself", path.display())));
    }
    // Half a file would pass for a flight, and one of an earlier export stands until this one is whole.
    let part = path.with_extension("mcap.part");
    let failed = |e: std::io::Error| Failure::Usage(format!("{}: {e}", path.display()));
    let file = File::create(&part).map_err(failed)?;
    let written = export(&bytes, BufWriter::new(file), options.inputs).map_err(|e| {
        let _ = std::fs::remove_file(&part);
        named(e)
    })?;
    std::fs::rename(&part, &path).map_err(failed)?;
    for note in &written.notes {
        eprintln!("{name}: {note}");
    }
    say!(
        "{}: {} topics, {} samples, {} texts.",
        path.display(),
        written.topics,
        written.samples,
        written.texts
    );
    Ok(())
}
