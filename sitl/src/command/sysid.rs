//! `cargo sitl sysid`.

use super::Failure;
use crate::scenario::{params_file, set_param};
use crate::sysid::{
    AHEAD, Identified, Prepared, PwmRange, RATE, Record, ThrustFit, draw_predictions, fit_stand,
    fit_thrust_map, from_log, identify, is_stand, prepare, read_csv, read_stand, recommend,
};
use clap::Args;
use serde_json::{Map, Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use tautline_firmware::param::Params;

/// Options of an identification.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  cargo sitl sysid flight.csv\n  cargo sitl sysid logs/flight-0001.ulg --out thrust.params --plot out\n  cargo sitl sysid flight.csv --pwm-range 1000,2000 --json\n\nThe table has columns t_s, four that begin with pwm_, thrust_N and perhaps voltage_V. Record it in\nfree flight: there the thrust is minus mass times the specific force along the body's down axis, and\nthat is what is taken from a log (its untethered part in Altitude or Stabilize). A thrust stand's table is\nread too: one rotor, a column of thrust with its unit in parentheses and one of the ESC's signal."
)]
pub struct Options {
    /// A table, or a log of an untethered flight
    #[arg(value_name = "FILE.csv|LOG.ulg")]
    file: PathBuf,
    /// Print one JSON object instead of the table
    #[arg(long)]
    json: bool,
    /// Write the thrust map's parameters there, for --params
    #[arg(long, value_name = "FILE.params")]
    out: Option<PathBuf>,
    /// Write the picture there
    #[arg(long, value_name = "DIR")]
    plot: Option<PathBuf>,
    /// PWM at throttle 0 and 1; guessed by the largest value if absent
    #[arg(long, value_name = "LOW,HIGH", allow_hyphen_values = true)]
    pwm_range: Option<String>,
    /// Parameters that the vehicle flew with; a log brings its own
    #[arg(long, value_name = "FILE.params")]
    params: Option<PathBuf>,
}

fn pwm_range(options: &Options, guess: PwmRange) -> Result<PwmRange, String> {
    let Some(text) = &options.pwm_range else { return Ok(guess) };
    let pair = text
        .split_once(',')
        .and_then(|(low, high)| Some((low.trim().parse().ok()?, high.trim().parse().ok()?)));
    let (low, high) = pair.ok_or_else(|| format!("--pwm-range {text}: not LOW,HIGH"))?;
    Ok(PwmRange { low, high })
}

/// Identifies and prints the result.
pub fn run(options: &Options) -> Result<(), Failure> {
    if is_a_stand(&options.file).map_err(Failure::Usage)? {
        return run_stand(options);
    }
    let mut before = Params::default();
    let is_log = options.file.extension().is_some_and(|e| e == "ulg");
    let record =
        if is_log { from_log(&options.file, &mut before) } else { read_csv(&options.file) };
    let record = record.map_err(Failure::Usage)?;
    if let Some(path) = &options.params {
        super::load_params(&mut before, path)?;
    }
    let range = pwm_range(options, PwmRange::guess(&record)).map_err(Failure::Usage)?;
    let named = |e: String| Failure::Usage(format!("{}: {e}", options.file.display()));
    let data = prepare(&record).map_err(named)?;
    let found = identify(&data);
    let best = recommend(&found);
    let map = fit_thrust_map(&record, range, &before);
    if options.json {
        say!("{}", to_json(&found, best, &map, data.filtered.len()));
    } else {
        print(&record, &data, &found, best, &map, range);
    }
    let write =
        |path: &Path, e: &dyn std::fmt::Display| Failure::Run(format!("{}: {e}", path.display()));
    // The table stands without the map; a map that was requested, or whose range was named, may not fail silently.
    let is_requested = options.out.is_some() || options.pwm_range.is_some();
    let map = match map {
        Err(e) if is_requested => return Err(named(e)),
        map => map.ok(),
    };
    if let (Some(path), Some(map)) = (&options.out, &map) {
        write_parameters(options, path, before, map)?;
    }
    if let Some(folder) = &options.plot {
        fs::create_dir_all(folder).map_err(|e| write(folder, &e))?;
        let path = folder.join("sysid.svg");
        draw_predictions(&data, &found, &path).map_err(|e| write(&path, &e))?;
        if !options.json {
            say!("Picture: {}", path.display());
        }
    }
    Ok(())
}

fn is_a_stand(file: &Path) -> Result<bool, String> {
    let is_log = file.extension().is_some_and(|e| e == "ulg");
    if is_log { Ok(false) } else { is_stand(file) }
}

