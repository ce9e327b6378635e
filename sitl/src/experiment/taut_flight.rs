//! The taut-link modes on the whole simulated quadrotor: `flight` section 7, twenty seeds a row.

use super::flown::why_lost;
use super::{Compare, Overrides, Report};
use crate::campaign::parallel;
use crate::flight::Flight;
use crate::metrics::TautSummary;
use crate::scenario::{Scenario, Step, TautControl, TetherKind};

/// Vehicle, sensors and parameters of every row.
const BASE: &str = include_str!("../../scenarios/taut.toml");
/// Flights of a row.
const SEEDS: u64 = 20;
/// How far the vehicle is from the plan's start, rad and N, and the thrust scale from the truth.
const START_ELEVATION: f64 = 5.0;
const START_FORCE: f64 = 1.0;
const THRUST_ERROR: f64 = 0.01;
/// Reference at rest before the move, s.
const REST: f64 = 3.0;
/// Longest flight, s.
const LONGEST: f64 = 120.0;

/// One row. Angles in degrees, forces in N.
#[derive(Clone)]
struct Row {
    name: &'static str,
    control: TautControl,
    elevation: [f64; 2],
    second: [f64; 2],
    /// Where Tether Hold, which keeps a larger thrust reserve, hands over.
    begin: f64,
    duration: f64,
    hold: f64,
    /// On a bar: not scored after the crossing, s.
    settle: f64,
    /// Peak of the gusts, m/s; steady wind from the anchor's side, m/s.
    gust: f64,
    wind: f64,
    /// Thrust errors: each sign in turn, or this one.
    thrust: Option<f64>,
    kind: TetherKind,
    altimeter: bool,
    limits: Option<Limits>,
}

/// Worst of all seeds.
#[derive(Clone, Copy)]
struct Limits {
    lost: f64,
    elevation: [f64; 2],
    second: [f64; 2],
}

const fn limits(lost: f64, elevation: [f64; 2], second: [f64; 2]) -> Option<Limits> {
    Some(Limits { lost, elevation, second })
}

const FORCE: Row = Row {
    name: "Γb 45 to 75 deg, 6 to 10 N, still",
    control: TautControl::Force,
    elevation: [45.0, 75.0],
    second: [6.0, 10.0],
    begin: 6.0,
    duration: 5.0,
    hold: 5.0,
    settle: 0.0,
    gust: 0.0,
    wind: 0.0,
    thrust: None,
    kind: TetherKind::Fixed,
    altimeter: false,
    limits: limits(0.0, [3.0, 8.0], [0.6, 1.1]),
};
const ATTITUDE: Row = Row {
    name: "Γa' 45 to 75 deg, pitch 20 to 7 deg, still",
    control: TautControl::Attitude,
    second: [20.0, 7.0],
    begin: 14.0,
    limits: limits(0.0, [3.5, 8.0], [0.8, 2.1]),
    ..FORCE
};
const BAR: Row = Row {
    name: "bar, 45 deg, 10 s at -3 N, from 5 s after the crossing",
    elevation: [45.0, 45.0],
    second: [6.0, -3.0],
    duration: 1.5,
    hold: 15.0,
    settle: 5.0,
    kind: TetherKind::Bar,
    limits: limits(1.0, [7.0, 15.0], [0.3, 0.6]),
    ..FORCE
};

