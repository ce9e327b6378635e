//! Many planar runs at once.

use super::Overrides;
use crate::bench::planar::{PlanarScenario, PlanarSummary, Trace, fly};
use crate::campaign::parallel;

/// Flies all, with the user's settings on top.
pub fn traces(settings: &Overrides, scenarios: Vec<PlanarScenario>) -> Result<Vec<Trace>, String> {
    let scenarios =
        scenarios.into_iter().map(|s| settings.planar(s)).collect::<Result<Vec<_>, _>>()?;
    parallel::map(&scenarios, parallel::cores(), |s| fly(s, settings.seed), |_| {})
        .into_iter()
        .collect()
}

/// As [`traces`], figures only.
pub fn summaries(
    settings: &Overrides,
    scenarios: Vec<PlanarScenario>,
) -> Result<Vec<PlanarSummary>, String> {
    let scenarios =
        scenarios.into_iter().map(|s| settings.planar(s)).collect::<Result<Vec<_>, _>>()?;
    let fly_one = |s: &PlanarScenario| fly(s, settings.seed).map(|trace| trace.summary);
    parallel::map(&scenarios, parallel::cores(), fly_one, |_| {}).into_iter().collect()
}

/// The largest deviation, stepping outwards from zero, before the first that is lost.
pub fn limit(
    settings: &Overrides,
    step: f64,
    end: f64,
    scenario: impl Fn(f64) -> PlanarScenario,
) -> Result<f64, String> {
    let count = (end / step).abs().round() as u32;
    let mut reached = 0.0;
    for k in 1..=count {
        let deviation = f64::from(k) * step;
        let s = settings.planar(scenario(deviation))?;
        if fly(&s, settings.seed)?.summary.is_lost() {
            break;
        }
        reached = deviation;
    }
    Ok(reached)
}
