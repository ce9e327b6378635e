//! Runs over disturbances and seeds, and figures of them.

use crate::bench::pendulum::{PendulumScenario, PendulumSummary, PendulumTrace};
use crate::campaign::parallel;
use crate::experiment::{Compare, Overrides, Report};
use crate::scenario::DisturbanceKind;

/// The article's three, with their names.
pub const DISTURBANCES: [(&str, DisturbanceKind); 3] = [
    ("no disturbance", DisturbanceKind::None),
    ("constant", DisturbanceKind::Constant),
    ("stochastic", DisturbanceKind::Stochastic),
];

/// Whether another seed would be another run.
fn is_random(s: &PendulumScenario) -> bool {
    s.disturbance == DisturbanceKind::Stochastic
        || s.rod_noise + s.velocity_noise + s.position_noise > 0.0
}

/// One run for each seed; a single one where nothing is random.
pub fn traces(
    settings: &Overrides,
    s: PendulumScenario,
    seeds: u64,
) -> Result<Vec<PendulumTrace>, String> {
    let s = settings.on(s)?;
    let mut seeds = settings.seeds(seeds)?;
    if !is_random(&s) {
        seeds.truncate(1);
    }
    let work = |seed: &u64| s.fly(*seed);
    parallel::map(&seeds, parallel::cores(), work, |_| {}).into_iter().collect()
}

/// As [`traces`], figures only.
pub fn summaries(
    settings: &Overrides,
    s: PendulumScenario,
    seeds: u64,
) -> Result<Vec<PendulumSummary>, String> {
    Ok(traces(settings, s, seeds)?.into_iter().map(|trace| trace.summary).collect())
}

/// Mean of a figure; infinite if any run was lost.
pub fn mean(runs: &[PendulumSummary], pick: fn(&PendulumSummary) -> f64) -> f64 {
    if runs.iter().any(PendulumSummary::is_lost) {
        return f64::INFINITY;
    }
    runs.iter().map(pick).sum::<f64>() / runs.len() as f64
}

/// Largest of a figure over all runs, lost ones too.
pub fn worst(runs: &[PendulumSummary], pick: fn(&PendulumSummary) -> f64) -> f64 {
    runs.iter().map(pick).fold(0.0, f64::max)
}

/// Mean error in cm against something.
pub fn add_error(report: &mut Report, name: &str, runs: &[PendulumSummary], compare: Compare) {
    report.add(format!("{name}: mean error, cm"), 100.0 * mean(runs, |s| s.error_mean), compare);
}
