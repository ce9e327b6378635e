//! What does each sensor buy in which wind? A hold on a fixed line of 10 m, with one sensor more at a time, with and
//! without the movement of the tension (`fullstate` section 21).

use super::flown::{Flown, fly_all};
use super::{Compare, Overrides, Report};
use crate::metrics::Interval;
use crate::scenario::Scenario;
use std::fmt::Write as _;

/// Flights of each, and the longest, simulated s.
const SEEDS: u64 = 12;
const LONGEST: f64 = 300.0;
/// Mean winds, m/s, with gusts.
const WINDS: [f64; 4] = [0.0, 3.0, 5.0, 8.0];
/// Estimate, m, that a direction sensor stays below up to 5 m/s with the tension moving: `fullstate` section 21 and half
/// as much again, for vibration and quantisation that its own plant did not have.
const LIMIT_VEHICLE: f64 = 0.12;
const LIMIT_GROUND: f64 = 0.08;

struct Sensor {
    name: &'static str,
    /// Of the scenario.
    keys: &'static str,
    /// Of the place in three coordinates with the tension moving, up to 5 m/s, m.
    limit: Option<f64>,
    /// The specification's: without movement at 0, 3, 5, 8 m/s; with it at 0, 3, 8.
    specified: [Option<f64>; 7],
}

const fn all(seven: [f64; 7]) -> [Option<f64>; 7] {
    let [a, b, c, d, e, f, g] = seven;
    [Some(a), Some(b), Some(c), Some(d), Some(e), Some(f), Some(g)]
}

const SENSORS: [Sensor; 7] = [
    Sensor {
        name: "none",
        keys: "",
        limit: None,
        specified: all([0.19, 0.36, 0.74, 1.82, 0.097, 0.152, 0.27]),
    },
    Sensor {
        name: "load cell at the station",
        keys: "[sensors]\ntension_cell = true",
        limit: None,
        specified: all([0.17, 0.32, 0.60, 1.20, 0.10, 0.15, 0.23]),
    },
    Sensor {
        name: "compass, calibrated to 3 %",
        keys: "[sensors]\nmagnetometer = true\nmagnetic_offset = 6e-7\nmagnetic_scale = 0.01",
        limit: None,
        specified: all([0.14, 0.37, 0.74, 1.82, 0.076, 0.12, 0.25]),
    },
    Sensor {
        name: "optical flow, 0.1 m/s, 3 % scale",
        keys: "[capture]\nrate = 50\nposition = false\nvelocity_noise = 0.1\nvelocity_scale = 0.03",
        limit: None,
        specified: all([0.14, 0.17, 0.17, 0.17, 0.085, 0.082, 0.091]),
    },
    Sensor {
        name: "line angles at the vehicle, mounted to 1°",
        keys: "[sensors]\nvehicle_angles = true\nangle_offset = 0.0175",
        limit: Some(LIMIT_VEHICLE),
        specified: all([0.10, 0.11, 0.11, 0.12, 0.084, 0.078, 0.080]),
    },
    Sensor {
        name: "line direction at the station, mounted to 1°",
        keys: "[sensors]\nground_angles = true\n[station]\nangle_offset = 0.0175",
        limit: Some(LIMIT_GROUND),
        specified: all([0.062, 0.074, 0.074, 0.073, 0.050, 0.044, 0.048]),
    },
    Sensor {
        name: "position, 2 cm (RTK, motion capture)",
        keys: "[capture]\nrate = 10\nposition_noise = 0.02\ndelay = 0.05",
        limit: None,
        specified: [Some(0.018), Some(0.022), Some(0.022), Some(0.022), None, None, None],
    },
];

/// What the simulator gave in one cell.
struct Cell {
    lost: usize,
    /// Root mean square, m; `None`: hardly any flight got there.
    estimate: Option<Interval>,
}

