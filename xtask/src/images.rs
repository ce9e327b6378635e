//! The flight images: building, sizes, flashing, flights under emulation.

use crate::figures::Figures;
use crate::reach::Code;
use crate::{Outcome, SITL, install, root, run, run_with};
use object::{Object, ObjectSection, SectionFlags};
use std::path::PathBuf;
use std::process::Command;

/// One image and its limits.
pub struct Image {
    /// What `cargo xtask size` calls it.
    pub name: &'static str,
    package: &'static str,
    /// Its board's feature.
    board: &'static str,
    /// What of the core is in it.
    core: &'static str,
    target: &'static str,
    /// Vector of the flight task.
    flight: &'static str,
    /// Chip for probe-rs.
    chip: &'static str,
    /// Flash, bytes.
    flash: u64,
    /// Static RAM, bytes.
    ram: u64,
}

const M4F: &str = "thumbv7em-none-eabihf";
const PROFILE: &str = "flight";
const KIB: u64 = 1024;
/// Flash of every part here.
const PART: u64 = 1024 * KIB;
/// Every technique of the core.
const EVERYTHING: &str = "everything";
/// Limit of an F405 with everything: the radio took 16 KiB more than the 404 that were enough before, signing four.
const F405_FLASH: u64 = 426 * KIB;
/// What `cargo xtask size --full` builds the reference board's image with, one by one.
const CORES: [&str; 8] =
    ["", "cable", "full-state", "taut-link", "tether-angle", "capture", "pendulum", EVERYTHING];

/// All images.
pub const IMAGES: [Image; 5] = [
    Image {
        name: "speedybee-f405-v4",
        package: "tautline-f405",
        board: "speedybee-f405-v4",
        core: EVERYTHING,
        target: M4F,
        flight: "CAN1_SCE",
        chip: "STM32F405RG",
        flash: F405_FLASH,
        ram: 64 * KIB,
    },
    Image {
        name: "speedybee-f405-v4-cable",
        package: "tautline-f405",
        board: "speedybee-f405-v4",
        core: "cable",
        target: M4F,
        flight: "CAN1_SCE",
        chip: "STM32F405RG",
        flash: 276 * KIB,
        ram: 64 * KIB,
    },
    Image {
        name: "matek-f405-te",
        package: "tautline-f405",
        board: "matek-f405-te",
        core: EVERYTHING,
        target: M4F,
        flight: "CAN1_SCE",
        chip: "STM32F405RG",
        flash: F405_FLASH,
        ram: 64 * KIB,
    },
    Image {
        name: "matek-h743-slim-v3",
        package: "tautline-h743",
        board: "matek-h743-slim-v3",
        core: EVERYTHING,
        target: M4F,
        flight: "FDCAN1_IT0",
        chip: "STM32H743VI",
        flash: 440 * KIB,
        ram: 80 * KIB,
    },
    Image {
        name: "emulated-f405",
        package: "tautline-f405",
        board: "emulated",
        core: EVERYTHING,
        target: M4F,
        flight: "CAN1_SCE",
        chip: "",
        flash: F405_FLASH,
        ram: 64 * KIB,
    },
];

/// What an image takes.
pub struct Size {
    flash: u64,
    ram: u64,
}

impl Image {
    /// Of this name.
    pub fn named(name: &str) -> Result<&'static Self, String> {
        IMAGES.iter().find(|image| image.name == name).ok_or_else(|| {
            let known: Vec<&str> = IMAGES.iter().map(|image| image.name).collect();
            format!("no image {name}; there are {}", known.join(", "))
        })
    }

    /// Where the built image is.
    pub fn path(&self) -> PathBuf {
        root().join("target/images").join(format!("{}.elf", self.name))
    }

    /// Builds it, with the stack below the data.
    pub fn build(&self) -> Outcome {
        self.build_with(self.core)
    }

    /// The same with another choice of the core's techniques.
    fn build_with(&self, core: &str) -> Outcome {
        install::rust_targets(&[self.target])?;
        let linker = install::flip_link()?;
        let variable =
            format!("CARGO_TARGET_{}_LINKER", self.target.to_uppercase().replace('-', "_"));
        let arguments = [
            "build",
            "--locked",
            "--profile",
            PROFILE,
            "-p",
            self.package,
            "--no-default-features",
            "--features",
            &format!("{},{core}", self.board),
            "--target",
            self.target,
        ];
        run_with("cargo", &arguments, &[(&variable, &linker), ("DEFMT_LOG", "info")])?;
        // Boards of a family share the name of their package: keep each image under its own.
        let built = root().join("target").join(self.target).join(PROFILE).join(self.package);
        let path = self.path();
        let kept = path.parent().map_or(Ok(()), std::fs::create_dir_all);
        kept.and_then(|()| std::fs::copy(&built, &path).map(drop))
            .map_err(|e| format!("{}: {e}", path.display()))
    }

    /// Bytes of flash and static RAM.
    pub fn size(&self) -> Result<Size, String> {
        const ALLOC: u64 = 2;
        let path = self.path();
        let wrong = |e: String| format!("{}: {e}", path.display());
        let bytes = std::fs::read(&path).map_err(|e| wrong(e.to_string()))?;
        let file = object::File::parse(&*bytes).map_err(|e| wrong(e.to_string()))?;
        let mut size = Size { flash: 0, ram: 0 };
        for section in file.sections() {
            let SectionFlags::Elf { sh_flags } = section.flags() else { continue };
            if sh_flags & ALLOC == 0 {
                continue;
            }
            let is_ram = section.address() >= 0x2000_0000;
            let is_stored = section.file_range().is_some();
            if is_ram {
                size.ram += section.size();
            }
            if !is_ram || is_stored {
                size.flash += section.size();
            }
        }
        Ok(size)
    }
}

