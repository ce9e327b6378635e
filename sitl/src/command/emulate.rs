//! `cargo sitl emulate`: a flight image under QEMU beside the same flight on this machine.

use super::Failure;
use crate::emulated::{self, Outcome, Plan, Telemetry};
use crate::flight::{Flight, Progress};
use crate::ground::new_key;
use crate::scenario::Scenario;
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use tautline_firmware::param::Params;
use tautline_runtime::wire::{DEAR, Injury};

/// Options of an emulated flight.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  cargo xtask emulate            (builds the image and installs QEMU first)\n  cargo sitl emulate --image tautline-f405 --scenario sitl/scenarios/calm.toml --seed 3"
)]
pub struct Options {
    /// The image, built with the feature `emulated`
    #[arg(long, value_name = "ELF")]
    image: PathBuf,
    /// What is simulated, with its mission
    #[arg(long, value_name = "FILE.toml")]
    scenario: PathBuf,
    /// Everything random follows from it
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// End after so many simulated seconds
    #[arg(long, value_name = "S", default_value_t = 300.0)]
    duration: f64,
    /// Make the image suffer this, 3 s after the first arming could have been
    #[arg(long, value_enum)]
    injury: Option<InjuryKind>,
    /// When, s
    #[arg(long, value_name = "S", default_value_t = 20.0)]
    injury_at: f64,
    /// Serve the image's USART1 on this TCP port, in real time; the flight begins when a client connects
    #[arg(long, value_name = "PORT")]
    telemetry: Option<u16>,
    /// A signing key in the board's flash: 32 bytes, or 64 hexadecimal digits
    #[arg(long, value_name = "FILE")]
    signing_key: Option<PathBuf>,
    /// Fly it again and compare every byte
    #[arg(long)]
    twice: bool,
    /// Greatest distance between the final positions here and there, m
    #[arg(long, value_name = "M", default_value_t = 0.1)]
    within: f64,
    /// Where the FIFOs and the board's log go
    #[arg(long, value_name = "DIR", default_value = "target/emulated")]
    out: PathBuf,
}

/// What may be injected into the image.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum InjuryKind {
    /// An access that no bus answers
    HardFault,
    /// A panic
    Panic,
}

/// Flies.
pub fn run(options: &Options) -> Result<(), Failure> {
    let usage = |e: String| Failure::Usage(e);
    let scenario = Scenario::load(&options.scenario).map_err(|e| usage(e.to_string()))?;
    let params = scenario.params().map_err(|e| usage(e.to_string()))?;
    let injury = options.injury.map(|kind| {
        let injury = match kind {
            InjuryKind::HardFault => Injury::HardFault,
            InjuryKind::Panic => Injury::Panic,
        };
        (options.injury_at, injury)
    });
    let key = options.signing_key.as_deref().map(new_key).transpose().map_err(usage)?;
    let plan = Plan {
        image: &options.image,
        folder: &options.out,
        scenario: &scenario,
        params,
        key,
        seed: options.seed,
        limit: options.duration,
        injury,
        telemetry: options.telemetry.map_or(Telemetry::None, Telemetry::Tcp),
    };
    let failed = |e: std::io::Error| Failure::Run(e.to_string());
    let there = emulated::fly(&plan).map_err(failed)?;
    report(&there);
    if options.twice {
        let again = emulated::fly(&plan).map_err(failed)?;
        if again.digest != there.digest || again.log != there.log {
            return Err(Failure::Run("two runs of the same seed differ".into()));
        }
        say!("The second run is the same to the byte ({:016x}).", again.digest);
    }
    if injury.is_some() {
        return evaluate_injury(&there);
    }
    if options.telemetry.is_some() {
        return Ok(());
    }
    compare(options, &scenario, params, &there)
}

fn report(there: &Outcome) {
    for (time, text) in &there.texts {
        say!("{time:7.1} s  {text}");
    }
    let counts = &there.counts;
    say!(
        "{:.1} s simulated in {:.1} s ({:.1} x real time).",
        there.time,
        there.took,
        there.time / there.took
    );
    say!(
        "Vehicle::step: {:.0} instructions on average over {} steps, {} at worst (step {}), {} of more than {DEAR}; {} outputs lost.",
        counts.instructions as f64 / f64::from(counts.steps.max(1)),
        counts.steps,
        counts.worst,
        counts.worst_step,
        counts.dear,
        counts.lost_outputs
    );
    say!("Stack: {} of {} bytes.", counts.stack, counts.stack_room);
}

fn evaluate_injury(there: &Outcome) -> Result<(), Failure> {
    let reset = there.texts.iter().find(|(_, text)| text.starts_with("Reset:"));
    match (there.stopped_after, reset) {
        (Some(after), Some((_, text))) if after < 1.5e-3 => {
            say!(
                "Motors stopped {:.1} ms after the injury; told after the reset: {text}",
                after * 1e3
            );
            Ok(())
        }
        (Some(after), Some(_)) => Err(Failure::Run(format!("motors ran on for {after:.4} s"))),
        (None, _) => Err(Failure::Run("the motors ran on".into())),
        (_, None) => Err(Failure::Run("nobody told of the reset".into())),
    }
}

fn compare(
    options: &Options,
    scenario: &Scenario,
    params: Params,
    there: &Outcome,
) -> Result<(), Failure> {
    let mut here = Flight::unrecorded(scenario, params, options.seed)
        .map_err(|e| Failure::Usage(e.to_string()))?;
    here.fly(options.duration);
    let position = here.world.environment.plant.from_anchor();
    let apart = (position - there.position).norm();
    let show = |p: &crate::plant::V3| format!("{:.3} {:.3} {:.3}", p.x, p.y, p.z);
    say!("            {:>26}  {:>26}", "on this machine", "on the emulated board");
    say!(
        "mission     {:>26}  {:>26}",
        show_progress(here.mission.progress()),
        show_progress(&there.progress)
    );
    say!("ended at    {:>24.2} s  {:>24.2} s", here.world.time(), there.time);
    say!("position, m {:>26}  {:>26}", show(&position), show(&there.position));
    let rms = here.metrics.estimate_horizontal.rms();
    say!(
        "estimate    {:>24.3} m  {:>24.3} m (horizontal; whole)",
        rms.unwrap_or(0.0),
        there.estimate_rms.unwrap_or(0.0)
    );
    say!("Final positions are {apart:.3} m apart (limit {}).", options.within);
    if let Progress::Failed(why) = &there.progress {
        return Err(Failure::Run(format!("on the emulated board: {why}")));
    }
    if apart > options.within {
        return Err(Failure::Run(format!("{apart:.3} m apart")));
    }
    Ok(())
}

fn show_progress(progress: &Progress) -> String {
    match progress {
        Progress::Flying => "under way".into(),
        Progress::Done => "done".into(),
        Progress::Failed(_) => "failed".into(),
    }
}
