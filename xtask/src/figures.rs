//! The README's measured figures, from the runs that measure them.
//!
//! A table between `<!-- figures:NAME -->` and `<!-- /figures -->` is generated; figures outside are
//! written by hand, with the command beside them. Takes a minute.

use crate::{Outcome, root, run};
use serde_json::Value;
use std::fmt::Write;
use std::fs;
use std::path::PathBuf;
use std::process::Command;

const FILE: &str = "README.md";
const END: &str = "<!-- /figures -->";

/// A campaign and what the table says beside its name.
const CAMPAIGNS: [(&str, &str); 5] = [
    ("calm", ""),
    ("gusts-3", "3 m/s, Dryden"),
    ("gusts-5", "5 m/s, Dryden"),
    ("fixed", "10 m line, calm"),
    ("fixed-gusts-3", "the same, 3 m/s, Dryden"),
];

/// A row of the second table: an experiment, a sentence, and the metrics for its figures, `{}` each with the
/// decimals that follow its colon.
struct Row {
    experiment: &'static str,
    what: &'static str,
    figures: &'static str,
    metrics: &'static [&'static str],
}

const ROWS: [Row; 5] = [
    Row {
        experiment: "taut-flight",
        what: "taut link by inertia, 45→75° and 6→10 N, worst of 20: elevation, link force rms",
        figures: "{1}°, {2} N; in gusts of 3 m/s {1}°, {2} N",
        metrics: &[
            "gamma_b_45_to_75_deg_6_to_10_n_still_elevation_rms_deg",
            "gamma_b_45_to_75_deg_6_to_10_n_still_link_force_rms_n",
            "gamma_b_45_to_75_deg_6_to_10_n_gusts_of_3_m_s_elevation_rms_deg",
            "gamma_b_45_to_75_deg_6_to_10_n_gusts_of_3_m_s_link_force_rms_n",
        ],
    },
    Row {
        experiment: "taut-flight",
        what: "bar at -3 N of compression, from 5 s after the crossing, worst of 20: elevation, link force rms",
        figures: "{1}°, {2} N",
        metrics: &[
            "bar_45_deg_10_s_at_minus3_n_from_5_s_after_the_crossing_elevation_rms_deg",
            "bar_45_deg_10_s_at_minus3_n_from_5_s_after_the_crossing_link_force_rms_n",
        ],
    },
    Row {
        experiment: "angle-flight",
        what: "tether held 30° from straight up while the anchor walks 1 m, worst of 20: estimate, tracking rms",
        figures: "{1}°, {1}°",
        metrics: &[
            "30_deg_thrust_14_mps2_estimate_rms_deg",
            "30_deg_thrust_14_mps2_tracking_rms_deg",
        ],
    },
    Row {
        experiment: "thrust-flight",
        what: "thrust error after identification from the flight's own log, worst of 5",
        figures: "{1} %, from {1} %",
        metrics: &["after_thrust_error_percent", "before_thrust_error_percent"],
    },
    Row {
        experiment: "pendulum-flight",
        what: "load of 30 g balanced on 0.7 m along a circle under motion capture, without, with constant and with \
               stochastic disturbance, worst of 10 each: mean error; lost",
        figures: "{1}, {1}, {1} cm; {0}",
        metrics: &[
            "no_disturbance_mean_error_worst_seed_cm",
            "constant_mean_error_worst_seed_cm",
            "stochastic_mean_error_worst_seed_cm",
            "stochastic_lost_of_10_1",
        ],
    },
];

/// Rewrites the tables.
pub fn write() -> Outcome {
    let text = fs::read_to_string(path()).map_err(|e| format!("{FILE}: {e}"))?;
    fs::write(path(), renewed(&text)?).map_err(|e| format!("{FILE}: {e}"))
}

/// Compares the tables with what is measured.
pub fn check() -> Outcome {
    let text = fs::read_to_string(path()).map_err(|e| format!("{FILE}: {e}"))?;
    let new = renewed(&text)?;
    if new == text {
        return Ok(());
    }
    let moved = new.lines().filter(|line| !text.lines().any(|old| old == *line));
    for line in moved {
        println!("+ {line}");
    }
    Err(format!("{FILE} is stale: cargo xtask figures"))
}

fn path() -> PathBuf {
    root().join(FILE)
}

fn renewed(text: &str) -> Result<String, String> {
    run("cargo", &["build", "--release", "--locked", "-p", "tautline-sitl"])?;
    let text = replaced(text, "campaigns", &campaigns()?)?;
    replaced(&text, "experiments", &experiments()?)
}

/// The text with another table between the markers of this name.
fn replaced(text: &str, name: &str, table: &str) -> Result<String, String> {
    let begin = format!("<!-- figures:{name} -->\n");
    let missing = || format!("{FILE}: no {} … {END}", begin.trim());
    let (before, rest) = text.split_once(&begin).ok_or_else(missing)?;
    let (_, after) = rest.split_once(END).ok_or_else(missing)?;
    Ok(format!("{before}{begin}\n{table}\n{END}{after}"))
}

fn sitl(arguments: &[&str]) -> Result<String, String> {
    eprintln!("\n== sitl {}", arguments.join(" "));
    let out = Command::new("cargo")
        .args(["run", "--release", "--locked", "--quiet", "-p", "tautline-sitl", "--"])
        .args(arguments)
        .current_dir(root())
        .output()
        .map_err(|e| format!("cargo: {e}"))?;
    let text = String::from_utf8_lossy(&out.stdout).into_owned();
    if out.status.success() {
        return Ok(text);
    }
    let why = String::from_utf8_lossy(&out.stderr).into_owned();
    Err(format!("sitl {} failed:\n{text}{why}", arguments.join(" ")))
}

