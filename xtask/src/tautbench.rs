//! The table of estimators in `docs/tautbench.md`, from flights flown anew. Some minutes on two cores.

use crate::figures::{replaced, sitl};
use crate::{Outcome, SITL, root, run};
use std::fs;

const PAGE: &str = "docs/tautbench.md";
const DATA: &str = "target/tautbench";

/// A few cells, one flight each: generated, and all methods over them.
pub fn few() -> Outcome {
    const FEW: &str = "target/tautbench-few";
    const CELLS: &str = "fixed-10m-3mps,cut-3mps,30gpm-25m-calm,taut-force-3mps";
    let _ = fs::remove_dir_all(root().join(FEW));
    let generate = ["tautbench", "generate", "--out", FEW, "--cells", CELLS, "--seeds", "1"];
    run(SITL, &generate)?;
    run(SITL, &["tautbench", "table", FEW])
}

/// Flies the whole grid and rewrites the table.
pub fn write() -> Outcome {
    // Data of an earlier simulator would be refused.
    let _ = fs::remove_dir_all(root().join(DATA));
    let said = |arguments: &[&str]| match sitl(arguments)? {
        (text, true) => Ok(text),
        (text, false) => Err(format!("sitl {}: {text}", arguments.join(" "))),
    };
    said(&["tautbench", "generate", "--out", DATA])?;
    let table = said(&["tautbench", "table", DATA])?;
    let path = root().join(PAGE);
    let named = |e: String| format!("{PAGE}: {e}");
    let text = fs::read_to_string(&path).map_err(|e| named(e.to_string()))?;
    let new = replaced(&text, "table", "tautbench", &table).map_err(named)?;
    fs::write(&path, new).map_err(|e| named(e.to_string()))
}
