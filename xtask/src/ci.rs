//! Everything that must hold before a change lands.

use crate::{
    Outcome, SITL, book, cost, figures, images, install, params, python, root, run, run_with,
    tautbench, view,
};
use std::process::Command;

const BOARD: &str = "thumbv7em-none-eabihf";
const SMALLEST: &str = "thumbv6m-none-eabi";
const DENY_WARNINGS: [(&str, &str); 1] = [("RUSTDOCFLAGS", "-D warnings")];

/// All checks; the test runner's closing line comes last.
pub fn everything() -> Outcome {
    install::rust_targets(&[BOARD, SMALLEST])?;
    let clients = install::python_clients()?;
    run("cargo", &["fmt", "--all", "--check"])?;
    run("cargo", &["clippy", "--all-targets", "--locked", "--", "-D", "warnings"])?;
    let beside =
        ["-p", "tautline-python", "-p", "tautline-view-wasm", "-p", "tautline-view-bindgen"];
    run("cargo", &[&["clippy", "--locked"], &beside[..], &["--", "-D", "warnings"]].concat())?;
    images::lint()?;
    cost::lint()?;
    params::check()?;
    book::build()?;
    // The images prove the larger cores; the smallest shall not be lost.
    let smallest = ["check", "--locked", "-p", "tautline-firmware", "-p", "tautline-hal-shim"];
    run("cargo", &[&smallest[..], &["--target", SMALLEST]].concat())?;
    // Fewer techniques than all must build, and refuse what they lack.
    let fewer = ["test", "--locked", "-p", "tautline-firmware", "--no-default-features", "--lib"];
    run("cargo", &[&fewer[..], &["--features", "cable"]].concat())?;
    nopanic()?;
    run_with("cargo", &["doc", "--no-deps", "--locked"], &DENY_WARNINGS)?;
    images::size(false)?;
    images::walk()?;
    images::emulate(&[])?;
    cost::check()?;
    fly_clients(&clients)?;
    view::test()?;
    python::check()?;
    campaigns()?;
    tautbench::few()?;
    figures::check(false)?;
    experiments()?;
    run("cargo", &["test", "--locked", "--doc"])?;
    let tested = [
        "-p",
        "tautline-firmware",
        "-p",
        "tautline-runtime",
        "-p",
        "tautline-hal-shim",
        "-p",
        "tautline-sitl",
        "-p",
        "tautline-tests",
        "-p",
        "xtask",
    ];
    run(
        "cargo",
        &[&["test", "--locked", "--all-features", "--lib", "--bins", "--tests"], &tested[..]]
            .concat(),
    )
}

/// The table of faults, into `docs/faults.md` or, as figures, to standard output.
pub fn faults(options: &[&str]) -> Outcome {
    let (mut seeds, mut to) = ("20", &["--plot", "docs"][..]);
    let mut options = options.iter();
    while let Some(option) = options.next() {
        match *option {
            "--json" => to = &["--json"],
            "--seeds" => seeds = options.next().ok_or("--seeds: how many?")?,
            other => return Err(format!("faults: unknown option {other}")),
        }
    }
    run("cargo", &["build", "--release", "--locked", "-p", "tautline-sitl"])?;
    let seeds = format!("seeds={seeds}");
    run(SITL, &[&["experiment", "faults", "--set", &seeds], to].concat())
}

/// The pymavlink flights alone.
pub fn clients() -> Outcome {
    fly_clients(&install::python_clients()?)
}

fn fly_clients(python: &str) -> Outcome {
    images::build_emulated().map(drop)?;
    run("cargo", &["build", "--release", "--locked", "-p", "tautline-sitl"])?;
    run(python, &["-m", "pytest", "-q", "-s", "tests/clients"])
}

/// A few seeds of each table; the whole table is `cargo sitl campaign FILE --out DIR`.
fn campaigns() -> Outcome {
    for name in ["calm", "gusts-3", "gusts-5", "fixed", "fixed-gusts-3"] {
        let file = format!("sitl/campaigns/{name}.toml");
        let out = format!("target/campaigns/{name}");
        // What an interrupted run left there would be refused.
        let _ = std::fs::remove_dir_all(root().join(&out));
        run(SITL, &["campaign", &file, "--seeds", "3", "--out", &out])?;
    }
    Ok(())
}

/// Every reproduced result against its published figures; the flights with a few seeds.
fn experiments() -> Outcome {
    let whole = [
        "planar-nominal",
        "planar-initial-errors",
        "planar-parameters",
        "planar-general-model",
        "planar-noise",
        "planar-motors",
        "planar-compression",
        "planar-observer-forms",
        "planar-acceptance",
        "planar-robustness",
        "tether-sensitivity",
        "tether-poles",
        "tether-loop",
        "tether-space",
        "localization-tension",
        "localization-sweeps",
        "localization-headroom",
        "thrust-structures",
        "sensing-acceptance",
        "pendulum-simulation",
        "pendulum-hardware",
        "pendulum-baseline",
        "pendulum-acceptance",
    ];
    for key in whole {
        let folder = format!("target/experiments/{key}");
        run(SITL, &["experiment", key, "--plot", &folder])?;
    }
    for (key, seeds) in [
        ("taut-flight", 4),
        ("angle-flight", 4),
        ("thrust-flight", 2),
        ("line-flights", 1),
        ("fullstate-table", 5),
        ("fullstate-faults", 3),
        ("which-sensor", 3),
        ("faults", 1),
        ("policy", 150),
        ("fixed-point", 1),
        ("pendulum-sweeps", 1),
        ("pendulum-flight", 2),
    ] {
        run(SITL, &["experiment", key, "--set", &format!("seeds={seeds}")])?;
    }
    run(SITL, &["sysid", "tests/golden/sysid.csv", "--plot", "target/experiments/sysid"])
}

/// The flight step must link without a panic handler, and the same program with a panic must not.
pub fn nopanic() -> Outcome {
    install::rust_targets(&[BOARD])?;
    let link =
        ["build", "--locked", "-p", "tautline-nopanic", "--profile", "nopanic", "--target", BOARD];
    run("cargo", &link)?;
    let canary = Command::new("cargo")
        .args(link)
        .args(["--features", "canary"])
        .current_dir(crate::root())
        .output()
        .map_err(|e| format!("cargo: {e}"))?;
    let text = String::from_utf8_lossy(&canary.stderr);
    if canary.status.success() || !text.contains("tautline_step_may_panic") {
        return Err(format!("the canary's panic was not found by the linker:\n{text}"));
    }
    println!("no panic is reachable from Vehicle::step; the canary's was found");
    Ok(())
}
