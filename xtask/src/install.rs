//! What the checks need beyond Rust. Each says what it installs before it does.

use crate::{root, run};
use std::process::Command;

/// Rust's own targets, for the toolchain that the project names.
pub fn rust_targets(targets: &[&str]) -> Result<(), String> {
    let listed = Command::new("rustup")
        .args(["target", "list", "--installed"])
        .current_dir(root())
        .output()
        .map_err(|e| {
            format!("rustup (https://rustup.rs) is needed to install {}: {e}", targets.join(", "))
        })?;
    let listed = String::from_utf8_lossy(&listed.stdout);
    for target in targets {
        if !listed.lines().any(|line| line == *target) {
            println!("installing the Rust target {target} with rustup");
            run("rustup", &["target", "add", target])?;
        }
    }
    Ok(())
}

/// A Python environment of the project's own with the real clients; its interpreter.
pub fn python_clients() -> Result<String, String> {
    python("target/venv", "tests/clients/requirements.txt")
}

/// Another one to build the Python package in; its interpreter.
pub fn python_package() -> Result<String, String> {
    python("target/venv-python", "python/requirements.txt")
}

fn python(folder: &str, requirements: &str) -> Result<String, String> {
    let (stamp, interpreter) =
        (format!("{folder}/requirements.txt"), format!("{folder}/bin/python"));
    let wanted = std::fs::read_to_string(root().join(requirements))
        .map_err(|e| format!("{requirements}: {e}"))?;
    let present = std::fs::read_to_string(root().join(&stamp)).unwrap_or_default();
    if wanted != present {
        println!(
            "installing into {folder} from PyPI: {}",
            wanted.lines().filter(|l| !l.starts_with('#')).collect::<Vec<_>>().join(", ")
        );
        let needs =
            |e| format!("{e}\nPython 3.11 or newer with venv is needed (Debian: python3-venv)");
        run("python3", &["-m", "venv", folder]).map_err(needs)?;
        run(
            &interpreter,
            &["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "-r", requirements],
        )?;
        std::fs::write(root().join(&stamp), wanted).map_err(|e| format!("{stamp}: {e}"))?;
    }
    Ok(interpreter)
}

/// The linker that puts the stack below the data.
pub fn flip_link() -> Result<String, String> {
    tool("flip-link", "0.1.12", &[])
}

/// What makes a book of Markdown; without its server.
pub fn mdbook() -> Result<String, String> {
    tool("mdbook", "0.5.4", &["--no-default-features"])
}

const TOOLS: &str = "target/tools";

/// A program from crates.io, in the project's own folder.
fn tool(name: &str, version: &str, more: &[&str]) -> Result<String, String> {
    let installed = std::fs::read_to_string(root().join(TOOLS).join(".crates.toml"));
    if !installed.unwrap_or_default().contains(&format!("\"{name} {version} ")) {
        println!("installing {name} {version} into {TOOLS} from crates.io");
        let install = ["install", name, "--version", version, "--locked", "--root", TOOLS];
        run("cargo", &[&install[..], more].concat())?;
    }
    let program = root().join(TOOLS).join("bin").join(name);
    let program = program.canonicalize().map_err(|e| format!("{name}: {e}"))?;
    Ok(program.display().to_string())
}

/// QEMU for Arm.
pub fn qemu() -> Result<(), String> {
    debian("qemu-system-arm", "qemu-system-arm")
}

/// A program of a Debian package, where there is none yet.
pub fn debian(program: &str, package: &str) -> Result<(), String> {
    if Command::new(program).arg("--version").output().is_ok() {
        return Ok(());
    }
    let apt = ["apt-get", "install", "-y", "--no-install-recommends", package];
    println!("installing Debian's package {package}");
    let is_root = Command::new("id")
        .arg("-u")
        .output()
        .is_ok_and(|out| String::from_utf8_lossy(&out.stdout).trim() == "0");
    let needs = |e| format!("{e}\n{program} is needed: install the package {package}");
    let as_root = |arguments: &[&str]| match arguments {
        [program, rest @ ..] if is_root => run(program, rest),
        _ => run("sudo", &[&["-n"], arguments].concat()),
    };
    as_root(&["apt-get", "update", "-q"]).and_then(|()| as_root(&apt)).map_err(needs)
}