/// The lints, which differ by board.
pub fn lint() -> Outcome {
    for image in &IMAGES {
        install::rust_targets(&[image.target])?;
        let package = ["clippy", "--locked", "-p", image.package, "--no-default-features"];
        let features = format!("{},{}", image.board, image.core);
        let board = ["--features", &features, "--target", image.target];
        run("cargo", &[&package[..], &board[..], &["--", "-D", "warnings"]].concat())?;
    }
    Ok(())
}

/// Builds all images and checks their sizes.
pub fn size(json: bool) -> Outcome {
    for image in &IMAGES {
        image.build()?;
    }
    let mut rows = Vec::new();
    let mut passed = Vec::new();
    if !json {
        println!(
            "\n{:<24} {:>8} {:>8} {:>8}  {:>8} {:>8}",
            "image", "flash", "limit", "left", "RAM", "limit"
        );
    }
    for image in &IMAGES {
        let Size { flash, ram } = image.size()?;
        let left = PART.saturating_sub(flash);
        if json {
            rows.push(format!(
                "{{\"image\":\"{}\",\"flash_bytes\":{flash},\"flash_limit_bytes\":{},\"flash_left_bytes\":{left},\"ram_bytes\":{ram},\"ram_limit_bytes\":{}}}",
                image.name, image.flash, image.ram
            ));
        } else {
            println!(
                "{:<24} {flash:>8} {:>8} {left:>8}  {ram:>8} {:>8}",
                image.name, image.flash, image.ram
            );
        }
        if flash > image.flash || ram > image.ram {
            passed.push(image.name);
        }
    }
    if json {
        println!("[{}]", rows.join(","));
    }
    if passed.is_empty() { Ok(()) } else { Err(format!("over the limit: {}", passed.join(", "))) }
}

/// Sizes, for tables of figures: `IMAGE flash_kib` and `… ram_kib`.
pub fn figures() -> Result<Figures, String> {
    let mut figures = Figures::new();
    for image in &IMAGES {
        image.build()?;
        let Size { flash, ram } = image.size()?;
        for (what, bytes) in [("flash", flash), ("ram", ram)] {
            figures.insert(format!("{} {what}_kib", image.name), bytes as f64 / KIB as f64);
        }
    }
    Ok(figures)
}

/// Flash and static RAM of the reference board's image with each technique of the core alone, and with all.
pub fn size_by_core() -> Outcome {
    let image = Image::named("speedybee-f405-v4")?;
    let mut rows = Vec::new();
    for core in CORES {
        image.build_with(core)?;
        rows.push((core, image.size()?));
    }
    println!("\n{:<14} {:>8} {:>8}", "core", "flash", "RAM");
    for (core, Size { flash, ram }) in rows {
        println!("{:<14} {flash:>8} {ram:>8}", if core.is_empty() { "none" } else { core });
    }
    Ok(())
}

/// No panic may be in reach of a built image's flight task. The emulated board's back end is no part of a flight.
pub fn walk() -> Outcome {
    for image in IMAGES.iter().filter(|image| !image.chip.is_empty()) {
        let code = Code::read(&image.path())?;
        // A walk that misses the panics of the start-up code would miss any.
        if code.from("Reset")?.panic.is_none() {
            return Err(format!("{}: no panic found from Reset: the walk is blind", image.name));
        }
        let reached = code.from(image.flight)?;
        if let Some(way) = reached.panic {
            return Err(format!("{}: the flight task may panic: {}", image.name, way.join(" > ")));
        }
        println!(
            "{}: no panic is reachable from the flight task, {} functions; called through registers: {}",
            image.name,
            reached.count,
            reached.indirect.join(", ")
        );
    }
    Ok(())
}

/// Writes an image to a board by probe-rs, which must be there.
pub fn flash(name: &str) -> Outcome {
    let image = Image::named(name)?;
    if image.chip.is_empty() {
        return Err(format!("{name} is for an emulator"));
    }
    image.build()?;
    let path = image.path().display().to_string();
    let found = Command::new("probe-rs").arg("--version").output().is_ok();
    if !found {
        return Err(format!(
            "probe-rs is not installed (https://probe.rs); the image is {path}; docs/boards.md says how to flash it by DFU"
        ));
    }
    run("probe-rs", &["download", "--chip", image.chip, "--verify", &path])?;
    run("probe-rs", &["reset", "--chip", image.chip])
}

const BOARD_SCENARIO: &str = "sitl/scenarios/board.toml";

/// The image that QEMU runs, and QEMU.
pub fn build_emulated() -> Result<&'static Image, String> {
    install::qemu()?;
    let image = Image::named("emulated-f405")?;
    image.build()?;
    Ok(image)
}

/// Flies the emulated F405: a whole flight twice, a hard fault, a panic; extra arguments go to `sitl emulate`.
pub fn emulate(more: &[&str]) -> Outcome {
    let image = build_emulated()?;
    run("cargo", &["build", "--release", "--locked", "-p", "tautline-sitl"])?;
    let path = image.path().display().to_string();
    let fly = |scenario: &str, more: &[&str]| {
        let fixed = ["emulate", "--image", &path, "--scenario", scenario];
        run(SITL, &[&fixed[..], more].concat())
    };
    if !more.is_empty() {
        let named = more.contains(&"--scenario");
        let scenario: &[&str] = if named { &[] } else { &["--scenario", BOARD_SCENARIO] };
        let first = ["emulate", "--image", &path];
        return run(SITL, &[&first[..], scenario, more].concat());
    }
    fly(BOARD_SCENARIO, &["--twice"])?;
    fly(BOARD_SCENARIO, &["--injury", "hard-fault", "--injury-at", "8"])?;
    fly(BOARD_SCENARIO, &["--injury", "panic", "--injury-at", "8"])
}
