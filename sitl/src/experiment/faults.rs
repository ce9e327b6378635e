//! What breaks, when it breaks, and how the vehicle comes down: fault by phase.

use super::{Compare, Overrides, Report};
use crate::campaign::parallel;
use crate::flight::Flight;
use crate::metrics::{Interval, Verdict};
use crate::scenario::{Axis, FaultKind, FaultSection, Scenario};
use std::fmt::Write;

/// Flights of each fault in each phase.
const SEEDS: u64 = 4;
/// Until the vehicle stands again, s.
const LONGEST: f64 = 300.0;

/// When it begins: a step of the mission, from 1, and s after it.
const PHASES: [(&str, usize, f64); 5] = [
    ("take-off", 2, 0.6),
    ("climb", 2, 12.0),
    ("hold", 3, 8.0),
    ("move", 4, 4.0),
    ("land", 6, 12.0),
];

/// Why a row may be beyond the limits.
enum Excuse {
    None,
    /// Physics does not allow better.
    Physics(&'static str),
    /// Not mended yet.
    Open(&'static str),
}

struct Case {
    name: &'static str,
    kind: FaultKind,
    value: f64,
    duration: Option<f64>,
    ramp: f64,
    axis: Option<Axis>,
    rotor: Option<usize>,
    /// Sections of the scenario that make another vehicle.
    vehicle: &'static str,
    excuse: Excuse,
}

const fn case(name: &'static str, kind: FaultKind, value: f64) -> Case {
    Case {
        name,
        kind,
        value,
        duration: None,
        ramp: 0.0,
        axis: None,
        rotor: None,
        vehicle: "",
        excuse: Excuse::None,
    }
}

const QUAD: Excuse = Excuse::Physics("a quadrotor without a rotor does not hold its attitude");
const BLIND: Excuse = Excuse::Physics("nothing measures the attitude");

const SLIP: Excuse = Excuse::Open("too slow for inertia to see, and metres in the end");
const ON_FEET: Excuse = Excuse::Open("on its feet it is neither seen nor held");
const GAP: Excuse =
    Excuse::Open("while the feet leave the ground the attitude moves too fast for it");

const HEXA: &str = "[vehicle]\npreset = \"hexa-6\"\n[battery]\ncells = 6\ncapacity = 20\n[params]\nTET_TENSION = 15\n\
                    TET_TENSION_LOW = 8\n";
const OCTO: &str = "[vehicle]\npreset = \"octo-9\"\n[battery]\ncells = 6\ncapacity = 30\n[params]\nTET_TENSION = 20\n\
                    TET_TENSION_LOW = 10\n";

const CASES: &[Case] = &[
    case("nothing", FaultKind::RangeOffset, 0.0),
    case("rangefinder lost", FaultKind::RangefinderLost, 0.0),
    case("rangefinder stuck at 0.4 m", FaultKind::RangeStuck, 0.4),
    case("rangefinder stuck", FaultKind::RangeStuck, 0.0),
    case("rangefinder +2 m", FaultKind::RangeOffset, 2.0),
    case("rangefinder noise 1 m", FaultKind::RangeNoise, 1.0),
    case("barometer lost", FaultKind::BarometerLost, 0.0),
    case("barometer +5 m", FaultKind::BarometerOffset, 5.0),
    case("barometer stuck", FaultKind::BarometerStuck, 0.0),
    Case { ramp: 60.0, ..case("barometer drifts 3 m", FaultKind::BarometerOffset, 3.0) },
    case("both altimeters lost", FaultKind::AltimeterLost, 0.0),
    Case { duration: Some(0.2), excuse: GAP, ..case("IMU gap 200 ms", FaultKind::ImuSilent, 0.0) },
    Case {
        duration: Some(0.2),
        excuse: GAP,
        ..case("IMU repeats 200 ms", FaultKind::ImuFrozen, 0.0)
    },
    case("IMU at 500 Hz", FaultKind::ImuRate, 500.0),
    Case { excuse: BLIND, ..case("IMU lost", FaultKind::ImuSilent, 0.0) },
    case("accelerometer clipped", FaultKind::AccelClip, 0.0),
    Case { axis: Some(Axis::Z), ..case("accelerometer +1 m/s2", FaultKind::AccelBias, 1.0) },
    case("vibration +10 m/s2", FaultKind::Vibration, 10.0),
    case("thrust 85 %", FaultKind::MotorThrust, 0.85),
    Case { rotor: Some(1), ..case("one rotor 80 %", FaultKind::MotorThrust, 0.8) },
    Case { rotor: Some(1), excuse: QUAD, ..case("one motor stopped", FaultKind::MotorStop, 0.0) },
    Case {
        rotor: Some(1),
        vehicle: HEXA,
        excuse: ON_FEET,
        ..case("one of six motors stopped", FaultKind::MotorStop, 0.0)
    },
    Case {
        rotor: Some(1),
        vehicle: OCTO,
        excuse: ON_FEET,
        ..case("one of eight motors stopped", FaultKind::MotorStop, 0.0)
    },
    case("battery empty", FaultKind::BatteryAt, 0.02),
    case("ground station lost", FaultKind::LinkLost, 0.0),
    Case {
        excuse: Excuse::Open("by inertia alone a degree of tilt adds up to 2 m/s on the way down"),
        ..case("tether cut", FaultKind::TetherBroken, 0.0)
    },
    Case {
        excuse: Excuse::Open(
            "found out by the slack or the silence that it makes, too late in wind",
        ),
        ..case("winch jammed", FaultKind::WinchJam, 0.0)
    },
    case("winch silent", FaultKind::WinchSilent, 0.0),
    Case {
        excuse: Excuse::Open("pull and weight ask for 21 to 29 N: little is left to brake with"),
        ..case("winch pulls 15 N", FaultKind::WinchTension, 15.0)
    },
    Case {
        excuse: Excuse::Physics(
            "pull and weight ask for 29 to 40 N, the position loop may ask for 28",
        ),
        ..case("winch pulls 25 N", FaultKind::WinchTension, 25.0)
    },
    case("encoder stuck", FaultKind::EncoderStuck, 0.0),
    Case { ramp: 0.8, excuse: SLIP, ..case("encoder runs 3 m out", FaultKind::EncoderOffset, 3.0) },
    Case { excuse: SLIP, ..case("encoder slips 10 %", FaultKind::EncoderSlip, 0.1) },
    Case { excuse: SLIP, ..case("encoder slips 30 %", FaultKind::EncoderSlip, 0.3) },
    case("encoder +1 m", FaultKind::EncoderOffset, 1.0),
    Case { duration: Some(0.5), ..case("push 6 N", FaultKind::PushEast, 6.0) },
    Case { duration: Some(2.0), ramp: 0.5, ..case("gust 6 m/s", FaultKind::WindEast, 6.0) },
    Case { duration: Some(2.0), ramp: 0.5, ..case("downdraft 4 m/s", FaultKind::Downdraft, 4.0) },
];

/// How a flight ended.
struct End {
    verdict: Verdict,
    /// Last mode before the motors stopped, or that it flew on to.
    state: &'static str,
    motors_run: bool,
}

/// All of it.
pub fn run(settings: &Overrides) -> Result<Report, String> {
    let mut report = Report::default();
    let seeds = settings.seeds(SEEDS)?;
    for case in CASES {
        for phase in PHASES {
            let scenario = settings.on(scenario(case, phase)?)?;
            let fly = |seed: &u64| fly(&scenario, *seed);
            let ends: Vec<End> = parallel::map(&seeds, parallel::cores(), fly, |_| {})
                .into_iter()
                .collect::<Result<_, String>>()?;
            add(&mut report, case, phase.0, &ends);
        }
    }
    let (rows, flights) = (report.notes.clone(), seeds.len());
    report.picture("faults.md", move |path| Ok(std::fs::write(path, table(&rows, flights))?));
    report.notes.push(
        "Lost: down faster than 1.5 m/s or 1 m/s sideways at first contact, tilted over 70 deg, motors on 10 s after \
         it. Shares with their 95 % bound."
            .into(),
    );
    Ok(report)
}

fn add(report: &mut Report, case: &Case, phase: &str, ends: &[End]) {
    let worst = |of: &dyn Fn(&End) -> Option<f64>| ends.iter().filter_map(of).fold(0.0, f64::max);
    let sink = worst(&|e| e.verdict.touch_down);
    let aside = worst(&|e| e.verdict.touch_down_drift);
    let tilt = worst(&|e| Some(e.verdict.tilt_max.to_degrees()));
    let is_lost = |e: &End| e.verdict.lost.is_some() || e.motors_run;
    let lost = ends.iter().filter(|e| is_lost(e)).count();
    let most = Interval::of_share(lost, ends.len()).most;
    let mut states: Vec<_> = ends.iter().map(|e| e.state).collect();
    states.sort_unstable();
    states.dedup();
    let name = format!("{}, {phase}", case.name);
    let compare = match case.excuse {
        Excuse::None => Compare::AtMost(0.0),
        Excuse::Physics(_) | Excuse::Open(_) => Compare::Alone,
    };
    report.add(format!("{name}: lost"), lost as f64, compare);
    let why = match case.excuse {
        Excuse::None => String::new(),
        Excuse::Physics(why) => format!("; physics: {why}"),
        Excuse::Open(why) => format!("; open: {why}"),
    };
    report.notes.push(format!(
        "{name}: {} | {sink:.2} m/s down, {aside:.2} aside, {tilt:.0} deg | lost {lost} of {}, at most {:.0} %{why}",
        states.join(", "),
        ends.len(),
        most * 100.0,
    ));
}

/// `docs/faults.md`.
fn table(rows: &[String], flights: usize) -> String {
    let mut out = format!(
        "# What breaks, and how it comes down\n\nGenerated by `cargo xtask faults`; do not edit. {flights} flights of \
         each fault in each phase: winch, 3 m/s with gusts, take-off\nto 5 m, hold, a move, landing, everything else \
         at its default. Worst first contact with the ground, worst tilt; lost: faster than\n1.5 m/s down or 1 m/s \
         sideways, over 70°, or motors on 10 s after it; with the 95 % bound of the share.\n\n\
         | fault, phase | ends in | worst touch-down | lost |\n|---|---|---|---|\n"
    );
    for row in rows {
        if let Some((name, rest)) = row.split_once(": ") {
            let _ = writeln!(out, "| {name} | {rest} |");
        }
    }
    out
}

fn scenario(case: &Case, (_, step, at): (&str, usize, f64)) -> Result<Scenario, String> {
    let text = r#"
        [wind]
        speed = 3
        gusts = true
        [[mission]]
        do = "arm"
        [[mission]]
        do = "takeoff"
        altitude = 5
        [[mission]]
        do = "hold"
        seconds = 20
        [[mission]]
        do = "move"
        azimuth = 0.4
        [[mission]]
        do = "hold"
        seconds = 5
        [[mission]]
        do = "land"
        "#;
    let text = format!("{}{text}", case.vehicle);
    let mut scenario = Scenario::parse(&text, case.name).map_err(|e| e.0)?;
    scenario.fault.push(FaultSection {
        duration: case.duration,
        ramp: case.ramp,
        axis: case.axis,
        rotor: case.rotor,
        on_step: Some(step),
        ..FaultSection::new(case.kind, case.value, at)
    });
    Ok(scenario)
}

/// Until the motors have stood for a while, whatever the mission makes of it.
fn fly(scenario: &Scenario, seed: u64) -> Result<End, String> {
    let params = scenario.params().map_err(|e| e.0)?;
    let mut flight = Flight::unrecorded(scenario, params, seed).map_err(|e| e.0)?;
    let (mut state, mut stood) = ("on the ground", 0.0);
    while flight.world.time() < LONGEST && stood < 2.0 {
        let out = *flight.step(&mut |_| {});
        if out.is_armed {
            (state, stood) = (out.mode.rule().name, 0.0);
        } else if flight.metrics.verdict.has_armed {
            stood += 1e-3;
        }
    }
    Ok(End { verdict: flight.metrics.verdict.clone(), state, motors_run: stood < 2.0 })
}
