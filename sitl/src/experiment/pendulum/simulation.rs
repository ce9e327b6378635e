//! The article's simulation: Figs. 1 to 4.

use super::cases::{DISTURBANCES, add_error, mean, traces};
use crate::bench::pendulum::{PendulumRow, PendulumScenario, PendulumTrace};
use crate::experiment::{Compare, Overrides, Report, Source};
use crate::report::chart::{ESTIMATE, Line, Panel, Points, SETPOINT, THIRD, TRUTH};
use crate::report::grid::{self, grid};
use crate::report::space::{Curve, curves};
use crate::scenario::DisturbanceKind;
use plotters::style::RGBColor;

fn series(trace: &PendulumTrace, pick: impl Fn(&PendulumRow) -> f64) -> Points {
    trace.rows.iter().map(|row| (row.time, pick(row))).collect()
}

/// Mean of a row's figure from the settling time on.
fn late_mean(trace: &PendulumTrace, settled: f64, pick: impl Fn(&PendulumRow) -> f64) -> f64 {
    let late = trace.rows.iter().filter(|row| row.time >= settled);
    let (sum, count) = late.fold((0.0, 0.0), |(sum, n), row| (sum + pick(row), n + 1.0));
    sum / count
}

const COLOURS: [RGBColor; 3] = [TRUTH, SETPOINT, ESTIMATE];

/// Figs. 1 to 4, for 120 s as printed.
pub fn simulation(settings: &Overrides) -> Result<Report, String> {
    let mut report = Report::default();
    let base = PendulumScenario { duration: 120.0, ..PendulumScenario::default() };
    let settled = settings.on(base.clone())?.settled;
    let mut flown = Vec::new();
    // Means of (5a)-(5b) along the track, from the reference implementation, `pendulum` section 10.
    let reference = [0.010, 5.0, 9.6];
    for ((name, disturbance), value) in DISTURBANCES.into_iter().zip(reference) {
        let s = PendulumScenario { disturbance, ..base.clone() };
        let runs = traces(settings, s, 6)?;
        let figures: Vec<_> = runs.iter().map(|trace| trace.summary.clone()).collect();
        let near = Compare::Near { from: Source::Specification, value, share: 0.25, slack: 0.01 };
        add_error(&mut report, name, &figures, near);
        report.add(
            format!("{name}: largest tilt of the rod, deg"),
            mean(&figures, |s| s.tilt_peak).to_degrees(),
            Compare::Alone,
        );
        flown.extend(runs.into_iter().next().map(|trace| (name, disturbance, trace)));
    }
    let mut thrusts = Vec::new();
    for (name, disturbance, trace) in &flown {
        let speed = late_mean(trace, settled, |row| row.estimated_velocity.norm());
        report.add(
            format!("{name}: estimated speed of the load, m/s"),
            speed,
            // "close to the reference", without a figure.
            Compare::Near { from: Source::Paper, value: 0.5, share: 0.1, slack: 0.0 },
        );
        let thrust = late_mean(trace, settled, |row| row.thrust);
        report.add(format!("{name}: mean thrust, N"), thrust, Compare::Alone);
        thrusts.push((*disturbance, thrust));
    }
    if let [(_, calm), (_, lifted), _] = thrusts.as_slice() {
        report.add(
            "thrust saved by the lifting disturbance, N",
            calm - lifted,
            Compare::Claim("a constant lift reduces the thrust", calm - lifted > 0.5),
        );
    }
    let cold = wrong_start(settings, &base)?;
    report.add(
        "start from a posterior turned over (as printed): largest tilt, deg",
        cold.summary.tilt_peak.to_degrees(),
        Compare::Near { from: Source::Specification, value: 147.0, share: 0.1, slack: 0.0 },
    );
    report.add(
        "start from a posterior turned over (as printed): mean error, cm",
        100.0 * cold.summary.error_mean,
        Compare::Claim("survives a large initial estimation error", !cold.summary.is_lost()),
    );
    report.notes.push(
        "The article prints no tracking error for its simulation; references are those of the \
         independent implementation, `pendulum` section 10. Its first estimate, the rod pointing down, swings the pendulum far \
         over; the core starts from the first measurement instead."
            .into(),
    );
    draw(&mut report, flown);
    Ok(report)
}

/// The article starts the filter at the rod hanging down.
fn wrong_start(settings: &Overrides, base: &PendulumScenario) -> Result<PendulumTrace, String> {
    let s = settings.on(PendulumScenario {
        starts_turned_over: true,
        duration: 40.0,
        ..base.clone()
    })?;
    s.fly(settings.seed)
}

fn draw(report: &mut Report, flown: Vec<(&'static str, DisturbanceKind, PendulumTrace)>) {
    let mut paths = Vec::new();
    let over = |title: &'static str, unit: &'static str, pick: fn(&PendulumRow) -> f64| {
        let lines = flown
            .iter()
            .zip(COLOURS)
            .map(|((name, _, trace), colour)| Line::new(*name, colour, series(trace, pick)))
            .collect();
        (Panel::new(title, "time, s", unit), lines)
    };
    let mut cells: Vec<grid::Cell> = vec![
        over("Thrust (Fig. 2)", "N", |r| r.thrust),
        over("Estimated speed of the load (Fig. 2)", "m/s", |r| r.estimated_velocity.norm()),
        over("Body-rate command (Fig. 2)", "rad/s", |r| r.rate.norm()),
        over("Load from its reference", "m", |r| r.error().norm()),
    ];
    if let Some((_, _, trace)) = flown.last() {
        let lines = |pick: fn(&PendulumRow) -> nalgebra::Vector3<f64>| {
            [("north", TRUTH, 0), ("east", SETPOINT, 1), ("down", ESTIMATE, 2)]
                .map(|(name, colour, axis)| {
                    let at = |row: &PendulumRow| pick(row).get(axis).copied().unwrap_or(0.0);
                    Line::new(name, colour, series(trace, at))
                })
                .to_vec()
        };
        cells.push((
            Panel::new("Error of the rod's rate, stochastic (Fig. 3)", "time, s", "rad/s"),
            lines(|r| r.estimated_rod_rate - r.truth.rod_rate),
        ));
        cells.push((
            Panel::new("Error of the load's velocity, stochastic (Fig. 3)", "time, s", "m/s"),
            lines(|r| r.estimated_velocity - r.truth.velocity),
        ));
        cells.push((
            Panel::new("Disturbance, stochastic (Fig. 4)", "time, s", "N"),
            lines(|r| r.disturbance),
        ));
        cells.push((
            Panel::new("Estimated disturbance, stochastic (Fig. 4)", "time, s", "N"),
            lines(|r| r.estimated_disturbance),
        ));
    }
    let path = |pick: fn(&PendulumRow) -> nalgebra::Vector3<f64>, trace: &PendulumTrace| {
        trace.rows.iter().map(|row| pick(row).into()).collect::<Vec<[f64; 3]>>()
    };
    for ((name, _, trace), colour) in flown.iter().zip([TRUTH, THIRD, ESTIMATE]) {
        paths.push(Curve::new(*name, colour, path(|r| r.truth.position, trace)));
    }
    if let Some((_, _, trace)) = flown.first() {
        let mut reference = path(|r| r.reference, trace);
        // One round.
        reference.truncate(5000);
        paths.push(Curve::new("reference", SETPOINT, reference));
    }
    report.picture("pendulum-simulation.svg", move |path| grid(path, 2, &cells));
    report.picture("pendulum-paths.svg", move |path| {
        curves(path, "Load along its reference (Fig. 1)", &paths)
    });
}
