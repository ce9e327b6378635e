//! Flights on lines that weigh: take-off, hold, landing on the chain, calm and in wind that drags on the line.

use super::flown::{Figure, Flown, fly_all};
use super::{Compare, Overrides, Report};
use crate::metrics::Spread;
use crate::scenario::Scenario;

/// Flights of each, and the longest, simulated s.
const SEEDS: u64 = 10;
const LONGEST: f64 = 900.0;

/// A line and the vehicle that carries it.
struct Row {
    name: &'static str,
    vehicle: &'static str,
    line: &'static str,
    /// m.
    length: f64,
    /// Of the take-off, m.
    altitude: f64,
    /// In flight and near the ground, N: what an operator would set for that much sail.
    tension: [f64; 2],
    /// What carries it while nothing comes up the line, A h.
    battery: [f64; 2],
}

const ROWS: [Row; 5] = [
    Row {
        name: "10 m, 2 g/m",
        vehicle: "quad-1.5",
        line: "light",
        length: 10.0,
        altitude: 8.0,
        tension: [5.0, 3.0],
        battery: [4.0, 5.2],
    },
    Row {
        name: "25 m, 30 g/m",
        vehicle: "quad-3.5",
        line: "power-30",
        length: 25.0,
        altitude: 20.0,
        tension: [15.0, 6.0],
        battery: [6.0, 40.0],
    },
    Row {
        name: "45 m, 10 g/m",
        vehicle: "quad-3.5",
        line: "power-10",
        length: 45.0,
        altitude: 40.0,
        tension: [20.0, 8.0],
        battery: [6.0, 40.0],
    },
    Row {
        name: "45 m, 30 g/m",
        vehicle: "quad-3.5",
        line: "power-30",
        length: 45.0,
        altitude: 40.0,
        tension: [25.0, 10.0],
        battery: [6.0, 40.0],
    },
    Row {
        name: "80 m, 30 g/m",
        vehicle: "quad-8",
        line: "power-30",
        length: 80.0,
        altitude: 70.0,
        tension: [45.0, 18.0],
        battery: [6.0, 120.0],
    },
];

/// Mean wind, m/s; gusts come with it.
const WINDS: [f64; 2] = [0.0, 5.0];

impl Row {
    fn scenario(&self, wind: f64) -> Result<Scenario, String> {
        let Self { vehicle, line, length, altitude, tension: [tension, low], .. } = self;
        let [cells, capacity] = self.battery;
        let text = format!(
            r#"
            [vehicle]
            preset = "{vehicle}"
            [battery]
            cells = {cells}
            capacity = {capacity}
            [tether]
            preset = "{line}"
            model = "chain"
            length = {length}
            winch_length_max = {most}
            winch_force_max = 100.0
            [wind]
            speed = {wind}
            gusts = true
            [params]
            TET_TENSION = {tension}
            TET_TENSION_LOW = {low}
            TET_LEN_MAX = {most}
            [[mission]]
            do = "arm"
            [[mission]]
            do = "takeoff"
            altitude = {altitude}
            [[mission]]
            do = "hold"
            seconds = 60
            [[mission]]
            do = "land"
            "#,
            most = 1.5 * length,
        );
        Scenario::parse(&text, self.name).map_err(|e| e.0)
    }
}

/// Every line, calm and in wind.
pub fn run(settings: &Overrides) -> Result<Report, String> {
    let mut report = Report::default();
    let seeds = settings.seeds(SEEDS)?;
    for row in &ROWS {
        for wind in WINDS {
            let scenario = settings.on(row.scenario(wind)?)?;
            let flown = fly_all(&scenario, &seeds, LONGEST)?;
            add(&mut report, row, wind, &seeds, &flown);
        }
    }
    report.notes.push(format!(
        "Root mean square over {} seeds, horizontal, truth against estimate and against the place held.",
        seeds.len()
    ));
    Ok(report)
}

fn add(report: &mut Report, row: &Row, wind: f64, seeds: &[u64], flown: &[Flown]) {
    let name = format!("{}, {wind} m/s", row.name);
    let lost: Vec<_> = seeds
        .iter()
        .zip(flown)
        .filter_map(|(seed, (_, why))| Some((seed, why.as_ref()?)))
        .collect();
    for (seed, why) in &lost {
        report.notes.push(format!("{name}, seed {seed}: {why}"));
    }
    report.add(format!("{name}: lost"), lost.len() as f64, Compare::AtMost(0.0));
    let figures: [Figure; 3] = [
        ("estimate, m", |s| s.estimate_horizontal_rms_m),
        ("hold, m", |s| s.hold_horizontal_rms_m),
        ("tension, N", |s| s.tension_rms_n),
    ];
    for (figure, of) in figures {
        let mut spread = Spread::default();
        flown.iter().filter_map(|(summary, _)| of(summary)).for_each(|x| spread.add(x));
        let rms = spread.rms().unwrap_or(f64::NAN);
        report.add(format!("{name}: {figure}"), rms, Compare::Alone);
    }
}
