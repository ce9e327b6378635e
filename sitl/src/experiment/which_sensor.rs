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
/// Estimate, m, that a direction sensor stays below up to 5 m/s with the tension moving: half as much again as `fullstate`
/// section 21 has on a line that the wind bends (0.09 and 0.079), for encoders with steps and friction.
const LIMIT_VEHICLE: f64 = 0.14;
const LIMIT_GROUND: f64 = 0.12;

struct Sensor {
    name: &'static str,
    /// Of the scenario.
    keys: &'static str,
    /// Of the place in three coordinates with the tension moving, up to 5 m/s, m.
    limit: Option<f64>,
    /// The specification's: without movement and with it, at each wind.
    specified: [[Option<f64>; 4]; 2],
}

/// At 5 m/s the specification says nothing of the moving tension.
const fn all([a, b, c, d]: [f64; 4], [e, f, g]: [f64; 3]) -> [[Option<f64>; 4]; 2] {
    [[Some(a), Some(b), Some(c), Some(d)], [Some(e), Some(f), None, Some(g)]]
}

const SENSORS: [Sensor; 7] = [
    Sensor {
        name: "none",
        keys: "",
        limit: None,
        specified: all([0.19, 0.36, 0.74, 1.82], [0.097, 0.152, 0.27]),
    },
    Sensor {
        name: "load cell at the station",
        keys: "[sensors]\ntension_cell = true",
        limit: None,
        specified: all([0.17, 0.32, 0.60, 1.20], [0.10, 0.15, 0.23]),
    },
    Sensor {
        name: "compass, calibrated to 3 %",
        keys: "[sensors]\nmagnetometer = true\nmagnetic_offset = 6e-7\nmagnetic_scale = 0.01",
        limit: None,
        specified: all([0.14, 0.37, 0.74, 1.82], [0.076, 0.12, 0.25]),
    },
    Sensor {
        name: "optical flow, 0.1 m/s, 3 % scale",
        keys: "[capture]\nrate = 50\nposition = false\nvelocity_noise = 0.1\nvelocity_scale = 0.03",
        limit: None,
        specified: all([0.14, 0.17, 0.17, 0.17], [0.085, 0.082, 0.091]),
    },
    Sensor {
        name: "line angles at the vehicle, mounted to 1°",
        keys: "[sensors]\nvehicle_angles = true\nangle_offset = 0.0175",
        limit: Some(LIMIT_VEHICLE),
        specified: all([0.10, 0.11, 0.11, 0.12], [0.084, 0.078, 0.080]),
    },
    Sensor {
        name: "line direction at the station, mounted to 1°",
        keys: "[sensors]\nground_angles = true\n[station]\nangle_offset = 0.0175",
        limit: Some(LIMIT_GROUND),
        specified: all([0.062, 0.074, 0.074, 0.073], [0.050, 0.044, 0.048]),
    },
    Sensor {
        name: "position, 2 cm (RTK, motion capture)",
        keys: "[capture]\nrate = 10\nposition_noise = 0.02\ndelay = 0.05",
        limit: None,
        specified: [[Some(0.018), Some(0.022), Some(0.022), Some(0.022)], [None; 4]],
    },
];

/// What the simulator gave in one cell.
struct Cell {
    wind: f64,
    lost: usize,
    /// Root mean square, m; `None`: hardly any flight got there.
    estimate: Option<Interval>,
}

/// With the tension still and moving, N.
const DITHERS: [f64; 2] = [0.0, 2.5];
type Row = [Vec<Cell>; 2];

/// All of it.
pub fn run(settings: &Overrides) -> Result<Report, String> {
    let mut report = Report::default();
    let seeds = settings.seeds(SEEDS)?;
    let mut rows = Vec::new();
    for sensor in &SENSORS {
        let mut row = Row::default();
        for (cells, dither) in row.iter_mut().zip(DITHERS) {
            for wind in WINDS {
                let scenario = settings.on(scenario(sensor, wind, dither)?)?;
                cells.push(cell(wind, &fly_all(&scenario, &seeds, LONGEST)?));
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

fn cell(wind: f64, flown: &[Flown]) -> Cell {
    let places = flown.iter().filter_map(|(summary, _)| summary.place);
    let errors: Vec<f64> = places.map(|place| place.estimate_rms_m).collect();
    let lost = flown.iter().filter(|(_, why)| why.is_some()).count();
    Cell { wind, lost, estimate: Interval::of_rms(&errors) }
}

fn add(report: &mut Report, sensor: &Sensor, [still, moving]: &Row) {
    for (tension, cell) in
        still.iter().map(|cell| ("still", cell)).chain(moving.iter().map(|cell| ("moving", cell)))
    {
        let (wind, moves) = (cell.wind, tension == "moving");
        let name = format!("{}, {wind} m/s, tension {tension}", sensor.name);
        // Without movement and without a sensor, wind and azimuth are not told apart.
        let most = if moves || wind <= 5.0 { Compare::AtMost(0.0) } else { Compare::Alone };
        report.add(format!("{name}: lost"), cell.lost as f64, most);
        let limit = sensor.limit.filter(|_| moves && wind <= 5.0);
        let compare = limit.map_or(Compare::Alone, Compare::AtMost);
        let estimate = cell.estimate.map_or(f64::NAN, |interval| interval.middle);
        report.add(format!("{name}: estimate, m"), estimate, compare);
    }
}

/// As a page.
fn page(rows: &[(&'static Sensor, Row)], seeds: usize) -> String {
    let mut page = format!(
        "# Which sensor to buy

Error of the estimated place in three coordinates, m: root mean square over {seeds} flights a cell, from the ground \
to the ground, of a hold at 45° on a fixed line of 10 m that the wind bends, in gusts; the 95 % interval in brackets, \
then what the specification's own plant gave. \"Moving\" is the tension's movement of ±2.5 N every 1.5 s \
([estimation.md](estimation.md)).

By `cargo sitl experiment which-sensor --plot docs`, which writes this page.

| sensor | tension | 0 m/s | 3 m/s | 5 m/s | 8 m/s |
|---|---|---|---|---|---|
"
    );
    for (sensor, row) in rows {
        for ((cells, specified), tension) in
            row.iter().zip(&sensor.specified).zip(["still", "moving"])
        {
            let _ = write!(page, "| {} | {tension} |", sensor.name);
            for (cell, specified) in cells.iter().zip(specified) {
                if let Some(Interval { least, middle, most }) = cell.estimate {
                    let _ = write!(page, " {middle:.3} ({least:.2}–{most:.2})");
                }
                let _ = specified.map(|x| write!(page, "; {x:.2}"));
                if cell.lost > 0 {
                    let _ = write!(page, " **{} lost**", cell.lost);
                }
                page.push_str(" |");
            }
            page.push('\n');
        }
    }
    page.push_str(NOTES);
    page
}

const NOTES: &str = "
What to read from it: nothing but the moving tension already gives a fifth of a metre; a flow sensor or the line's \
angles halve that in wind; the station's encoders and a compass also hold the azimuth for days, which nothing else \
here does but a position. Within a minute a compass costs what its calibration is wrong by: the heading at the start \
is exact here. A load cell is for heavy lines. What a direction sensor may not do without is the bow: the \
wind bends the line, EST_BOW says how much of its force comes through it.

Which of them count is EST_AIDS ([parameters.md](parameters.md)); how they are wired is in [line.md](line.md).
";