/// The curve alone: a stand tells no more.
fn run_stand(options: &Options) -> Result<(), Failure> {
    let named = |e: String| Failure::Usage(format!("{}: {e}", options.file.display()));
    let stand = read_stand(&options.file).map_err(Failure::Usage)?;
    let mut before = Params::default();
    if let Some(path) = &options.params {
        super::load_params(&mut before, path)?;
    }
    let range = pwm_range(options, stand.range()).map_err(Failure::Usage)?;
    if options.plot.is_some() {
        return Err(named("a stand's table has no predictions to draw".into()));
    }
    let map = fit_stand(&stand, range, &before).map_err(named)?;
    if options.json {
        let rows = stand.thrust.len();
        say!("{}", to_json(&[], None, &Ok(map), rows));
    } else {
        let PwmRange { low, high } = range;
        say!("A thrust stand's {} rows of one rotor (PWM {low} to {high}):", stand.thrust.len());
        print_map(&map);
    }
    options.out.as_ref().map_or(Ok(()), |path| write_parameters(options, path, before, &map))
}

/// What the vehicle would refuse is not written.
fn write_parameters(
    options: &Options,
    path: &Path,
    before: Params,
    map: &ThrustFit,
) -> Result<(), Failure> {
    let failed = |e: &dyn std::fmt::Display| Failure::Run(format!("{}: {e}", path.display()));
    let mut trial = before;
    for (name, value) in map.parameters() {
        set_param(&mut trial, name, value as f32).map_err(|e| failed(&e))?;
    }
    fs::write(path, params_file::some_to_text(&map.parameters())).map_err(|e| failed(&e))?;
    if !options.json {
        say!("Parameters: {}", path.display());
    }
    Ok(())
}

fn print(
    record: &Record,
    data: &Prepared,
    found: &[Result<Identified, String>],
    best: Option<&Identified>,
    map: &Result<ThrustFit, String>,
    range: PwmRange,
) {
    say!(
        "{} rows over {:.1} s, resampled to {} at {RATE} Hz; estimated on the first half",
        record.time.len(),
        record.duration(),
        data.filtered.len()
    );
    let ahead = format!("Fit {AHEAD} ahead, %");
    say!(
        "{:<20} {ahead:>15} {:>10} {:>10} {:>6}  stable",
        "structure",
        "FPE, N²",
        "MSE, N²",
        "pole"
    );
    for result in found {
        match result {
            Ok(m) => {
                let stable = if m.is_stable { "yes" } else { "NO" };
                say!(
                    "{:<20} {:>15.1} {:>10.2e} {:>10.2e} {:>6.3}  {stable}",
                    m.name,
                    m.fit,
                    m.fpe,
                    m.mse,
                    m.largest_pole
                );
            }
            Err(e) => say!("{e}"),
        }
    }
    match best {
        Some(best) => say!("Recommended for prediction: {}", best.name),
        None => say!("No stable model"),
    }
    say!(
        "A good prediction is mostly the smoothness of the filtered thrust; the static gain is what \
         localisation needs. Thrust map (PWM {} to {}):",
        range.low,
        range.high
    );
    match map {
        Ok(map) => print_map(map),
        Err(e) => say!("  none: {e}"),
    }
}

fn print_map(map: &ThrustFit) {
    for (name, value) in map.parameters() {
        say!("  {name:<12} {value:.4}");
    }
    if map.factor_is_known {
        say!("  curve known to ±{:.3}; residual {:.3} N rms", map.factor_sd, map.residual);
    } else {
        say!(
            "  the record does not tell the curve (±{:.2}): THR_MDL_FAC is left as it was; residual {:.3} N rms",
            map.factor_sd,
            map.residual
        );
    }
    if map.lag.is_none() {
        say!("  the record does not tell the motors' lag: MOT_TAU is left as it was");
    }
    if !map.has_voltage {
        say!("  no voltage: the maximum holds at the record's mean voltage");
    }
    for warning in map.warnings() {
        eprintln!("warning: {warning}");
    }
}

fn to_json(
    found: &[Result<Identified, String>],
    best: Option<&Identified>,
    map: &Result<ThrustFit, String>,
    samples: usize,
) -> Value {
    let models: Vec<Value> = found
        .iter()
        .map(|result| match result {
            Ok(m) => json!({
                "structure": m.name,
                "fit_percent": m.fit,
                "fpe_n2": m.fpe,
                "mse_n2": m.mse,
                "parameters": m.dimension,
                "largest_pole": m.largest_pole,
                "stable": m.is_stable,
            }),
            Err(e) => json!({ "error": e }),
        })
        .collect();
    json!({
        "samples": samples,
        "models": models,
        "recommended": best.map(|m| m.name),
        "thrust_map": match map {
            Ok(map) => map_to_json(map),
            Err(e) => json!({ "error": e }),
        },
    })
}

fn map_to_json(map: &ThrustFit) -> Value {
    let parameters: Map<String, Value> =
        map.parameters().iter().map(|(name, value)| ((*name).to_owned(), json!(value))).collect();
    json!({
        "parameters": parameters,
        "curve_known": map.factor_is_known,
        "curve_sd": map.factor_sd,
        "residual_n": map.residual,
        "thrust_error_before": map.error_before,
        "has_voltage": map.has_voltage,
        "lag_known": map.lag.is_some(),
        "warnings": map.warnings(),
    })
}