fn rows() -> Vec<Row> {
    let gusty = limits(0.0, [6.5, 16.0], [0.7, 1.8]);
    vec![
        FORCE,
        Row {
            name: "Γb 60 to 30 deg, 10 to 6 N, still",
            elevation: [60.0, 30.0],
            second: [10.0, 6.0],
            begin: 7.0,
            ..FORCE
        },
        Row {
            name: "Γb 45 to 75 deg, 6 to 10 N, gusts of 3 m/s",
            gust: 3.0,
            limits: limits(0.0, [5.5, 14.0], [0.8, 2.0]),
            ..FORCE
        },
        ATTITUDE,
        Row {
            name: "Γa' 60 to 30 deg, pitch 10 to 25 deg, still",
            elevation: [60.0, 30.0],
            second: [10.0, 25.0],
            begin: 10.0,
            ..ATTITUDE
        },
        Row {
            name: "Γa' 45 to 75 deg, pitch 20 to 7 deg, gusts of 2 m/s",
            gust: 2.0,
            thrust: Some(-1.0),
            limits: gusty,
            ..ATTITUDE
        },
        Row {
            name: "Γa' 60 to 30 deg, pitch 10 to 25 deg, gusts of 2 m/s",
            elevation: [60.0, 30.0],
            second: [10.0, 25.0],
            begin: 10.0,
            gust: 2.0,
            thrust: Some(-1.0),
            limits: gusty,
            ..ATTITUDE
        },
        BAR,
        Row {
            name: "bar, 45 deg, +6 to -3 N and 12 s, from 1 s after the crossing",
            hold: 12.0,
            settle: 1.0,
            limits: None,
            ..BAR
        },
        Row { name: "Γb 45 to 75 deg, gusts of 5 m/s", gust: 5.0, limits: None, ..FORCE },
        Row { name: "Γb 45 to 75 deg, steady wind of 3 m/s", wind: 3.0, limits: None, ..FORCE },
        Row {
            name: "Γb 45 to 75 deg, steady wind of 3 m/s, with the altimeter",
            wind: 3.0,
            altimeter: true,
            limits: None,
            ..FORCE
        },
        Row {
            name: "Γb 45 to 75 deg, thrust 5 % too low, with the altimeter",
            thrust: Some(-5.0),
            altimeter: true,
            limits: None,
            ..FORCE
        },
    ]
}

fn scenario(row: &Row, seed: u64) -> Result<Scenario, String> {
    let mut s = Scenario::parse(BASE, "taut.toml").map_err(|e| e.0)?;
    // Every combination of signs in turn.
    let sign = |bit: u64| if (seed >> bit) & 1 == 0 { 1.0 } else { -1.0 };
    let [from, to] = row.elevation;
    let [second_from, second_to] = row.second;
    let start = from + sign(1) * START_ELEVATION;
    s.tether.kind = row.kind;
    if row.kind == TetherKind::Bar {
        s.tether.stiffness = 1e5;
        s.params.insert("TLK_LAT_BW".into(), 0.8);
        s.params.insert("TLK_LAT_NOISE".into(), 3.0);
    }
    s.wind.pulse = row.gust;
    s.wind.speed = row.wind;
    s.vehicle.common_thrust_error = 0.0;
    // What the firmware believes of its thrust is wrong, not the thrust.
    let error = row.thrust.map_or(sign(0) * THRUST_ERROR, |percent| percent / 100.0);
    s.params.insert("THR_SCALE".into(), (1.0 - error) as f32);
    s.params.insert("TLK_ALT_TAU".into(), if row.altimeter { 1.5 } else { 0.0 });
    let tension = match row.control {
        TautControl::Force => row.begin + sign(2) * START_FORCE,
        // The tension at which it hangs with the plan's first pitch.
        TautControl::Attitude => attitude_tension(s.vehicle.mass, start, row.begin),
    };
    s.params.insert("TET_TENSION".into(), tension as f32);
    let (rad, unit) = (f64::to_radians, |y: f64| match row.control {
        TautControl::Force => y,
        TautControl::Attitude => y.to_radians(),
    });
    let step = |elevation: [f64; 2], second: [f64; 2], duration| Step::TautMove {
        elevation: elevation.map(rad),
        second: second.map(unit),
        control: row.control,
        duration,
    };
    s.mission = vec![
        Step::Arm,
        Step::Takeoff { altitude: s.tether.length * start.to_radians().sin() },
        Step::Hold { seconds: 6.0 },
        Step::Taut { control: row.control },
        step([from, from], [row.begin, row.begin], REST),
    ];
    if row.begin.to_bits() != second_from.to_bits() {
        s.mission.push(step([from, from], [row.begin, second_from], REST));
    }
    s.mission.push(step([from, to], [second_from, second_to], row.duration));
    s.mission.push(Step::Hold { seconds: row.hold });
    Ok(s)
}

