//! What simulated time costs: instructions per simulated millisecond, simulated seconds per second of processor time.

use crate::figures::Figures;
use crate::{Outcome, SITL, install, root, run};
use std::process::Command;

const CHAIN: &str = "tests/clients/mujoco_chain.py";
const PATH: &str = "tests/clients/mujoco_line.py";
const PYTHON: &str = "target/venv/bin/python";
const CALM: &str = "sitl/scenarios/calm.toml";
const LINE_5: &str = "sitl/scenarios/line-10.toml";
const LINE_10: &str = "sitl/scenarios/line-25.toml";
/// Two lengths of the same run, s: the difference leaves out start and take-off.
const LENGTHS: [u32; 2] = [20, 40];

/// A way to spend simulated time, and the instructions per millisecond that it may take.
struct Way {
    name: &'static str,
    arguments: &'static [&'static str],
    /// Option that says how long.
    length: &'static str,
    limit: u64,
}

const WAYS: [Way; 5] = [
    Way {
        name: "world alone",
        arguments: &["speed", "--plant"],
        length: "--seconds",
        limit: 3_500,
    },
    Way {
        name: "world alone, line of 5 segments",
        arguments: &["speed", "--plant", "--scenario", LINE_5],
        length: "--seconds",
        limit: 6_000,
    },
    Way {
        name: "world alone, line of 10 segments",
        arguments: &["speed", "--plant", "--scenario", LINE_10],
        length: "--seconds",
        limit: 8_000,
    },
    Way {
        name: "flight of a campaign",
        arguments: &["speed", "--flights", "1", "--scenario", CALM],
        length: "--seconds",
        limit: 9_000,
    },
    Way {
        name: "flight with log and telemetry",
        arguments: &["--headless", "--log-dir", "target/speed", "--scenario", CALM],
        length: "--duration",
        limit: 12_000,
    },
];

/// Instructions of a whole run.
fn count(way: &Way, seconds: u32) -> Result<u64, String> {
    let out = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null", SITL])
        .args(way.arguments)
        .args([way.length, &seconds.to_string()])
        .current_dir(root())
        .output()
        .map_err(|e| format!("valgrind: {e}"))?;
    let text = String::from_utf8_lossy(&out.stderr);
    let after = text.split_once("Collected :").map(|(_, rest)| rest);
    after
        .and_then(|rest| rest.split_whitespace().next()?.parse().ok())
        .ok_or_else(|| format!("{}: valgrind did not count: {text}", way.name))
}

/// Instructions per simulated millisecond.
fn each(way: &Way) -> Result<u64, String> {
    let [short, long] = LENGTHS;
    let counted = count(way, long)?.saturating_sub(count(way, short)?);
    Ok(counted / u64::from((long - short) * 1000))
}

fn prepare() -> Outcome {
    install::debian("valgrind", "valgrind")?;
    run("cargo", &["build", "--release", "--locked", "-p", "tautline-sitl"])
}

/// Instructions per simulated millisecond by the ways' names, for tables of figures.
pub fn figures() -> Result<Figures, String> {
    prepare()?;
    WAYS.iter().map(|way| Ok((way.name.to_owned(), each(way)? as f64))).collect()
}

/// What a program prints.
fn said(program: &str, arguments: &[&str]) -> Option<String> {
    let out = Command::new(program).args(arguments).current_dir(root()).output().ok()?;
    out.status.success().then(|| String::from_utf8_lossy(&out.stdout).trim().to_owned())
}

/// Counts, measures and prints; with `mujoco` installs that to compare with.
pub fn print(mujoco: bool) -> Outcome {
    prepare()?;
    if mujoco {
        install::python_clients()?;
        run(PYTHON, &["-m", "pip", "install", "--quiet", "mujoco"])?;
    }
    let mut dear = Vec::new();
    println!("{:<32} {:>15} {:>8}", "", "instructions/ms", "limit");
    for way in &WAYS {
        let each = each(way)?;
        println!("{:<32} {each:>15} {:>8}", way.name, way.limit);
        if each > way.limit {
            dear.push(way.name);
        }
    }
    let plain = ["speed", "--plant", "--seconds", "600"];
    let on_line = ["speed", "--plant", "--seconds", "300", "--scenario", LINE_10];
    for arguments in [&plain[..], &on_line, &["speed", "--flights", "20"]] {
        println!("{}: {}", arguments.join(" "), said(SITL, arguments).unwrap_or_default());
    }
    match said(PYTHON, &[CHAIN]) {
        Some(ratio) => println!("MuJoCo, a chain of 10 links at 1 kHz: {ratio} x"),
        None => println!("MuJoCo is not installed: cargo xtask speed --mujoco"),
    }
    let flown = said(SITL, &["experiment", "line-path", "--plot", "target/speed"]);
    let apart = flown.and_then(|_| said(PYTHON, &[PATH, "target/speed/line-path.csv"]));
    if let Some(apart) = apart {
        println!("A mass on 25 m of 30 g/m under the same thrusts, ours and MuJoCo's: {apart}");
    }
    if dear.is_empty() { Ok(()) } else { Err(format!("over the limit: {}", dear.join(", "))) }
}