/// All of it.
pub fn run(settings: &Overrides) -> Result<Report, String> {
    let mut report = Report::default();
    let seeds = settings.seeds(SEEDS)?;
    let mut rows = Vec::new();
    for sensor in &SENSORS {
        let mut row = Vec::new();
        for (dither, winds) in [(0.0, &WINDS[..]), (2.5, &WINDS[..])] {
            for &wind in winds {
                let scenario = settings.on(scenario(sensor, wind, dither)?)?;
                let flown = fly_all(&scenario, &seeds, LONGEST)?;
                row.push(cell(&flown));
            }
        }
        add(&mut report, sensor, &row);
        rows.push((sensor, row));
    }
    let page = page(&rows, seeds.len());
    report.picture("which-sensor.md", move |path| Ok(std::fs::write(path, &page)?));
    Ok(report)
}

fn scenario(sensor: &Sensor, wind: f64, dither: f64) -> Result<Scenario, String> {
    let text = format!(
        r#"
        {keys}
        [tether]
        kind = "fixed"
        length = 10
        model = "chain"
        [wind]
        speed = {wind}
        gusts = true
        [params]
        TET_DITHER = {dither:.1}
        [[mission]]
        do = "arm"
        [[mission]]
        do = "takeoff"
        altitude = 7.07
        [[mission]]
        do = "hold"
        seconds = 40
        [[mission]]
        do = "land"
        "#,
        keys = sensor.keys,
    );
    Scenario::parse(&text, sensor.name).map_err(|e| e.0)
}

fn cell(flown: &[Flown]) -> Cell {
    let places = flown.iter().filter_map(|(summary, _)| summary.place);
    let errors: Vec<f64> = places.map(|place| place.estimate_rms_m).collect();
    let lost = flown.iter().filter(|(_, why)| why.is_some()).count();
    Cell { lost, estimate: Interval::of_rms(&errors) }
}

fn add(report: &mut Report, sensor: &Sensor, row: &[Cell]) {
    for (at, cell) in row.iter().enumerate() {
        let (wind, moves) = (WINDS[at % WINDS.len()], at >= WINDS.len());
        let tension = if moves { "moving" } else { "still" };
        let name = format!("{}, {wind} m/s, tension {tension}", sensor.name);
        // Without movement and without a sensor, wind and azimuth are not told apart.
        let is_blind = !moves && wind > 5.0;
        let most = if is_blind { Compare::Alone } else { Compare::AtMost(0.0) };
        report.add(format!("{name}: lost"), cell.lost as f64, most);
        let limit = sensor.limit.filter(|_| moves && wind <= 5.0);
        let compare = limit.map_or(Compare::Alone, Compare::AtMost);
        let estimate = cell.estimate.map_or(f64::NAN, |interval| interval.middle);
        report.add(format!("{name}: estimate, m"), estimate, compare);
    }
}

/// As a page.
fn page(rows: &[(&'static Sensor, Vec<Cell>)], seeds: usize) -> String {
    let mut page = format!(
        "# Which sensor to buy

Error of the estimated place in three coordinates, m: root mean square over {seeds} flights a cell, from the ground \
to the ground, of a hold on a fixed line of 10 m at 45° in gusty wind; 95 % interval in brackets, then what the \
specification's own plant gave. Lost flights in bold.

By `cargo sitl experiment which-sensor --plot docs`, which writes this page.

| sensor | tension | 0 m/s | 3 m/s | 5 m/s | 8 m/s |
|---|---|---|---|---|---|
"
    );
    for (sensor, row) in rows {
        for (half, tension) in [(0, "still"), (1, "moving")] {
            let _ = write!(page, "| {} | {tension} |", sensor.name);
            for at in 0..WINDS.len() {
                let specified = match (half, at) {
                    (0, at) => sensor.specified[at],
                    (_, 0 | 1) => sensor.specified[4 + at],
                    (_, 3) => sensor.specified[6],
                    _ => None,
                };
                if let Some(cell) = row.get(half * WINDS.len() + at) {
                    if let Some(Interval { least, middle, most }) = cell.estimate {
                        let _ = write!(page, " {middle:.3} ({least:.2}–{most:.2})");
                    }
                    let _ = specified.map(|x| write!(page, "; {x:.2}"));
                    if cell.lost > 0 {
                        let _ = write!(page, " **{} lost**", cell.lost);
                    }
                    page.push_str(" |");
                }
            }
            page.push('\n');
        }
    }
    page
}
