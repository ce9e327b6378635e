//! What breaks in a hold in 3 m/s, and what the full-state filter makes of it (`fullstate` section 24): lost, and the
//! error once it is over.

use super::flown::why_lost;
use super::{Compare, Overrides, Report};
use crate::campaign::parallel;
use crate::flight::Flight;
use crate::metrics::{Interval, Spread};
use crate::scenario::{FaultKind, FaultSection, Scenario};

/// Flights of each.
const SEEDS: u64 = 20;
/// The fault comes at, s, and the error counts from and until.
const AT: f64 = 50.0;
const FROM: f64 = 72.0;
const UNTIL: f64 = 82.0;
/// Until the vehicle stands again, s.
const LONGEST: f64 = 300.0;

struct Case {
    name: &'static str,
    kind: &'static str,
    /// What, how much, and how long, s.
    fault: Option<(FaultKind, f64, f64)>,
    params: &'static str,
    /// m: `fullstate` section 24, and its own figure.
    limit: Option<f64>,
    /// Nothing tells it from a gust yet: said in docs/estimation.md.
    is_open: bool,
}

const fn case(
    name: &'static str,
    kind: &'static str,
    fault: (FaultKind, f64, f64),
    limit: f64,
) -> Case {
    Case { name, kind, fault: Some(fault), params: "", limit: Some(limit), is_open: false }
}

const CASES: [Case; 14] = [
    Case {
        name: "nothing",
        kind: "fixed",
        fault: None,
        params: "",
        limit: Some(0.22),
        is_open: false,
    },
    case("push 3 N for 0.5 s", "fixed", (FaultKind::PushEast, 3.0, 0.5), 0.22),
    case("push 6 N for 0.5 s", "fixed", (FaultKind::PushEast, 6.0, 0.5), 0.22),
    case("push 10 N for 0.5 s", "fixed", (FaultKind::PushEast, 10.0, 0.5), 0.22),
    case("push 6 N inwards for 0.5 s", "fixed", (FaultKind::PushNorth, -6.0, 0.5), 0.22),
    case("thrust 85 %", "fixed", (FaultKind::MotorThrust, 0.85, 600.0), 0.22),
    case("rangefinder +2 m for 3 s", "fixed", (FaultKind::RangeOffset, 2.0, 3.0), 0.35),
    Case {
        limit: None,
        is_open: true,
        ..case("gyro +10°/s for 1 s", "fixed", (FaultKind::GyroBias, 0.1745, 1.0), 0.0)
    },
    case("winch: push 6 N for 0.5 s", "winch", (FaultKind::PushEast, 6.0, 0.5), 0.25),
    case("winch: length +1 m for 3 s", "winch", (FaultKind::EncoderOffset, 1.0, 3.0), 0.35),
    case("winch: rangefinder +2 m for 3 s", "winch", (FaultKind::RangeOffset, 2.0, 3.0), 0.35),
    case("winch: thrust 85 %", "winch", (FaultKind::MotorThrust, 0.85, 600.0), 0.25),
    Case {
        limit: None,
        is_open: true,
        ..case("winch: gyro +10°/s for 1 s", "winch", (FaultKind::GyroBias, 0.1745, 1.0), 0.0)
    },
    Case {
        name: "winch: starts 1 m and 3° off",
        kind: "winch",
        fault: None,
        params: "TET_START_DIST = 1.8\nTET_HDG0 = 0.0524",
        limit: None,
        is_open: false,
    },
];

/// How a flight went: the error at the end, the farthest from the reference, and why it was lost.
struct Outcome {
    error: Option<f64>,
    farthest: f64,
    lost: Option<String>,
    told: usize,
}