fn campaigns() -> Result<String, String> {
    let mut table = String::from(
        "| campaign | hold, horizontal rms: mean / worst | hold, vertical rms: worst | touch-down: worst | lost |\n\
         |---|---|---|---|---|\n",
    );
    for (name, about) in CAMPAIGNS {
        let folder = format!("target/figures/{name}");
        // What was measured before, perhaps not to its end, is not gone on with.
        let _ = fs::remove_dir_all(root().join(&folder));
        sitl(&["campaign", &format!("sitl/campaigns/{name}.toml"), "--out", &folder])?;
        let file = root().join(&folder).join("summary.json");
        let text = fs::read_to_string(&file).map_err(|e| format!("{}: {e}", file.display()))?;
        let summary: Value = serde_json::from_str(&text).map_err(|e| e.to_string())?;
        let row = campaign_row(name, about, &summary);
        let row = row.ok_or_else(|| format!("{}: figures are missing", file.display()))?;
        let _ = writeln!(table, "{row}");
    }
    Ok(table)
}

fn campaign_row(name: &str, about: &str, summary: &Value) -> Option<String> {
    let figure = |key: &str, of: &str| summary.get("figures")?.get(key)?.get(of)?.as_f64();
    let count = |key: &str| summary.get(key)?.as_u64();
    let seeds = format!("{} seeds", count("flown")?);
    let about = if about.is_empty() { seeds } else { format!("{about}; {seeds}") };
    Some(format!(
        "| `{name}` ({about}) | {:.2} / {:.2} m | {:.2} m | {:.2} m/s | {} |",
        figure("hold_horizontal_rms_m", "mean")?,
        figure("hold_horizontal_rms_m", "max")?,
        figure("hold_vertical_rms_m", "max")?,
        figure("touch_down_mps", "max")?,
        count("incomplete")?,
    ))
}

fn experiments() -> Result<String, String> {
    let mut table = String::from("| | | how |\n|---|---|---|\n");
    let mut last: Option<(&str, Value)> = None;
    for row in &ROWS {
        let key = row.experiment;
        let metrics = match last.take() {
            Some((known, metrics)) if known == key => metrics,
            _ => {
                let text = sitl(&["experiment", key, "--json"])?;
                let line = text.lines().last().unwrap_or_default();
                let report: Value =
                    serde_json::from_str(line).map_err(|e| format!("{key}: {e}"))?;
                report.get("metrics").cloned().unwrap_or_default()
            }
        };
        let figures = filled(row, &metrics)?;
        let _ = writeln!(table, "| {} | {figures} | `cargo sitl experiment {key}` |", row.what);
        last = Some((key, metrics));
    }
    Ok(table)
}

/// The row's figures: each `{DECIMALS}` is the next metric.
fn filled(row: &Row, metrics: &Value) -> Result<String, String> {
    let mut parts = row.figures.split('{');
    let mut text = parts.next().unwrap_or_default().to_owned();
    for (part, metric) in parts.zip(row.metrics) {
        let value = metrics.get(metric).and_then(Value::as_f64);
        let value = value.ok_or_else(|| format!("{}: no metric {metric}", row.experiment))?;
        let (decimals, rest) = part.split_once('}').ok_or("a figure without its end")?;
        let decimals: usize = decimals.parse().map_err(|e| format!("{}: {e}", row.figures))?;
        let _ = write!(text, "{value:.decimals$}{rest}");
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn only_what_stands_between_the_markers_is_replaced() {
        let text = "a\n<!-- figures:x -->\nold\n<!-- /figures -->\nb\n";
        let new = replaced(text, "x", "new\n").unwrap_or_default();
        assert_eq!(new, "a\n<!-- figures:x -->\n\nnew\n\n<!-- /figures -->\nb\n");
        assert_eq!(replaced(&new, "x", "new\n").as_deref(), Ok(new.as_str()));
        assert!(replaced(text, "y", "new").is_err());
    }

    #[test]
    fn a_campaigns_row_has_mean_worst_and_lost() {
        let summary = json!({
            "flown": 2,
            "incomplete": 1,
            "figures": {
                "hold_horizontal_rms_m": { "mean": 0.2, "max": 0.3 },
                "hold_vertical_rms_m": { "mean": 0.01, "max": 0.01 },
                "touch_down_mps": { "mean": 0.4, "max": 0.4 },
            },
        });
        let row = campaign_row("calm", "", &summary);
        let want = "| `calm` (2 seeds) | 0.20 / 0.30 m | 0.01 m | 0.40 m/s | 1 |";
        assert_eq!(row.as_deref(), Some(want));
        assert_eq!(campaign_row("calm", "", &json!({ "flown": 2 })), None);
    }

    #[test]
    fn every_row_has_a_metric_for_each_figure() {
        for row in &ROWS {
            assert_eq!(row.figures.matches('{').count(), row.metrics.len(), "{}", row.what);
        }
        let metrics =
            json!({ "after_thrust_error_percent": 0.84, "before_thrust_error_percent": 11.5 });
        let [_, _, _, row, _] = &ROWS;
        assert_eq!(filled(row, &metrics).as_deref(), Ok("0.8 %, from 11.5 %"));
        assert!(filled(row, &json!({})).is_err());
    }
}
