//! The Python package: its wheel, lints, types, tests and the notebook.

use crate::{Outcome, install, root, run, run_in};

const WHEELS: &str = "target/wheels";

/// Builds the wheel, installs it into an environment of its own under `target/`, and checks it there.
pub fn check() -> Outcome {
    let python = install::python_package()?;
    // What is left of an earlier version would be a second candidate.
    let _ = std::fs::remove_dir_all(root().join(WHEELS));
    let build = ["-m", "maturin", "build", "--release", "--locked", "--out", WHEELS];
    run(&python, &[&build[..], &["--manifest-path", "python/Cargo.toml"]].concat())?;
    println!("installing the wheel into the same environment");
    let pip = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
    let wheel = ["--no-index", "--no-deps", "--force-reinstall", "--find-links", WHEELS];
    run(&python, &[&pip[..], &wheel, &["tautline"]].concat())?;
    // From the package's folder, where mypy's and pytest's settings stand.
    let absolute = root().join(&python);
    let python = absolute.display().to_string();
    run_in("python", &python, &["-m", "ruff", "check"], &[])?;
    run_in("python", &python, &["-m", "ruff", "format", "--check"], &[])?;
    run_in("python", &python, &["-m", "mypy"], &[])?;
    run_in("python", &python, &["-m", "pytest"], &[])
}
