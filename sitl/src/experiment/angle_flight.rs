//! Tether Angle on the whole simulated quadrotor: `flight` section 7, twenty seeds a row.

use super::flown::why_lost;
use super::{Compare, Overrides, Report};
use crate::campaign::parallel;
use crate::flight::Flight;
use crate::metrics::AngleFlightSummary;
use crate::report::chart::{ESTIMATE, Line, Panel, Points, SETPOINT, THIRD, TRUTH};
use crate::report::grid::{self, grid};
use crate::scenario::{Scenario, Step};
use tautline_firmware::estimate::tether_angle::plane_angles;
use tautline_firmware::frames::World;

/// Vehicle, sensors and parameters of every row.
pub const BASE: &str = include_str!("../../scenarios/angle.toml");
/// Flights of a row.
const SEEDS: u64 = 20;
/// How far the vehicle is from the set-point at the start, the nose from its assumed heading, and the
/// thrust scale from the truth: deg, deg, 1.
const START: f64 = 5.0;
const HEADING: f64 = 2.0;
const THRUST: f64 = 0.01;
/// The anchor's walk: m, m/s, s.
const WALK: [f64; 3] = [1.0, 0.3, 1.0];
/// Before the walk and the whole hold, s.
const BEFORE: f64 = 4.0;
const HOLD: f64 = 26.0;
/// Longest flight, s.
pub const LONGEST: f64 = 120.0;

/// One row; angles in deg.
#[derive(Clone, Copy)]
struct Row {
    name: &'static str,
    /// Of the tether from straight up.
    angle: f64,
    /// Over mass, m/s².
    thrust: f32,
    /// Error of the assumed thrust; `None`: 1 % of either sign.
    error: Option<f64>,
    heading: f64,
    gust: f64,
    /// Lost of twenty, estimate and tracking rms.
    limits: Option<[f64; 3]>,
}

const STEEP: Row = Row {
    name: "30 deg, thrust 16 m/s²",
    angle: 30.0,
    thrust: 16.0,
    error: None,
    heading: HEADING,
    gust: 0.0,
    limits: Some([1.0, 2.5, 4.5]),
};
const FLAT: Row =
    Row { name: "45 deg, thrust 16 m/s²", angle: 45.0, limits: Some([1.0, 4.0, 6.0]), ..STEEP };

fn rows() -> [Row; 8] {
    let shown = Row { limits: None, ..STEEP };
    [
        STEEP,
        FLAT,
        Row { name: "30 deg, thrust 14 m/s²", thrust: 14.0, ..shown },
        Row { name: "30 deg, thrust 12 m/s²", thrust: 12.0, ..shown },
        Row { name: "30 deg, gusts of 3 m/s", gust: 3.0, ..shown },
        Row { name: "45 deg, gusts of 3 m/s", gust: 3.0, angle: 45.0, ..shown },
        Row { name: "30 deg, heading off by 5 deg", heading: 5.0, ..shown },
        Row { name: "30 deg, thrust 5 % lower than believed", error: Some(-0.05), ..shown },
    ]
}

/// A flight of a row: every combination of signs and the walk's directions in turn.
fn scenario(row: &Row, seed: u64) -> Result<Scenario, String> {
    let mut s = Scenario::parse(BASE, "angle.toml").map_err(|e| e.0)?;
    let sign = |bit: u64| if (seed >> bit) & 1 == 0 { 1.0 } else { -1.0 };
    let elevation = 90.0 - row.angle;
    let start = elevation + sign(1) * START;
    s.vehicle.common_thrust_error = 0.0;
    let error = row.error.unwrap_or(sign(0) * THRUST);
    s.params.insert("THR_SCALE".into(), (1.0 - error) as f32);
    s.params.insert("TAG_THR_ACC".into(), row.thrust);
    s.vehicle.heading = (sign(2) * row.heading).to_radians();
    s.params.insert("TET_HDG0".into(), 0.0);
    s.wind.pulse = row.gust;
    let [way, speed, ramp] = WALK;
    let way = match seed % 3 {
        0 => [way, 0.0],
        1 => [0.0, way],
        _ => [-way, 0.0],
    };
    s.mission = vec![
        Step::Arm,
        Step::Takeoff { altitude: s.tether.length * start.to_radians().sin() },
        Step::Hold { seconds: 6.0 },
        Step::TetherAngle,
        Step::Move {
            elevation: Some(elevation.to_radians()),
            azimuth: None,
            length: None,
            tension: None,
        },
        Step::Hold { seconds: BEFORE },
        Step::WalkAnchor { way, speed, ramp },
        Step::Hold { seconds: HOLD },
    ];
    Ok(s)
}

/// Why lost, if lost, and the figures.
type Flown = (Option<String>, Option<AngleFlightSummary>);

