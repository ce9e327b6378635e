//! Project tasks. `cargo xtask ci` passes all tests from a fresh clone; the others are its parts.

mod book;
mod ci;
mod citations;
mod claims;
mod cost;
mod figures;
mod images;
mod install;
mod params;
mod python;
mod reach;
mod speed;
mod tautbench;
mod topics;
mod view;

use std::{
    process::{Command, ExitCode},
    sync::OnceLock,
    time::Instant,
};

/// What a task may end with: one line for whoever ran it.
type Outcome = Result<(), String>;

const USAGE: &str = "usage: cargo xtask TASK

  ci             install what is missing, then check everything (what .ci/run runs)
  params         write docs/parameters.md from the parameter table; --check only compares
  book           make a book of docs/ by mdBook, which is installed first: target/book/index.html; fails on a page that
                 docs/SUMMARY.md lacks, and on a link that leads nowhere
  topics         write docs/topics.md from the log's tables; --check only compares
  citations      follow every cited section, key of a paper and link between documents; the README's figures must
                 have a command or a link
  nopanic        link Vehicle::step with a panic handler that does not exist; walk the images' flight tasks
  clients        the pymavlink and pyulog flights alone
  size           build all images, print flash and static RAM against their limits; --json;
                 --full builds the reference board's with each technique of the core alone
  cost           count instructions per call on emulated cores, write docs/cost.md; --check only compares; --json
  speed          instructions per simulated millisecond against their limits, simulated seconds per second of
                 processor time; --mujoco installs MuJoCo from PyPI to compare with its chain
  faults         fly 20 seeds (--seeds N) of each fault in each phase of a flight, write docs/faults.md; --json
                 prints the figures instead
  figures        measure the figures of README and docs/, write docs/figures.json and the tables that say them, in a
                 quarter of an hour; --only COMMAND measures what that command does, as `sitl experiment fixed-point`;
                 --fill measures nothing; --check compares tables, file and a few figures, with --full all of them
  tautbench      fly every cell of TautBench, run the firmware's methods over them, write the table of docs/tautbench.md
  view           bundle the page of `cargo sitl --view` with Node.js, and target/view/ with the simulator inside as
                 WebAssembly; --check only compares the page; --test flies both in Debian's chromium
  python         build the Python package into an environment under target/, run its types, tests and notebook
  flash IMAGE    build an image and write it to a board by probe-rs
  emulate        fly the F405 image under QEMU beside the same flights here; further arguments go to
                 `sitl emulate` (cargo sitl emulate --help)";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let result = match words.as_slice() {
        ["ci"] => ci::everything(),
        ["params"] => params::write(),
        ["params", "--check"] => params::check(),
        ["book"] => book::build(),
        ["topics"] => topics::write(),
        ["topics", "--check"] => topics::check(),
        ["citations"] => citations::check(),
        ["nopanic"] => {
            ci::nopanic().and_then(|()| images::size(false)).and_then(|()| images::walk())
        }
        ["clients"] => ci::clients(),
        ["size"] => images::size(false),
        ["size", "--json"] => images::size(true),
        ["size", "--full"] => images::size_by_core(),
        ["cost"] => cost::write(),
        ["cost", "--check"] => cost::check(),
        ["cost", "--json"] => cost::json(),
        ["speed"] => speed::print(false),
        ["speed", "--mujoco"] => speed::print(true),
        ["faults", more @ ..] => ci::faults(more),
        ["figures"] => figures::write(None),
        ["figures", "--fill"] => figures::fill_again(),
        ["figures", "--only", command] => figures::write(Some(command)),
        ["figures", "--check"] => figures::check(false),
        ["figures", "--check", "--full"] => figures::check(true),
        ["tautbench"] => tautbench::write(),
        ["view"] => view::build(),
        ["view", "--check"] => view::check(),
        ["view", "--test"] => view::test(),
        ["python"] => python::check(),
        ["flash", image] => images::flash(image),
        ["emulate", more @ ..] => images::emulate(more),
        ["help" | "--help" | "-h"] => {
            println!("{USAGE}");
            return ExitCode::SUCCESS;
        }
        _ => {
            eprintln!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("xtask: {why}");
            ExitCode::FAILURE
        }
    }
}

/// The simulator, as `cargo build --release` leaves it.
const SITL: &str = "target/release/sitl";

/// When the first program was run.
static STARTED: OnceLock<Instant> = OnceLock::new();

/// Runs a program in the workspace and says so; its failure is the task's.
fn run(program: &str, arguments: &[&str]) -> Outcome {
    run_with(program, arguments, &[])
}

fn run_with(program: &str, arguments: &[&str], environment: &[(&str, &str)]) -> Outcome {
    run_in(".", program, arguments, environment)
}

/// In a folder of the workspace.
fn run_in(
    folder: &str,
    program: &str,
    arguments: &[&str],
    environment: &[(&str, &str)],
) -> Outcome {
    // Standard output is for results, which others may read. The seconds show what takes long.
    let since = STARTED.get_or_init(Instant::now).elapsed().as_secs();
    eprintln!("\n== {since} s: {program} {}", arguments.join(" "));
    let status = Command::new(program)
        .args(arguments)
        .envs(environment.iter().copied())
        .current_dir(root().join(folder))
        .status()
        .map_err(|e| format!("{program}: {e}"))?;
    if status.success() { Ok(()) } else { Err(format!("{program} {} failed", arguments.join(" "))) }
}

/// The workspace.
fn root() -> std::path::PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}
