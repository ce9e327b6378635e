//! A command → what it measures.

use super::Figures;
use crate::{SITL, cost, images, root, run, speed};
use serde_json::Value;
use std::fs;
use std::process::Command;

/// Runs it.
///
/// # Errors
/// One line: no such command, or it failed.
pub fn measure(source: &str) -> Result<Figures, String> {
    match source.split(' ').collect::<Vec<_>>().as_slice() {
        ["sitl", "experiment", key] => experiment(key),
        ["sitl", "campaign", name] => campaign(name),
        ["xtask", "cost"] => cost::figures(),
        ["xtask", "size"] => images::figures(),
        ["xtask", "speed"] => speed::figures(),
        _ => Err(format!("cargo {source}: not known to measure figures")),
    }
}

/// What it prints, and whether all was as it should be.
pub fn sitl(arguments: &[&str]) -> Result<(String, bool), String> {
    run("cargo", &["build", "--release", "--locked", "--quiet", "-p", "tautline-sitl"])?;
    eprintln!("\n== sitl {}", arguments.join(" "));
    let out = Command::new(root().join(SITL))
        .args(arguments)
        .current_dir(root())
        .output()
        .map_err(|e| format!("sitl: {e}"))?;
    eprint!("{}", String::from_utf8_lossy(&out.stderr));
    Ok((String::from_utf8_lossy(&out.stdout).into_owned(), out.status.success()))
}

/// Its metrics. One beyond its limit is a figure all the same, and told: the page shall not be better than the truth.
fn experiment(key: &str) -> Result<Figures, String> {
    let (text, passes) = sitl(&["experiment", key, "--json"])?;
    if !passes {
        eprintln!("{key}: a figure is not within its limits");
    }
    let line = text.lines().last().unwrap_or_default();
    let report: Value = serde_json::from_str(line).map_err(|e| format!("{key}: {e}"))?;
    let metrics = report.get("metrics").and_then(Value::as_object);
    let metrics = metrics.ok_or_else(|| format!("{key}: no metrics"))?;
    let numbers = metrics.iter().filter_map(|(name, value)| Some((name.clone(), value.as_f64()?)));
    Ok(numbers.collect())
}

/// `FIGURE.STATISTIC`, and how many flew and did not come to their end.
fn campaign(name: &str) -> Result<Figures, String> {
    let folder = format!("target/figures/{name}");
    // What was measured before, perhaps not to its end, is not gone on with.
    let _ = fs::remove_dir_all(root().join(&folder));
    let (text, passes) =
        sitl(&["campaign", &format!("sitl/campaigns/{name}.toml"), "--out", &folder])?;
    if !passes {
        eprintln!("{name}: not within its limits:\n{text}");
    }
    let file = root().join(&folder).join("summary.json");
    let text = fs::read_to_string(&file).map_err(|e| format!("{}: {e}", file.display()))?;
    let summary: Value = serde_json::from_str(&text).map_err(|e| e.to_string())?;
    let mut figures = Figures::new();
    for key in ["flown", "incomplete"] {
        let count = summary.get(key).and_then(Value::as_f64);
        figures.insert(key.into(), count.ok_or_else(|| format!("{name}: no {key}"))?);
    }
    let spread = summary.get("figures").and_then(Value::as_object).into_iter().flatten();
    for (figure, statistics) in spread {
        for (statistic, value) in statistics.as_object().into_iter().flatten() {
            if let Some(value) = value.as_f64() {
                figures.insert(format!("{figure}.{statistic}"), value);
            }
        }
    }
    Ok(figures)
}
