//! `cargo sitl campaign`.

use super::Failure;
use crate::campaign::{self, Campaign, Outcome};
use clap::Args;
use std::fs;
use std::path::PathBuf;

/// Options of a campaign.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  cargo sitl campaign sitl/campaigns/gusts-3.toml --jobs 2 --keep --out out"
)]
pub struct Options {
    /// Scenario, seeds, limits
    #[arg(value_name = "FILE.toml")]
    file: PathBuf,
    /// Flights at the same time
    #[arg(long, value_name = "N", default_value_t = 2)]
    jobs: usize,
    /// Only the I-th of N parts
    #[arg(long, value_name = "I/N", default_value = "1/1", value_parser = shard)]
    shard: (u64, u64),
    /// Only the first so many seeds
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    seeds: Option<u64>,
    /// Fly those that fail once more, with a log beside the table
    #[arg(long)]
    keep: bool,
    /// Where the table goes
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

fn shard(text: &str) -> Result<(u64, u64), String> {
    let parts = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
    match parts {
        Some((i, n)) if i >= 1 && i <= n => Ok((i, n)),
        _ => Err("expected I/N with 1 <= I <= N".into()),
    }
}

fn cell(value: Option<f64>) -> String {
    value.map_or_else(|| "-".into(), |v| format!("{v:.3}"))
}

fn row(o: &Outcome) -> String {
    let s = &o.summary;
    format!(
        "{:>6} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}  {}",
        o.seed,
        cell(s.hold_horizontal_rms_m),
        format!("{:.3}", s.hold_horizontal_max_m),
        cell(s.hold_vertical_rms_m),
        cell(s.estimate_horizontal_rms_m),
        cell(s.attitude_rms_rad.map(f64::to_degrees)),
        cell(s.touch_down_mps),
        if o.pass { "ok" } else { &o.reason },
    )
}

/// Flies them all.
pub fn run(options: &Options) -> Result<(), Failure> {
    let (mut campaign, scenario) = Campaign::load(&options.file).map_err(Failure::Usage)?;
    campaign.seeds = options.seeds.unwrap_or(campaign.seeds).min(campaign.seeds);
    let out = &options.out;
    fs::create_dir_all(out).map_err(|e| Failure::Usage(format!("{}: {e}", out.display())))?;
    let (index, count) = options.shard;
    let seeds = campaign.shard(index, count);
    say!("{}: {} flights", campaign.title, seeds.len());
    say!(
        "{:>6} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}",
        "seed",
        "horiz rms",
        "horiz max",
        "vert rms",
        "est rms",
        "att deg",
        "touch m/s"
    );
    let outcomes =
        campaign.run(&scenario, &seeds, options.jobs, |outcome| say!("{}", row(outcome)));

    let mean = |pick: fn(&Outcome) -> Option<f64>| {
        let values: Vec<_> = outcomes.iter().filter_map(pick).collect();
        let worst = values.iter().copied().fold(0.0, f64::max);
        (values.iter().sum::<f64>() / values.len().max(1) as f64, worst)
    };
    let lost = outcomes.iter().filter(|o| !o.complete).count();
    let failed = outcomes.iter().filter(|o| !o.pass).count();
    let show = |name: &str, (mean, worst): (f64, f64), limit: Option<f64>| {
        let limit = limit.map_or_else(|| "no limit".into(), |l| format!("limit {l}"));
        say!("{name}: mean {mean:.3}, worst {worst:.3}, {limit}");
    };
    let l = &campaign.limits;
    show(
        "hold horizontal rms, m",
        mean(|o| o.summary.hold_horizontal_rms_m),
        l.hold_horizontal_rms_m,
    );
    show("hold vertical rms, m", mean(|o| o.summary.hold_vertical_rms_m), l.hold_vertical_rms_m);
    show("touch-down, m/s", mean(|o| o.summary.touch_down_mps), l.touch_down_mps);
    say!(
        "incomplete or lost: {lost} of {}; over a limit: {}",
        outcomes.len(),
        failed - lost.min(failed)
    );

    let file = out.join(format!("campaign-{index}-of-{count}.json"));
    let json = serde_json::to_string_pretty(&outcomes).map_err(|e| Failure::Run(e.to_string()))?;
    fs::write(&file, json).map_err(|e| Failure::Run(format!("{}: {e}", file.display())))?;
    say!("Table: {}", file.display());
    if options.keep {
        for outcome in outcomes.iter().filter(|outcome| !outcome.pass) {
            let log = out.join(format!("seed-{}.ulg", outcome.seed));
            campaign::log(&scenario, outcome.seed, &log).map_err(Failure::Run)?;
            say!("Log: {}", log.display());
        }
    }
    if failed > 0 {
        Err(Failure::Run(format!("{failed} of {} flights failed", outcomes.len())))
    } else {
        Ok(())
    }
}
