//! `planar` section 11: every row beside its limits.

use super::{Compare, Overrides, Report, scan};
use crate::bench::planar::{BranchChoice, PlanarScenario, Residual};

/// One row; what has no limit is not scored.
struct Row {
    name: &'static str,
    unit: &'static str,
    scenario: PlanarScenario,
    max: [Option<f64>; 2],
    last: [f64; 2],
    estimate: Option<f64>,
    converged_by: Option<f64>,
    peak_force: Option<f64>,
}

fn row(name: &'static str, unit: &'static str, scenario: PlanarScenario) -> Row {
    Row {
        name,
        unit,
        scenario,
        max: [None; 2],
        last: [0.0; 2],
        estimate: None,
        converged_by: None,
        peak_force: None,
    }
}

fn at_rate(base: &PlanarScenario, rate_hz: f64) -> PlanarScenario {
    PlanarScenario { rate_hz, substeps: (2000.0 / rate_hz).ceil() as u32 * 2, ..base.clone() }
}

fn displaced(mut s: PlanarScenario) -> PlanarScenario {
    s.start.state_offset = [-0.15, 0.2, 0.1, 0.3];
    s.start.observer_offset = [0.5, 0.5, 2.0];
    s.start.hold_off = 0.4;
    s
}

fn rows() -> Vec<Row> {
    let force = PlanarScenario::default();
    let attitude = PlanarScenario::journal_attitude();
    let conference = PlanarScenario::conference();
    let mut rows = Vec::new();
    // Rate, then limits: largest errors, errors of the last half second, estimate. Between the two
    // limits that the table gives for the last half second, the middle rate has their mean.
    let mut add = |name, unit, base: &PlanarScenario, rate, max: [f64; 2], last, estimate| {
        rows.push(Row {
            max: max.map(Some),
            last,
            estimate: Some(estimate),
            ..row(name, unit, at_rate(base, rate))
        });
    };
    add("Γb T5 1000 Hz", "N", &force, 1000.0, [1.5e-4, 5e-3], [1e-5, 1e-5], 2e-5);
    add("Γb T5 500 Hz", "N", &force, 500.0, [3e-4, 1e-2], [2e-5, 3e-5], 3e-5);
    add("Γb T5 250 Hz", "N", &force, 250.0, [6e-4, 2e-2], [3e-5, 5e-5], 6e-5);
    let mut fast = force.clone();
    fast.reference.duration = 3.0;
    add("Γb T3 1000 Hz", "N", &fast, 1000.0, [1.2e-3, 4e-2], [6e-5, 2e-4], 1e-4);
    add("Γa' T5 1000 Hz", "rad", &attitude, 1000.0, [2.5e-4, 1e-4], [2e-5, 1e-5], 3e-6);
    add("Γa' T5 500 Hz", "rad", &attitude, 500.0, [5e-4, 2e-4], [4e-5, 2.5e-5], 6e-6);
    add("Γa' T5 250 Hz", "rad", &attitude, 250.0, [1e-3, 4e-4], [6e-5, 4e-5], 1e-5);
    add("compression 1000 Hz", "N", &conference, 1000.0, [5e-4, 0.04], [1e-6, 1e-7], 5e-4);
    add("compression 500 Hz", "N", &conference, 500.0, [9e-4, 0.08], [1.5e-6, 1e-7], 9e-4);
    add("compression 250 Hz", "N", &conference, 250.0, [1.8e-3, 0.17], [2e-6, 1e-7], 1.8e-3);

    rows.push(Row {
        last: [5e-5, 1e-4],
        converged_by: Some(0.6),
        peak_force: Some(8.0),
        ..row("Γb displaced start", "N", displaced(force.clone()))
    });
    rows.push(Row {
        max: [Some(0.2), Some(0.3)],
        last: [1e-6, 1e-7],
        converged_by: Some(0.6),
        ..row("compression displaced start", "N", displaced(conference.clone()))
    });
    rows.push(Row {
        max: [Some(0.4), Some(0.7)],
        last: [3e-3, 3e-3],
        converged_by: Some(0.8),
        ..row("Γa' displaced start", "rad", displaced(attitude))
    });
    let mut wrong = force.clone();
    wrong.observer.branches = BranchChoice::BothFromSecond;
    wrong.observer.residual = Residual::UnitVector;
    wrong.observer.is_above_ground = false;
    rows.push(Row {
        max: [Some(0.4), Some(1.0)],
        last: [2e-5, 2e-5],
        converged_by: Some(0.5),
        ..row("Γb wrong branch at start", "N", wrong)
    });
    let mut heavy = force.clone();
    heavy.observer.branches = BranchChoice::One;
    heavy.model_error.mass = 0.1;
    heavy.reference.second = [10.0, 12.0];
    rows.push(Row {
        max: [Some(0.2), Some(1.5)],
        last: [0.09, 1.1],
        ..row("Γb mass +10 %, 10 to 12 N", "N", heavy)
    });
    let mut lagged = force;
    lagged.observer.branches = BranchChoice::One;
    lagged.plant.motor_lag = 0.08;
    rows.push(Row {
        max: [Some(0.05), Some(0.8)],
        last: [1e-3, 5e-3],
        ..row("Γb motors 80 ms", "N", lagged)
    });
    let mut modelled = conference;
    modelled.observer.branches = BranchChoice::One;
    modelled.plant.motor_lag = 0.05;
    modelled.observer.motor_lag = 0.05;
    rows.push(Row {
        max: [Some(0.1), Some(4.0)],
        last: [2e-4, 5e-5],
        ..row("compression motors 50 ms, observer told", "N", modelled)
    });
    rows
}

/// Flies all rows.
pub fn run(settings: &Overrides) -> Result<Report, String> {
    let rows = rows();
    let flown = scan::summaries(settings, rows.iter().map(|r| r.scenario.clone()).collect())?;
    let mut report = Report::default();
    for (row, s) in rows.iter().zip(flown) {
        let Row { name, unit, .. } = row;
        let seconds = [("elevation", "rad"), ("second", *unit)];
        for ((what, unit), (ours, limit)) in
            seconds.into_iter().zip(s.max_after_1s.into_iter().zip(row.max))
        {
            if let Some(limit) = limit {
                report.add(
                    format!("{name}: max {what} error after 1 s, {unit}"),
                    ours,
                    Compare::AtMost(limit),
                );
            }
        }
        for ((what, unit), (ours, limit)) in
            seconds.into_iter().zip(s.max_last.into_iter().zip(row.last))
        {
            report.add(
                format!("{name}: last 0.5 s {what} error, {unit}"),
                ours,
                Compare::AtMost(limit),
            );
        }
        if let Some(limit) = row.estimate {
            report.add(
                format!("{name}: max estimate error, rad"),
                s.estimate_max_after_1s,
                Compare::AtMost(limit),
            );
        }
        if let Some(limit) = row.converged_by {
            report.add(format!("{name}: converged, s"), s.converged_at, Compare::AtMost(limit));
        }
        if let Some(limit) = row.peak_force {
            report.add(
                format!("{name}: peak link force, N"),
                s.link_force[1],
                Compare::AtMost(limit),
            );
        }
    }
    Ok(report)
}
