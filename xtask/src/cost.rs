//! `docs/cost.md`: instructions per call and stack of each block, on an emulated Cortex-M4F and Cortex-M3.

use crate::figures::Figures;
use crate::{Outcome, SITL, images, install, root, run, run_with};
use std::fmt::Write;
use std::process::{Command, Stdio};

const FILE: &str = "docs/cost.md";
const M4F: &str = "Cortex-M4F";
const M3: &str = "Cortex-M3";
const CORES: [Core; 2] = [
    Core { name: M4F, target: "thumbv7em-none-eabihf", machine: "netduinoplus2" },
    Core { name: M3, target: "thumbv7m-none-eabi", machine: "netduino2" },
];
/// The whole step.
const STEP: &str = "whole Vehicle::step";
/// Flights in which the whole step is counted, with the emulated F405.
const FLIGHTS: [&str; 3] = ["board", "angle", "taut"];
/// Most instructions that a call may take, by core, block and scalar.
const LIMITS: [(&str, &str, &str, u32); 15] = [
    (M4F, "pendulum filter, predict 9 states", "f32", 1_500),
    (M4F, "pendulum filter, 4 scalar updates", "f32", 4 * 1_200),
    (M4F, "unscented tether-angle filter", "f32", 6_000),
    (M4F, "4-state filter, 5 rows", "f32", 2_500),
    (M4F, "attitude law", "f32", 800),
    (M4F, "high-gain observer and force law", "f32", 3_000),
    (M4F, "whole Vehicle::step, board.toml", "f32", 12_700),
    (M4F, "whole Vehicle::step, angle.toml", "f32", 12_500),
    (M4F, "whole Vehicle::step, taut.toml", "f32", 12_500),
    (M3, "attitude filter", "Q16", 5_000),
    (M3, "4-state filter, 5 rows", "Q16", 12_000),
    (M3, "high-gain observer and force law", "Q16", 8_000),
    (M3, "tether-angle law, one plane", "Q16", 2_000),
    (M3, "attitude law", "Q16", 4_500),
    (M3, "mixer and thrust map", "Q16", 2_500),
];
/// On average over a flight; the full-state filter takes half of it.
const STEP_AVERAGE: u32 = 8_500;

struct Core {
    name: &'static str,
    target: &'static str,
    machine: &'static str,
}

/// One line of the program's.
struct Row {
    core: &'static str,
    block: String,
    scalar: String,
    average: u32,
    worst: u32,
    stack: u32,
}

impl Row {
    fn limit(&self) -> Option<u32> {
        let is_this = |(core, block, scalar, _): &&(&str, &str, &str, u32)| {
            *core == self.core && *block == self.block && *scalar == self.scalar
        };
        LIMITS.iter().find(is_this).map(|(.., limit)| *limit)
    }
}

fn parse(core: &'static str, line: &str) -> Option<Row> {
    let fields: Vec<&str> = line.split(';').collect();
    let [block, scalar, average, worst, stack] = fields.as_slice() else { return None };
    Some(Row {
        core,
        block: (*block).to_owned(),
        scalar: (*scalar).to_owned(),
        average: average.parse().ok()?,
        worst: worst.parse().ok()?,
        stack: stack.parse().ok()?,
    })
}

fn count(core: &Core) -> Result<Vec<Row>, String> {
    install::rust_targets(&[core.target])?;
    let build = [
        "build",
        "--locked",
        "--profile",
        "flight",
        "-p",
        "tautline-cost",
        "--target",
        core.target,
    ];
    run_with("cargo", &build, &[])?;
    let image = root().join("target").join(core.target).join("flight/tautline-cost");
    let out = Command::new("qemu-system-arm")
        .args(["-M", core.machine, "-nographic", "-monitor", "none", "-serial", "null"])
        .args(["-semihosting-config", "enable=on,target=native", "-icount", "shift=0", "-kernel"])
        .arg(image)
        .stdin(Stdio::null())
        .output()
        .map_err(|e| format!("qemu-system-arm: {e}"))?;
    let text = String::from_utf8_lossy(&out.stdout);
    let rows: Option<Vec<Row>> = text.lines().map(|line| parse(core.name, line)).collect();
    rows.filter(|rows| out.status.success() && !rows.is_empty())
        .ok_or_else(|| format!("the counting program ended badly: {text}"))
}

/// The lints of the counting program.
pub fn lint() -> Outcome {
    for core in &CORES {
        install::rust_targets(&[core.target])?;
        let clippy = [
            "clippy",
            "--locked",
            "-p",
            "tautline-cost",
            "--target",
            core.target,
            "--",
            "-D",
            "warnings",
        ];
        run_with("cargo", &clippy, &[])?;
    }
    Ok(())
}

fn all() -> Result<Vec<Row>, String> {
    install::qemu()?;
    let mut rows = Vec::new();
    for core in &CORES {
        rows.extend(count(core)?);
    }
    rows.extend(flights()?);
    Ok(rows)
}

