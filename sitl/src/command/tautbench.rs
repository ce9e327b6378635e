//! `cargo sitl tautbench`.

use super::Failure;
use super::progress::Progress;
use crate::campaign::parallel;
use crate::tautbench::{DataSet, Grid, Settings, generate, one, page, score_folder, table};
use clap::{Args, Subcommand};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Options of the benchmark.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  cargo sitl tautbench generate --out data\n  cargo sitl tautbench score data estimates\n  cargo sitl tautbench table data\n\nFormats and rules: docs/tautbench.md. The small sample: sitl/tautbench/sample."
)]
pub struct Options {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Fly the grid's cells, write what an estimator may read and, apart from it, the truth
    #[command(
        after_help = "Example:\n  cargo sitl tautbench generate --out data --cells wind,cut-3mps --seeds 2"
    )]
    Generate(Generate),
    /// Compare a folder of estimates with the truth
    #[command(
        after_help = "Example:\n  cargo sitl tautbench score data estimates --name mine --json"
    )]
    Score(Score),
    /// Run the firmware's own methods over the recorded inputs, all beside each other
    #[command(after_help = "Example:\n  cargo sitl tautbench table data > table.md")]
    Table(Table),
}

#[derive(Debug, Args)]
struct Generate {
    /// Where the data goes
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Only these cells or groups [default: all but the sample]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    cells: Vec<String>,
    /// Flights of a cell [default: as the grid says]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1000))]
    seeds: Option<u64>,
    /// Also each flight's log, for `sitl replay`: some 100 KB a simulated second
    #[arg(long)]
    logs: bool,
}

#[derive(Debug, Args)]
struct Score {
    /// The data set
    #[arg(value_name = "DATA")]
    data: PathBuf,
    /// A file of estimates for each flight, FLIGHT.csv or FLIGHT.parquet
    #[arg(value_name = "ESTIMATES")]
    estimates: PathBuf,
    /// Of the estimator, in the table
    #[arg(long, default_value = "estimates")]
    name: String,
    /// Print one JSON object instead of the tables
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Args)]
struct Table {
    /// The data set
    #[arg(value_name = "DATA")]
    data: PathBuf,
    /// Print one JSON object instead of the tables
    #[arg(long)]
    json: bool,
}

/// Generates, scores, or compares.
pub fn run(options: &Options) -> Result<(), Failure> {
    match &options.command {
        Command::Generate(options) => generate_data(options),
        Command::Score(options) => score(options),
        Command::Table(options) => compare(options),
    }
}

fn generate_data(options: &Generate) -> Result<(), Failure> {
    let grid = Grid::shipped().map_err(Failure::Usage)?;
    let cells = grid.chosen(&options.cells).map_err(|e| Failure::Usage(format!("--cells {e}")))?;
    let seeds = options.seeds.unwrap_or(grid.seeds);
    let settings =
        Settings { out: options.out.clone(), seeds, logs: options.logs, jobs: parallel::cores() };
    say!("{} cells, {seeds} flights each", cells.len());
    let mut progress = Progress::new(cells.len() as u64 * seeds);
    let manifest = generate(&cells, &settings, |is_whole| progress.count(is_whole));
    progress.close();
    let manifest = manifest.map_err(Failure::Usage)?;
    for flight in &manifest.flights {
        if let Some(why) = &flight.ended {
            say!("{}: {why}", flight.name);
        }
    }
    for flight in &manifest.left_out {
        say!("{}: left out: {}", flight.name, flight.ended);
    }
    say!("Data: {}", options.out.display());
    Ok(())
}

fn open(folder: &Path) -> Result<DataSet, Failure> {
    DataSet::open(folder).map_err(Failure::Usage)
}

fn score(options: &Score) -> Result<(), Failure> {
    let data = open(&options.data)?;
    let score = score_folder(&data, &options.name, &options.estimates).map_err(Failure::Usage)?;
    if options.json {
        return json(&score);
    }
    say!("{}", one(&score).trim_end());
    Ok(())
}

fn compare(options: &Table) -> Result<(), Failure> {
    let data = open(&options.data)?;
    let mut progress = Progress::new(data.manifest.flights.len() as u64);
    let scores = table(&data, |is_scored| progress.count(is_scored));
    progress.close();
    let scores = scores.map_err(Failure::Usage)?;
    if options.json {
        return json(&scores.iter().map(|(_, score)| score).collect::<Vec<_>>());
    }
    let grid = Grid::shipped().map_err(Failure::Usage)?;
    say!("{}", page(&data, &grid, &scores).trim_end());
    Ok(())
}

fn json(value: &impl Serialize) -> Result<(), Failure> {
    say!("{}", serde_json::to_string(value).map_err(|e| Failure::Run(e.to_string()))?);
    Ok(())
}
