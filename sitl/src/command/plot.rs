//! `cargo sitl plot`.

use super::Failure;
use crate::report::{FlightData, Kind, draw_flight};
use clap::Args;
use std::path::PathBuf;

/// Options of a picture.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  cargo sitl plot logs/flight-0001.ulg --out flight.svg\n  cargo sitl plot logs/flight-0001.ulg --panel map --panel wind"
)]
pub struct Options {
    /// A log that the simulator wrote
    #[arg(value_name = "LOG.ulg")]
    log: PathBuf,
    /// The picture
    #[arg(long, value_name = "FILE.svg", default_value = "flight.svg")]
    out: PathBuf,
    /// Draw this alone (repeatable); else whatever the log has
    #[arg(long, value_name = "NAME")]
    panel: Vec<Kind>,
    /// Its title
    #[arg(long, default_value = "Tautline: a flight on the tether")]
    title: String,
}

/// Draws.
pub fn run(options: &Options) -> Result<(), Failure> {
    let data = FlightData::read(&options.log).map_err(Failure::Usage)?;
    for note in &data.notes {
        eprintln!("{}: {note}", options.log.display());
    }
    draw_flight(&data, &options.title, &options.panel, &options.out).map_err(Failure::Run)?;
    say!("Picture: {}", options.out.display());
    Ok(())
}