/// The whole step over flights of the emulated F405.
fn flights() -> Result<Vec<Row>, String> {
    let image = images::build_emulated()?.path();
    run("cargo", &["build", "--release", "--locked", "-p", "tautline-sitl"])?;
    let mut rows = Vec::new();
    for flight in FLIGHTS {
        // Its end may differ from the host's, which `cargo xtask emulate` judges where it must not.
        let out = Command::new(SITL)
            .args(["emulate", "--within", "5", "--scenario"])
            .arg(format!("sitl/scenarios/{flight}.toml"))
            .arg("--image")
            .arg(&image)
            .current_dir(root())
            .output()
            .map_err(|e| format!("sitl: {e}"))?;
        let text = String::from_utf8_lossy(&out.stdout);
        let row = out.status.success().then(|| flown(flight, &text)).flatten();
        rows.push(row.ok_or_else(|| format!("{flight}: the emulated flight ended badly: {text}"))?);
    }
    Ok(rows)
}

/// From what `sitl emulate` says.
fn flown(flight: &str, text: &str) -> Option<Row> {
    let number = |after: &str| -> Option<u32> {
        text.split_once(after)?.1.split_whitespace().next()?.parse().ok()
    };
    Some(Row {
        core: M4F,
        block: format!("{STEP}, {flight}.toml"),
        scalar: "f32".into(),
        average: number("Vehicle::step:")?,
        worst: number(" steps,")?,
        stack: number("Stack:")?,
    })
}

fn table(rows: &[Row]) -> String {
    let mut out = String::from(
        "# What a call costs\n\nGenerated by `cargo xtask cost`; do not edit. Instructions per call, the core built at \
         `-O3`, counted by a timer of QEMU's under `-icount shift=0`; stack in bytes below the caller. Two hundred \
         calls on one input after twenty to warm up. CI fails when a limit is passed or this table is stale. The whole \
         `Vehicle::step` is counted in the F405 image, built as it is flown, over whole emulated flights; its stack is \
         the image's deepest.",
    );
    let _ = writeln!(out, " It may take {STEP_AVERAGE} on average.");
    for core in &CORES {
        let _ = write!(
            out,
            "\n## {}\n\n| block | scalar | average | worst | limit | stack |\n|---|---|---|---|---|---|\n",
            core.name
        );
        for row in rows.iter().filter(|row| row.core == core.name) {
            let limit = row.limit().map_or("-".to_owned(), |limit| limit.to_string());
            let Row { block, scalar, average, worst, stack, .. } = row;
            let _ =
                writeln!(out, "| {block} | {scalar} | {average} | {worst} | {limit} | {stack} |");
        }
    }
    out
}

fn judge(rows: &[Row]) -> Outcome {
    let dear: Vec<String> = rows
        .iter()
        .filter_map(|row| Some((row, row.limit()?)))
        .filter(|(row, limit)| {
            row.worst > *limit || row.block.starts_with(STEP) && row.average > STEP_AVERAGE
        })
        .map(|(row, limit)| format!("{}: {} of {limit}", row.block, row.worst))
        .collect();
    if dear.is_empty() { Ok(()) } else { Err(format!("over the limit: {}", dear.join(", "))) }
}

/// Counts, writes the table and prints it.
pub fn write() -> Outcome {
    let rows = all()?;
    let text = table(&rows);
    println!("{text}");
    std::fs::write(root().join(FILE), text).map_err(|e| format!("{FILE}: {e}"))?;
    judge(&rows)
}

/// The same but for counts that differ by a hundredth: the last instructions depend on the host's own arithmetic.
fn is_close(found: &str, text: &str) -> bool {
    let (mut found, mut text) = (found.split_whitespace(), text.split_whitespace());
    loop {
        let (a, b) = match (found.next(), text.next()) {
            (None, None) => return true,
            (Some(a), Some(b)) => (a, b),
            _ => return false,
        };
        let is_same = match (a.parse::<u32>(), b.parse::<u32>()) {
            (Ok(a), Ok(b)) => a.abs_diff(b) <= b / 100 + 2,
            _ => a == b,
        };
        if !is_same {
            return false;
        }
    }
}

/// Counts and compares with the table.
pub fn check() -> Outcome {
    let rows = all()?;
    judge(&rows)?;
    let found = std::fs::read_to_string(root().join(FILE)).unwrap_or_default();
    let text = table(&rows);
    if is_close(&found, &text) {
        return Ok(());
    }
    println!("{text}");
    Err(format!("{FILE} is stale: cargo xtask cost"))
}

/// Counts, for tables of figures: `CORE BLOCK SCALAR average` and `… worst`.
pub fn figures() -> Result<Figures, String> {
    let mut figures = Figures::new();
    for Row { core, block, scalar, average, worst, .. } in all()? {
        figures.insert(format!("{core} {block} {scalar} average"), average.into());
        figures.insert(format!("{core} {block} {scalar} worst"), worst.into());
    }
    Ok(figures)
}

/// Counts and prints a JSON array.
pub fn json() -> Outcome {
    let rows = all()?;
    let objects: Vec<String> = rows
        .iter()
        .map(|row| {
            let limit = row.limit().map_or("null".to_owned(), |limit| limit.to_string());
            format!(
                "{{\"core\":\"{}\",\"block\":\"{}\",\"scalar\":\"{}\",\"instructions\":{},\"worst_instructions\":{},\"limit_instructions\":{limit},\"stack_bytes\":{}}}",
                row.core, row.block, row.scalar, row.average, row.worst, row.stack
            )
        })
        .collect();
    println!("[{}]", objects.join(","));
    judge(&rows)
}
