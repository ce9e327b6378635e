//! `cargo sitl replay`.

use super::Failure;
use crate::replay::{Replayed, Settings, draw_difference, read, replay};
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::path::PathBuf;
use tautline_firmware::param::Params;

/// Options of a replay.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  cargo sitl replay logs/flight-0001.ulg\n  cargo sitl replay logs/flight-0001.ulg --params soft.params --plot difference.svg\n  cargo sitl replay logs/flight-0001.ulg --estimator simple --json\n\nThe recorded inputs stay as they were: another controller asks for other throttles, and nobody flies them.\nCode 1: without other settings, the outputs were not the recorded ones."
)]
pub struct Options {
    /// A log that the simulator wrote
    #[arg(value_name = "LOG.ulg")]
    log: PathBuf,
    /// Run it with the parameters of this file
    #[arg(long, value_name = "FILE")]
    params: Option<PathBuf>,
    /// Run it with this parameter (repeatable)
    #[arg(long, value_name = "NAME=VALUE", value_parser = super::fly::assignment)]
    param: Vec<(String, f32)>,
    /// Run it with this position filter
    #[arg(long, value_name = "NAME")]
    estimator: Option<Estimator>,
    /// Draw what is different
    #[arg(long, value_name = "FILE.svg")]
    plot: Option<PathBuf>,
    /// Print one JSON object instead of the table
    #[arg(long)]
    json: bool,
}

/// Filters that fly.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Estimator {
    /// Altitude, angles, tension: EST_KIND 0
    Simple,
    /// The full state: EST_KIND 1
    FullState,
}

/// The JSON object.
#[derive(Serialize)]
struct Told<'a> {
    #[serde(flatten)]
    replayed: &'a Replayed,
    /// Where the recorded inputs end early; what follows was not replayed.
    gap: Option<&'a str>,
}

/// Runs the recorded inputs again.
pub fn run(options: &Options) -> Result<(), Failure> {
    let name = options.log.display();
    let named = |e: String| Failure::Usage(format!("{name}: {e}"));
    let bytes = std::fs::read(&options.log).map_err(|e| named(e.to_string()))?;
    let (items, gap) = read(&bytes).map_err(named)?;
    if let Some(gap) = &gap {
        eprintln!("warning: {name}: {gap}");
    }
    let settings = settings(options)?;
    let replayed = replay(&items, &settings).map_err(named)?;
    if let Some(path) = &options.plot {
        draw_difference(&replayed, path)
            .map_err(|e| Failure::Run(format!("{}: {e}", path.display())))?;
    }
    if options.json {
        let told = Told { replayed: &replayed, gap: gap.as_deref() };
        say!("{}", serde_json::to_string(&told).map_err(|e| Failure::Run(e.to_string()))?);
    } else {
        print(&replayed, &settings);
    }
    if settings.is_empty() && !replayed.identical {
        return Err(Failure::Run("the outputs are not the recorded ones".into()));
    }
    Ok(())
}

fn settings(options: &Options) -> Result<Settings, Failure> {
    let mut settings = Settings::default();
    if let Some(path) = &options.params {
        // What a file from elsewhere has too much is told once, here.
        super::load_params(&mut Params::default(), path)?;
        let name = path.display().to_string();
        let bytes = std::fs::read(path).map_err(|e| Failure::Usage(format!("{name}: {e}")))?;
        settings.file = Some((name, bytes));
    }
    if let Some(estimator) = options.estimator {
        let kind = match estimator {
            Estimator::Simple => 0.0,
            Estimator::FullState => 1.0,
        };
        settings.params.push(("EST_KIND".into(), kind));
    }
    settings.params.extend(options.param.iter().cloned());
    Ok(settings)
}

fn print(replayed: &Replayed, settings: &Settings) {
    say!("{} steps replayed.", replayed.steps);
    match replayed.first_difference_s {
        None => say!("Every output is the recorded one, to the bit."),
        Some(time) => say!("The outputs are other ones from {time:.3} s after power-up on."),
    }
    if settings.is_empty() {
        let built = env!("TAUTLINE_REVISION");
        if !replayed.identical && replayed.recorded_by != built {
            say!("Recorded by {}, replayed by {built}.", replayed.recorded_by);
        }
        return;
    }
    let d = &replayed.difference;
    let cell =
        |x: Option<f64>, unit: &str| x.map_or_else(|| "-".to_owned(), |x| format!("{x:.4} {unit}"));
    say!("Against the recorded flight, over the same inputs:");
    say!("  position  {} RMS, {:.3} m at most", cell(d.position_rms_m, "m"), d.position_max_m);
    say!("  attitude  {} RMS", cell(d.attitude_rms_rad.map(f64::to_degrees), "deg"));
    say!("  tension   {} RMS", cell(d.tension_rms_n, "N"));
    say!("  throttle  {} RMS", cell(d.throttle_rms, ""));
    say!("  in another mode for {:.1} s", d.other_mode_steps as f64 * 1e-3);
}