/// Tension at rest, N, for elevation and pitch in degrees.
fn attitude_tension(mass: f64, elevation: f64, pitch: f64) -> f64 {
    let (phi, z) = (elevation.to_radians(), (elevation + pitch).to_radians());
    let weight = mass * crate::plant::GRAVITY;
    weight * phi.cos() * z.tan() - weight * phi.sin()
}

/// One flight: why lost, if lost, and the figures.
fn fly(
    row: &Row,
    settings: &Overrides,
    seed: u64,
) -> Result<(Option<String>, Option<TautSummary>), String> {
    let own = scenario(row, seed)?;
    let s = settings.on(own)?;
    let params = s.params().map_err(|e| e.0)?;
    let mut flight = Flight::unrecorded(&s, params, seed).map_err(|e| e.0)?;
    if row.kind == TetherKind::Bar {
        flight.metrics.taut.settling = REST + row.duration + row.settle;
    }
    flight.fly(LONGEST);
    Ok((why_lost(&flight), flight.metrics.taut.summary()))
}

/// Every row over all seeds, worst beside its limit.
pub fn run(settings: &Overrides) -> Result<Report, String> {
    let seeds = settings.seeds(SEEDS)?;
    let mut report = Report::default();
    for row in rows() {
        fly_row(&row, settings, &seeds, &mut report)?;
    }
    report.notes.push(format!(
        "Worst of {} seeds, each with its own start error (5 deg, 1 N), thrust error (1 %), gyro bias \
         and noise; what has no limit is shown for comparison.",
        seeds.len()
    ));
    Ok(report)
}

fn fly_row(
    row: &Row,
    settings: &Overrides,
    numbers: &[u64],
    report: &mut Report,
) -> Result<(), String> {
    let flown = parallel::map(numbers, parallel::cores(), |&seed| fly(row, settings, seed), |_| {});
    let mut lost = 0.0;
    let mut worst = [0.0_f64; 4];
    for (seed, outcome) in numbers.iter().zip(flown) {
        match outcome? {
            (None, Some(s)) => {
                let figures =
                    [s.elevation_rms_rad, s.elevation_max_rad, s.second_rms, s.second_max];
                for (worst, x) in worst.iter_mut().zip(figures) {
                    *worst = worst.max(x);
                }
            }
            (why, _) => {
                lost += 1.0;
                let why = why.unwrap_or_else(|| "never flew the mode".into());
                report.notes.push(format!("{}, seed {seed}: {why}", row.name));
            }
        }
    }
    let is_force = row.control == TautControl::Force;
    let (unit, scale) = if is_force { ("N", 1.0) } else { ("deg", 180.0 / std::f64::consts::PI) };
    let what = if is_force { "link force" } else { "pitch" };
    let [phi_rms, phi_max, rms, max] = worst;
    let limit = |pick: fn(&Limits) -> f64| {
        row.limits.as_ref().map_or(Compare::Alone, |l| Compare::AtMost(pick(l)))
    };
    let name = row.name;
    // The limit counts in twenty; fewer seeds may lose fewer.
    report.add(format!("{name}: lost, 1"), lost, limit(|l| l.lost));
    report.add(
        format!("{name}: elevation rms, deg"),
        phi_rms.to_degrees(),
        limit(|l| l.elevation[0]),
    );
    report.add(
        format!("{name}: elevation max, deg"),
        phi_max.to_degrees(),
        limit(|l| l.elevation[1]),
    );
    report.add(format!("{name}: {what} rms, {unit}"), rms * scale, limit(|l| l.second[0]));
    report.add(format!("{name}: {what} max, {unit}"), max * scale, limit(|l| l.second[1]));
    Ok(())
}
