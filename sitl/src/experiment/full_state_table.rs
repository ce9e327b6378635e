//! The full-state filter from the ground to the ground, beside the specification's figures and limits: holds, moves,
//! other lines, landings in a storm.

use super::flown::{Flown, fly_all};
use super::full_state_picture::FullStatePicture;
use super::{Compare, Overrides, Report};
use crate::metrics::Spread;
use crate::scenario::Scenario;

/// Flights of each, and the longest, simulated s.
const SEEDS: u64 = 20;
const LONGEST: f64 = 900.0;

/// What is flown between take-off and landing.
#[derive(Clone, Copy)]
enum Between {
    Hold,
    /// Up, round and back.
    Moves,
    Nothing,
}

/// Flights that differ by the wind alone.
struct Group {
    name: &'static str,
    /// Of the tether: `fixed` or `winch`.
    kind: &'static str,
    /// m.
    length: f64,
    between: Between,
    /// Mean wind, m/s, with gusts, and the specification's limit for the error of the place, m.
    cells: &'static [(f64, Option<f64>)],
    /// Largest level error² over σ², up to 5 m/s.
    ratio: Option<f64>,
    /// Largest sideways speed at contact, m/s.
    drift: Option<f64>,
}

const GROUPS: [Group; 6] = [
    Group {
        name: "fixed 10 m, hold",
        kind: "fixed",
        length: 10.0,
        between: Between::Hold,
        cells: &[(0.0, Some(0.14)), (3.0, Some(0.20)), (5.0, Some(0.26)), (8.0, Some(0.38))],
        ratio: Some(1.3),
        drift: None,
    },
    Group {
        name: "fixed 10 m, moves",
        kind: "fixed",
        length: 10.0,
        between: Between::Moves,
        cells: &[(0.0, Some(0.14)), (3.0, Some(0.19)), (5.0, Some(0.25)), (8.0, Some(0.35))],
        ratio: Some(1.3),
        drift: None,
    },
    Group {
        name: "winch 10 m, hold",
        kind: "winch",
        length: 10.0,
        between: Between::Hold,
        cells: &[(0.0, Some(0.17)), (3.0, Some(0.23)), (5.0, None), (8.0, Some(0.57))],
        ratio: Some(1.3),
        drift: None,
    },
    Group {
        name: "winch 10 m, moves",
        kind: "winch",
        length: 10.0,
        between: Between::Moves,
        cells: &[(0.0, None), (3.0, None), (5.0, None), (8.0, None)],
        ratio: Some(1.3),
        drift: None,
    },
    Group {
        name: "fixed 20 m, hold",
        kind: "fixed",
        length: 20.0,
        between: Between::Hold,
        cells: &[(0.0, Some(0.24)), (3.0, Some(0.33)), (8.0, Some(0.60))],
        ratio: Some(1.3),
        drift: None,
    },
    Group {
        name: "winch 10 m, landing",
        kind: "winch",
        length: 10.0,
        between: Between::Nothing,
        cells: &[(7.0, None), (8.0, None), (10.0, None)],
        ratio: None,
        drift: Some(1.0),
    },
];

const MOVES: &str = r#"
[[mission]]
do = "hold"
seconds = 8
[[mission]]
do = "move"
elevation = 1.22
[[mission]]
do = "hold"
seconds = 3
[[mission]]
do = "move"
azimuth = 0.52
[[mission]]
do = "hold"
seconds = 3
[[mission]]
do = "move"
elevation = 0.785
[[mission]]
do = "hold"
seconds = 3
[[mission]]
do = "move"
azimuth = 0.0
"#;