/// All of it.
pub fn run(settings: &Overrides) -> Result<Report, String> {
    let mut report = Report::default();
    let seeds = settings.seeds(SEEDS)?;
    for case in &CASES {
        let scenario = settings.on(scenario(case)?)?;
        let fly = |seed: &u64| fly(&scenario, *seed);
        let outcomes: Vec<Outcome> = parallel::map(&seeds, parallel::cores(), fly, |_| {})
            .into_iter()
            .collect::<Result<_, String>>()?;
        add(&mut report, case, &seeds, &outcomes);
    }
    report.notes.push("Estimate's error from 22 to 32 s after the fault began; limits: `fullstate` section 24 and half as much again.".into());
    Ok(report)
}

fn add(report: &mut Report, case: &Case, seeds: &[u64], outcomes: &[Outcome]) {
    let name = case.name;
    for (seed, outcome) in seeds.iter().zip(outcomes) {
        if let Some(why) = &outcome.lost {
            report.notes.push(format!("{name}, seed {seed}: {why}"));
        }
    }
    let lost = outcomes.iter().filter(|o| o.lost.is_some()).count();
    let most = Interval::of_share(lost, outcomes.len()).most;
    let none = if case.is_open { Compare::Alone } else { Compare::AtMost(0.0) };
    report.add(format!("{name}: lost"), lost as f64, none);
    report.add(format!("{name}: lost, 95 % bound of the share"), most, Compare::Alone);
    let errors: Vec<f64> = outcomes.iter().filter_map(|o| o.error).collect();
    let compare = case.limit.map_or(Compare::Alone, Compare::AtMost);
    let error = Interval::of_rms(&errors).map_or(f64::NAN, |interval| interval.middle);
    report.add(format!("{name}: estimate afterwards, m"), error, compare);
    let farthest = outcomes.iter().map(|o| o.farthest).fold(0.0, f64::max);
    report.add(format!("{name}: farthest from the reference, m"), farthest, Compare::Alone);
    let told = outcomes.iter().filter(|o| o.told > 0).count();
    report.add(format!("{name}: flights in which something was told"), told as f64, Compare::Alone);
}

fn scenario(case: &Case) -> Result<Scenario, String> {
    let Case { kind, params, .. } = case;
    // Of the vehicle as it stands: what is told to the firmware is another matter.
    let text = format!(
        r#"
        [tether]
        kind = "{kind}"
        [wind]
        speed = 3
        gusts = true
        [params]
        {params}
        [[mission]]
        do = "arm"
        [[mission]]
        do = "takeoff"
        altitude = 7.07
        [[mission]]
        do = "hold"
        seconds = 60
        [[mission]]
        do = "land"
        "#
    );
    let mut scenario = Scenario::parse(&text, case.name).map_err(|e| e.0)?;
    if let Some((kind, value, duration)) = case.fault {
        scenario
            .fault
            .push(FaultSection { duration: Some(duration), ..FaultSection::new(kind, value, AT) });
    }
    Ok(scenario)
}

fn fly(scenario: &Scenario, seed: u64) -> Result<Outcome, String> {
    let params = scenario.params().map_err(|e| e.0)?;
    let mut flight = Flight::unrecorded(scenario, params, seed).map_err(|e| e.0)?;
    let (mut error, mut farthest) = (Spread::default(), 0.0_f64);
    while !flight.is_over() && flight.world.time() < LONGEST {
        flight.step(&mut |_| {});
        let time = flight.world.time();
        let (out, plant) = (flight.output(), &flight.world.environment.plant);
        let truth = plant.from_anchor();
        if let Some(reference) = out.reference.as_ref().filter(|_| (AT..UNTIL).contains(&time)) {
            farthest = farthest.max((truth - reference.position.0.map(f64::from)).norm());
        }
        if let Some(position) = out.estimate.position.filter(|_| (FROM..UNTIL).contains(&time)) {
            error.add((position.0.map(f64::from) - truth).norm());
        }
    }
    let told = flight.events.iter().filter(|(at, _)| (AT..UNTIL).contains(at)).count();
    Ok(Outcome { error: error.rms(), farthest, lost: why_lost(&flight), told })
}
