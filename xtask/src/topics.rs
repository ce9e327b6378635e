//! `docs/topics.md` from the log's tables, as the simulator tells them.

use crate::{Outcome, root};
use std::process::Command;

const FILE: &str = "docs/topics.md";

fn text() -> Result<String, String> {
    let told = Command::new("cargo")
        .args(["run", "-q", "--release", "--locked", "-p", "tautline-sitl", "--", "topics"])
        .current_dir(root())
        .output()
        .map_err(|e| format!("cargo: {e}"))?;
    if told.status.success() {
        String::from_utf8(told.stdout).map_err(|e| format!("sitl topics: {e}"))
    } else {
        Err(format!("sitl topics: {}", String::from_utf8_lossy(&told.stderr)))
    }
}

/// Writes the file.
pub fn write() -> Outcome {
    std::fs::write(root().join(FILE), text()?).map_err(|e| format!("{FILE}: {e}"))
}

/// Compares the file with the tables.
pub fn check() -> Outcome {
    let found = std::fs::read_to_string(root().join(FILE)).unwrap_or_default();
    if found == text()? { Ok(()) } else { Err(format!("{FILE} is stale: cargo xtask topics")) }
}