fn fly(row: &Row, settings: &Overrides, seed: u64) -> Result<Flown, String> {
    let s = settings.on(scenario(row, seed)?)?;
    let params = s.params().map_err(|e| e.0)?;
    let mut flight = Flight::unrecorded(&s, params, seed).map_err(|e| e.0)?;
    flight.fly(LONGEST);
    Ok((why_lost(&flight), flight.metrics.angle.summary()))
}

/// Every row over all seeds, worst beside its limit.
pub fn run(settings: &Overrides) -> Result<Report, String> {
    let mut report = Report::default();
    let seeds = settings.seeds(SEEDS)?;
    for row in rows() {
        let work = |seed: &u64| fly(&row, settings, *seed);
        let flown = parallel::map(&seeds, parallel::cores(), work, |_| {});
        let (mut lost, mut worst) = (0.0, [0.0_f64; 3]);
        for (seed, outcome) in seeds.iter().zip(flown) {
            let (why, figures) = outcome?;
            match (why, figures) {
                (None, Some(f)) => {
                    let now = [f.estimate_rms_rad, f.tracking_rms_rad, f.tension_rms_n];
                    worst.iter_mut().zip(now).for_each(|(worst, x)| *worst = worst.max(x));
                }
                (why, _) => {
                    lost += 1.0;
                    let why = why.unwrap_or_else(|| "never flew the mode".into());
                    report.notes.push(format!("{}, seed {seed}: {why}", row.name));
                }
            }
        }
        let [estimate, tracking, tension] = worst;
        let limit = |i: usize| {
            row.limits.and_then(|l| l.get(i).copied()).map_or(Compare::Alone, Compare::AtMost)
        };
        let name = row.name;
        report.add(format!("{name}: lost, 1"), lost, limit(0));
        report.add(format!("{name}: estimate rms, deg"), estimate.to_degrees(), limit(1));
        report.add(format!("{name}: tracking rms, deg"), tracking.to_degrees(), limit(2));
        report.add(format!("{name}: tension rms, N"), tension, Compare::Alone);
    }
    let cells = picture(settings)?;
    report.picture("angle-flight.svg", move |path| grid(path, 2, &cells));
    report.notes.push(format!(
        "Worst of {} seeds on the worse of two axes, from 4 s after the mode began; anchor walked 1 m at 0.3 \
         m/s out, aside or in; start 5 deg off, heading 2 deg, thrust 1 %.",
        seeds.len()
    ));
    Ok(report)
}

/// One flight of the first row, from the change into the mode on: anchor and vehicle, angles, tension.
fn picture(settings: &Overrides) -> Result<Vec<grid::Cell>, String> {
    let s = settings.on(scenario(&STEEP, 3)?)?;
    let params = s.params().map_err(|e| e.0)?;
    let mut flight = Flight::unrecorded(&s, params, 3).map_err(|e| e.0)?;
    let mut began = None;
    let mut series: [Points; 10] = Default::default();
    while flight.world.time() < LONGEST && !flight.is_over() {
        flight.step(&mut |_| {});
        let out = flight.output();
        let (Some(angle), Some(reference)) = (&out.angle, &out.reference) else { continue };
        let now = flight.world.time();
        let time = now - *began.get_or_insert(now);
        let plant = &flight.world.environment.plant;
        let [north, west] = plane_angles(&World(plant.end())).map(f64::to_degrees);
        let [estimate_north, estimate_west] = angle.angles().map(|x| f64::from(x).to_degrees());
        let setpoint = plane_angles(&World(reference.position.0.map(f64::from)));
        let [reference_north, reference_west] = setpoint.map(f64::to_degrees);
        let values = [
            plant.anchor.position.x,
            plant.body.position.x,
            reference_north,
            north,
            estimate_north,
            reference_west,
            west,
            estimate_west,
            plant.tether.tension(),
            f64::from(angle.tension),
        ];
        for (points, value) in series.iter_mut().zip(values) {
            points.push((time, value));
        }
    }
    let [anchor, body, ref_north, north, est_north, ref_west, west, est_west, tension, estimate] =
        series;
    let angles = |title: &'static str, setpoint, truth, estimate| {
        let lines = vec![
            Line::new("true", TRUTH, truth),
            Line::new("estimated", ESTIMATE, estimate),
            Line::new("asked", SETPOINT, setpoint).dashed(),
        ];
        (Panel::new(title, "time, s", "deg"), lines)
    };
    Ok(vec![
        (
            Panel::new("The anchor walks, the vehicle follows", "time, s", "north, m"),
            vec![Line::new("vehicle", TRUTH, body), Line::new("anchor", THIRD, anchor)],
        ),
        angles("Tether angle in the plane of north", ref_north, north, est_north),
        angles("in the plane of west", ref_west, west, est_west),
        (
            Panel::new("Tension", "time, s", "N"),
            vec![Line::new("true", TRUTH, tension), Line::new("estimated", ESTIMATE, estimate)],
        ),
    ])
}