impl Group {
    fn scenario(&self, wind: f64) -> Result<Scenario, String> {
        let Self { kind, length, .. } = self;
        let between = match self.between {
            Between::Hold => "[[mission]]\ndo = \"hold\"\nseconds = 40",
            Between::Moves => MOVES,
            Between::Nothing => "[[mission]]\ndo = \"hold\"\nseconds = 5",
        };
        let text = format!(
            r#"
            [tether]
            kind = "{kind}"
            length = {length}
            [wind]
            speed = {wind}
            gusts = true
            [[mission]]
            do = "arm"
            [[mission]]
            do = "takeoff"
            altitude = {altitude}
            {between}
            [[mission]]
            do = "land"
            "#,
            altitude = 0.707 * length,
        );
        Scenario::parse(&text, self.name).map_err(|e| e.0)
    }
}

/// All groups.
pub fn run(settings: &Overrides) -> Result<Report, String> {
    let mut report = Report::default();
    let seeds = settings.seeds(SEEDS)?;
    for group in &GROUPS {
        for &(wind, limit) in group.cells {
            let scenario = settings.on(group.scenario(wind)?)?;
            let flown = fly_all(&scenario, &seeds, LONGEST)?;
            add(&mut report, group, (wind, limit), &seeds, &flown);
        }
    }
    let picture = FullStatePicture::fly(settings.seed)?;
    report.picture("full-state.svg", move |path| picture.draw(path));
    report.notes.push(format!(
        "Root mean square over {} seeds, Tether Hold, moves included: the estimate's error in three coordinates, and \
         the truth's distance from its set-point. Limits: `fullstate` section 26.",
        seeds.len()
    ));
    Ok(report)
}

fn add(
    report: &mut Report,
    group: &Group,
    (wind, limit): (f64, Option<f64>),
    seeds: &[u64],
    flown: &[Flown],
) {
    let name = format!("{}, {wind} m/s", group.name);
    let mut lost = 0;
    for (seed, (_, why)) in seeds.iter().zip(flown) {
        if let Some(why) = why {
            lost += 1;
            report.notes.push(format!("{name}, seed {seed}: {why}"));
        }
    }
    report.add(format!("{name}: lost"), f64::from(lost), Compare::AtMost(0.0));
    let places = || flown.iter().filter_map(|(summary, _)| summary.place);
    let rms = |of: fn(&crate::metrics::PlaceSummary) -> f64| {
        let mut spread = Spread::default();
        places().for_each(|place| spread.add(of(&place)));
        spread.rms().unwrap_or(f64::NAN)
    };
    let at_most = |limit: Option<f64>| limit.map_or(Compare::Alone, Compare::AtMost);
    report.add(format!("{name}: estimate, m"), rms(|p| p.estimate_rms_m), at_most(limit));
    report.add(format!("{name}: place kept, m"), rms(|p| p.tracking_rms_m), Compare::Alone);
    report.add(format!("{name}: tension, N"), rms(|p| p.tension_rms_n), Compare::Alone);
    report.add(format!("{name}: heading, rad"), rms(|p| p.yaw_rms_rad), Compare::Alone);
    let ratio = rms(|p| p.error_over_variance.sqrt()).powi(2);
    let most = group.ratio.map(|most| if wind > 5.0 { 2.0 } else { most });
    report.add(format!("{name}: level error²/σ²"), ratio, at_most(most));
    let kept = places().map(|p| p.kept[0]).sum::<f64>() / places().count() as f64;
    // Ours to keep: what `eph` says, twice, in 95 % of the time; the gusts of 8 m/s and more are beyond the filter's model.
    let holds = kept >= 0.95 || wind > 5.0;
    let claim = "95 % of the time up to 5 m/s";
    report.add(format!("{name}: level error within 2σ"), kept, Compare::Claim(claim, holds));
    let restarts: f64 = places().map(|p| f64::from(p.restarts)).sum();
    report.add(format!("{name}: restarts, all flights"), restarts, Compare::Alone);
    if let Some(most) = group.drift {
        let drift = flown.iter().filter_map(|(summary, _)| summary.touch_down_drift_mps);
        let worst = drift.fold(0.0, f64::max);
        report.add(format!("{name}: largest drift at contact, m/s"), worst, Compare::AtMost(most));
    }
}
