//! Gives the linker the memory of the part.

use std::path::PathBuf;

fn main() {
    let memory = "../../../memory.x";
    println!("cargo:rerun-if-changed={memory}");
    let out = PathBuf::from(std::env::var_os("OUT_DIR").unwrap_or_default());
    if let Err(e) = std::fs::copy(memory, out.join("memory.x")) {
        println!("cargo:error={memory}: {e}");
    }
    println!("cargo:rustc-link-search={}", out.display());
    if std::env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none") {
        println!("cargo:rustc-link-arg-bins=-Tlink.x");
        println!("cargo:rustc-link-arg-bins=--nmagic");
    }
}
