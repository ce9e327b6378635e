//! Gives the linker the memory of the part: the image's own `memory.x`, or the reference board's; and the commit.

use std::path::{Path, PathBuf};

include!("revision.rs");

fn main() {
    tell_revision();
    let own = "memory.x";
    let memory = if Path::new(own).exists() { own } else { "../../../memory.x" };
    println!("cargo:rerun-if-changed={memory}");
    let out = PathBuf::from(std::env::var_os("OUT_DIR").unwrap_or_default());
    if let Err(e) = std::fs::copy(memory, out.join("memory.x")) {
        println!("cargo:error={memory}: {e}");
    }
    println!("cargo:rustc-link-search={}", out.display());
    if std::env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none") {
        println!("cargo:rustc-link-arg-bins=-Tlink.x");
        println!("cargo:rustc-link-arg-bins=--nmagic");
        // The counting program logs nothing.
        if std::env::var("CARGO_PKG_NAME").as_deref() != Ok("tautline-cost") {
            println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
        }
    }
}
