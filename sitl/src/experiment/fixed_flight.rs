//! The whole firmware in fixed point against the same in single precision: the same flights, the same seeds.

use super::flown::{Figure, why_lost};
use super::{Compare, Overrides, Report};
use crate::campaign::parallel;
use crate::flight::Flight;
use crate::metrics::{Spread, Summary};
use crate::scenario::{Arithmetic, Scenario};
use tautline_firmware::fixed::saturation;

/// Flights of each, and the longest, simulated s.
const SEEDS: u64 = 5;
const LONGEST: f64 = 400.0;
/// Fixed point may be so many times as bad.
const RATIO: f64 = 2.0;

/// A flight and what of it is compared.
struct Row {
    name: &'static str,
    text: &'static str,
    figures: &'static [Figure],
}

const HOLD: [Figure; 2] =
    [("horizontal, m", |s| s.hold_horizontal_rms_m), ("vertical, m", |s| s.hold_vertical_rms_m)];

const ROWS: [Row; 5] = [
    Row {
        name: "hold on the winch",
        text: include_str!("../../scenarios/calm.toml"),
        figures: &HOLD,
    },
    Row {
        name: "hold in gusts of 3 m/s",
        text: include_str!("../../scenarios/gusts-3.toml"),
        figures: &HOLD,
    },
    Row {
        name: "hold on a fixed tether",
        text: include_str!("../../scenarios/fixed.toml"),
        figures: &HOLD,
    },
    Row {
        name: "taut link, elevation and force",
        text: include_str!("../../scenarios/taut.toml"),
        figures: &[
            ("elevation, rad", |s| s.taut.as_ref().map(|taut| taut.elevation_rms_rad)),
            ("force, N", |s| s.taut.as_ref().map(|taut| taut.second_rms)),
        ],
    },
    Row {
        name: "tether angle",
        text: super::angle_flight::BASE,
        figures: &[
            ("tracking, rad", |s| s.angle.as_ref().map(|angle| angle.tracking_rms_rad)),
            ("estimate, rad", |s| s.angle.as_ref().map(|angle| angle.estimate_rms_rad)),
        ],
    },
];

fn fly(settings: &Overrides, row: &Row, scalar: Arithmetic, seed: u64) -> Result<Summary, String> {
    let scenario = Scenario::parse(row.text, row.name).map_err(|e| e.0)?;
    let mut scenario = Scenario { scalar, ..settings.on(scenario)? };
    // Fixed point has no other filter: the same one is compared.
    scenario.params.insert("EST_KIND".into(), 0.0);
    let params = scenario.params().map_err(|e| e.0)?;
    let mut flight = Flight::unrecorded(&scenario, params, seed).map_err(|e| e.0)?;
    flight.fly(LONGEST);
    match why_lost(&flight) {
        Some(why) => Err(format!("{}, {scalar:?}, seed {seed}: {why}", row.name)),
        None => Ok(flight.metrics.summary()),
    }
}

/// Every flight in both.
pub fn run(settings: &Overrides) -> Result<Report, String> {
    let mut report = Report::default();
    let seeds = settings.seeds(SEEDS)?;
    let saturated = saturation::count();
    for row in &ROWS {
        let both = |seed: &u64| {
            Ok((
                fly(settings, row, Arithmetic::F32, *seed)?,
                fly(settings, row, Arithmetic::Q16, *seed)?,
            ))
        };
        let flown: Result<Vec<_>, String> =
            parallel::map(&seeds, parallel::cores(), both, |_| {}).into_iter().collect();
        let flown = flown?;
        for (figure, of) in row.figures {
            let mut spread = [Spread::default(); 2];
            let [single, fixed] = &mut spread;
            for (in_single, in_fixed) in &flown {
                single.add(of(in_single).ok_or(format!("{}: never flown", row.name))?);
                fixed.add(of(in_fixed).ok_or(format!("{}: never flown", row.name))?);
            }
            let [single, fixed] = spread.map(|spread| spread.rms().unwrap_or(f64::NAN));
            let name = row.name;
            report.add(format!("{name}: {figure}, single"), single, Compare::Alone);
            report.add(format!("{name}: {figure}, fixed"), fixed, Compare::AtMost(RATIO * single));
            let (what, _) = figure.rsplit_once(", ").unwrap_or((figure, ""));
            let ratio = format!("{name}: {what}, fixed to single, 1");
            report.add(ratio, fixed / single, Compare::Alone);
        }
    }
    let saturated = f64::from(saturation::count().wrapping_sub(saturated));
    report.add("operations that saturated", saturated, Compare::AtMost(0.0));
    report.notes.push(format!(
        "Root mean square over {} seeds. Fixed point is Q16.16 through the whole firmware: sensing, attitude, \
         4-state filter, high-gain observer (ε of the parameters) with its force law, tether-angle filter and \
         control, rates, mixer.",
        seeds.len()
    ));
    Ok(report)
}
