//! The command line: `cargo sitl …`.

/// Prints a line; a reader that has gone away (`| head`) is no reason to crash.
macro_rules! say {
    ($($arg:tt)*) => {{
        use std::io::Write;
        let _ = writeln!(std::io::stdout(), $($arg)*);
    }};
}

mod campaign;
mod console;
mod emulate;
mod experiment;
mod export;
mod fly;
mod network;
mod outcome;
mod plot;
mod progress;
mod replay;
mod scenario;
mod speed;
mod status;
mod sysid;
mod tautbench;

use crate::flight::topics_page;
use crate::scenario::params_file;
use clap::{Parser, Subcommand};
use std::path::Path;
use std::process::ExitCode;
use tautline_firmware::param::Params;

/// What a command may end with: a message for the operator and an exit code.
#[derive(Debug)]
pub enum Failure {
    /// A bad option, file or value: code 2.
    Usage(String),
    /// The run itself failed: code 1.
    Run(String),
}

/// Flies Tautline's flight core against a simulated tethered quadrotor.
#[derive(Debug, Parser)]
#[command(
    name = "sitl",
    version,
    args_conflicts_with_subcommands = true,
    after_help = "Examples:\n  cargo sitl\n  cargo sitl --speedup 10 --param TET_TENSION=8\n  cargo sitl --headless --scenario sitl/scenarios/gusts-3.toml --seed 7\n  cargo sitl campaign sitl/campaigns/gusts-3.toml --out out"
)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    fly: fly::Options,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Fly a scenario and speak MAVLink over UDP (the default).
    Fly(fly::Options),
    /// Fly a scenario many times, varied, and judge it against limits.
    Campaign(campaign::Options),
    /// Fly a flight image under QEMU beside the same flight here.
    Emulate(emulate::Options),
    /// Reproduce a result of the papers.
    Experiment(experiment::Options),
    /// Identify thrust from PWM.
    Sysid(sysid::Options),
    /// Measure what simulated time costs.
    Speed(speed::Options),
    /// Run a log's recorded inputs through the firmware's step again.
    Replay(replay::Options),
    /// Write a log as MCAP, for Foxglove and Rerun.
    Export(export::Options),
    /// Draw a log.
    Plot(plot::Options),
    /// Measure estimators on a tether: flights, truth, scores, one table.
    Tautbench(tautbench::Options),
    /// Print a scenario with every key, or check one.
    Scenario(scenario::Options),
    /// Print every topic of a log with its fields and units.
    #[command(after_help = "Example:\n  cargo sitl topics > docs/topics.md")]
    Topics,
    /// Print all parameters in QGroundControl's file format.
    #[command(after_help = "Example:\n  cargo sitl params > mine.params")]
    Params,
}

/// `--params`: what is passed over is told, and no reason to stop.
fn load_params(params: &mut Params, file: &Path) -> Result<(), Failure> {
    for warning in params_file::load(params, file).map_err(Failure::Usage)? {
        eprintln!("warning: {warning}");
    }
    Ok(())
}

/// What is wrong, with the names that may follow on lines of their own, on one line.
fn complaint(text: &str) -> String {
    let lines = text.lines().map(str::trim).take_while(|line| !line.is_empty());
    let words: Vec<_> = lines.collect();
    if words.is_empty() { "error: bad arguments".into() } else { words.join(" ") }
}

/// Runs the command line; bad options end with code 2.
#[must_use]
pub fn run() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(e) if !e.use_stderr() => {
            let _ = e.print();
            return ExitCode::SUCCESS;
        }
        // One line that names what is wrong; `--help` has the rest.
        Err(e) => {
            eprintln!("{}", complaint(&e.to_string()));
            return ExitCode::from(2);
        }
    };
    let result = match cli.command {
        None => fly::run(&cli.fly),
        Some(Command::Fly(options)) => fly::run(&options),
        Some(Command::Campaign(options)) => campaign::run(&options),
        Some(Command::Emulate(options)) => emulate::run(&options),
        Some(Command::Experiment(options)) => experiment::run(&options),
        Some(Command::Sysid(options)) => sysid::run(&options),
        Some(Command::Speed(options)) => speed::run(&options),
        Some(Command::Replay(options)) => replay::run(&options),
        Some(Command::Export(options)) => export::run(&options),
        Some(Command::Plot(options)) => plot::run(&options),
        Some(Command::Tautbench(options)) => tautbench::run(&options),
        Some(Command::Scenario(options)) => scenario::run(&options),
        Some(Command::Topics) => {
            say!("{}", topics_page().trim_end());
            Ok(())
        }
        Some(Command::Params) => {
            say!("{}", params_file::to_text(&Params::default()).trim_end());
            Ok(())
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Usage(message)) => {
            eprintln!("error: {message}");
            ExitCode::from(2)
        }
        Err(Failure::Run(message)) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}
