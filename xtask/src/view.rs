//! The page of `cargo sitl --view`: one file of HTML from `view/`, and the same page with the simulator inside.

use crate::install::{debian, rust_targets};
use crate::{Outcome, root, run};
use serde_json::json;
use std::fs;
use tautline_firmware::model::Rotors;
use tautline_firmware::param::{META, Params};
use tautline_firmware::supervisor::{FAILSAFES, MODES};

/// What the command line embeds.
const PAGE: &str = "sitl/src/view/page.html";
/// What a log's numbers mean.
const TABLES: &str = "view/src/firmware.json";
const LOCK: &str = "view/package-lock.json";
const STAMP: &str = "view/node_modules/.package-lock.stamp";
const BUILT: &str = "target/view";
const TARGET: &str = "wasm32-unknown-unknown";
/// Of the simulator's module, bytes.
const LARGEST: u64 = 5_000_000;

fn write_file(file: &str, text: &str) -> Outcome {
    fs::write(root().join(file), text).map_err(|e| format!("{file}: {e}"))
}

fn read_file(file: &str) -> Result<String, String> {
    fs::read_to_string(root().join(file)).map_err(|e| format!("{file}: {e}"))
}

/// Modes by their numbers in the log, rows of the failsafe table by their bits, frames by `VEH_FRAME`.
fn tables() -> String {
    let modes: Vec<_> = MODES
        .iter()
        .map(|rule| json!({ "nav_state": rule.nav_state(), "name": rule.name }))
        .collect();
    let failsafes: Vec<_> = FAILSAFES.iter().map(|row| row.text).collect();
    let last = META.iter().find(|meta| meta.name == "VEH_FRAME").map_or(0, |meta| meta.max as u8);
    let frame = |frame: u8| {
        let rotors = Rotors::of(&Params { frame: f32::from(frame), ..Params::default() });
        let place = |x: f32| (f64::from(x) * 1e4).round() * 1e-4;
        let rotors = rotors
            .iter()
            .map(|rotor| json!({ "x": place(rotor.x), "y": place(rotor.y), "spin": rotor.spin }));
        rotors.collect::<Vec<_>>()
    };
    let frames: Vec<_> = (0..=last).map(frame).collect();
    format!("{:#}\n", json!({ "modes": modes, "failsafes": failsafes, "frames": frames }))
}

/// The packages that the lock file names, from npm.
fn packages() -> Outcome {
    let wanted = read_file(LOCK)?;
    if read_file(STAMP).unwrap_or_default() == wanted {
        return Ok(());
    }
    println!("installing into view/node_modules from npm what {LOCK} names");
    run("npm", &["ci", "--prefix", "view", "--ignore-scripts", "--no-audit", "--no-fund"])
        .map_err(|e| format!("{e}\nNode.js 20 or newer with npm is needed (https://nodejs.org)"))?;
    write_file(STAMP, &wanted)
}

/// The page into a file, checked by TypeScript first.
fn bundle(out: &str, module: Option<&str>) -> Outcome {
    let script = ["view/build.mjs", out];
    run("node", &[&script[..], module.as_slice()].concat())
}

fn page(out: &str) -> Outcome {
    packages()?;
    run("node", &["view/node_modules/typescript/bin/tsc", "--noEmit", "-p", "view"])?;
    bundle(out, None)
}

/// The simulator for browsers, and the page with it inside: `target/view/index.html`.
fn with_simulator() -> Outcome {
    rust_targets(&[TARGET])?;
    run(
        "cargo",
        &["build", "--locked", "--profile", "web", "-p", "tautline-view-wasm", "--target", TARGET],
    )?;
    let module = format!("target/{TARGET}/web/tautline_view_wasm.wasm");
    let folder = format!("{BUILT}/module");
    let bindgen = ["run", "--locked", "--quiet", "-p", "tautline-view-bindgen", "--"];
    run("cargo", &[&bindgen[..], &[&module, &folder]].concat())?;
    let bound = root().join(&folder).join("simulation_bg.wasm");
    let size = fs::metadata(&bound).map_err(|e| format!("{}: {e}", bound.display()))?.len();
    println!("simulator and firmware for browsers: {:.2} MB", size as f64 * 1e-6);
    if size > LARGEST {
        return Err(format!("the module has {size} bytes, more than {LARGEST}"));
    }
    bundle(&format!("{BUILT}/index.html"), Some(&folder))
}

/// Writes the page that is committed, and builds `target/view/`.
pub fn build() -> Outcome {
    write_file(TABLES, &tables())?;
    page(PAGE)?;
    with_simulator()
}

/// What is committed is what the sources make.
pub fn check() -> Outcome {
    let made = format!("{BUILT}/page.html");
    if read_file(TABLES)? != tables() {
        return Err(format!("{TABLES} is not what the firmware has: run `cargo xtask view`"));
    }
    page(&made)?;
    if read_file(&made)? != read_file(PAGE)? {
        return Err(format!("{PAGE} is not what view/ makes: run `cargo xtask view`"));
    }
    Ok(())
}

/// Flies the page in a browser without a window: live, from a log, and by itself.
pub fn test() -> Outcome {
    debian("chromium", "chromium")?;
    check()?;
    with_simulator()?;
    run("cargo", &["build", "--locked", "--release", "-p", "tautline-sitl", "--bin", "sitl"])?;
    let folder = fs::read_dir(root().join("view/test")).map_err(|e| format!("view/test: {e}"))?;
    let mut tests: Vec<String> = folder
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| name.ends_with(".test.mjs"))
        .map(|name| format!("view/test/{name}"))
        .collect();
    tests.sort();
    let tests: Vec<&str> = tests.iter().map(String::as_str).collect();
    run("node", &[&["--test", "--test-concurrency=1"], tests.as_slice()].concat())
}
