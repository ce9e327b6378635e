//! The article's experiment, Fig. 6: its masses, gains and 45 Hz.

use super::cases::{add_error, mean, traces};
use crate::bench::pendulum::{PendulumRow, PendulumScenario, PendulumTrace};
use crate::experiment::{Band, Compare, Overrides, Report, Source};
use crate::report::chart::{ESTIMATE, Line, Panel, SETPOINT, THIRD, TRUTH};
use crate::report::grid::grid;
use crate::report::space::{Curve, curves};
use crate::scenario::DisturbanceKind;

/// Published mean error, cm, and mean speed, m/s.
const PUBLISHED: (f64, f64) = (9.72, 0.51);

/// Fig. 6 with what the article does not know of its vehicle: none of it, each alone, all.
pub fn hardware(settings: &Overrides) -> Result<Report, String> {
    let mut report = Report::default();
    let base = PendulumScenario::experiment;
    let plausible = PendulumScenario {
        delay: 0.02,
        lag: 0.03,
        rod_noise: 2e-3,
        velocity_noise: 0.02,
        position_noise: 1e-3,
        thrust_error: -0.05,
        drag: 0.1,
        ..base()
    };
    let near =
        |value| Compare::Near { from: Source::Specification, value, share: 0.35, slack: 0.05 };
    let stochastic = PendulumScenario { disturbance: DisturbanceKind::Stochastic, ..base() };
    let rows = [
        ("ideal", base(), near(0.016)),
        ("stochastic disturbance", stochastic, near(5.0)),
        ("thrust 5 % weak", PendulumScenario { thrust_error: -0.05, ..base() }, Compare::Alone),
        ("thrust 8 % weak", PendulumScenario { thrust_error: -0.08, ..base() }, Compare::Alone),
        ("late, noisy, thrust 5 % weak, drag", plausible.clone(), near(6.0)),
        (
            "the same, thrust 8 % weak",
            PendulumScenario { thrust_error: -0.08, ..plausible.clone() },
            // 10.01 to 10.04 on six seeds: what is random averages out over a circle.
            Compare::Explained {
                from: Source::Paper,
                value: PUBLISHED.0,
                why: "published; its vehicle is not known",
                ours: Band::around(10.03, 0.05),
            },
        ),
    ];
    let mut picture = None;
    for (name, s, compare) in rows {
        let settled = settings.on(s.clone())?.settled;
        let flown = traces(settings, s, 6)?;
        let figures: Vec<_> = flown.iter().map(|t| t.summary.clone()).collect();
        add_error(&mut report, name, &figures, compare);
        let lost = figures.iter().filter(|s| s.is_lost()).count();
        report.add(format!("{name}: lost of {}, 1", figures.len()), lost as f64, Compare::Alone);
        let speed = flown.first().map_or(f64::NAN, |t| speed(t, settled));
        report.add(
            format!("{name}: mean speed of the load, m/s"),
            speed,
            Compare::Near { from: Source::Paper, value: PUBLISHED.1, share: 0.06, slack: 0.0 },
        );
        report.add(
            format!("{name}: within 10 cm after, s"),
            mean(&figures, |s| s.within_10_cm_from),
            Compare::Alone,
        );
        picture = flown.into_iter().next();
    }
    report.notes.push(
        "Published: 9.72 cm mean, 0.51 m/s, steady after about 5 s. The article attributes its disturbance \
         estimates to a model error. A thrust map that is some per cent wrong gives errors of that size, \
         since its filter (0.00001 for the vertical disturbance) does not learn a vertical force."
            .into(),
    );
    if let Some(trace) = picture {
        draw(&mut report, trace);
    }
    Ok(report)
}

fn speed(trace: &PendulumTrace, settled: f64) -> f64 {
    let late = trace.rows.iter().filter(|row| row.time >= settled);
    let (sum, count) =
        late.fold((0.0, 0.0), |(sum, n), row| (sum + row.truth.velocity.norm(), n + 1.0));
    sum / count
}

fn draw(report: &mut Report, trace: PendulumTrace) {
    let line = |name: &'static str, colour, pick: &dyn Fn(&PendulumRow) -> f64| {
        Line::new(name, colour, trace.rows.iter().map(|row| (row.time, pick(row))).collect())
    };
    let cells = vec![
        (
            Panel::new("Speed of the load (Fig. 6)", "time, s", "m/s"),
            vec![
                line("estimated", ESTIMATE, &|r| r.estimated_velocity.norm()),
                line("true", TRUTH, &|r| r.truth.velocity.norm()),
            ],
        ),
        (
            Panel::new("Load from its reference (Fig. 6)", "time, s", "m"),
            vec![line("", TRUTH, &|r| r.error().norm())],
        ),
        (Panel::new("Thrust (Fig. 6)", "time, s", "N"), vec![line("", TRUTH, &|r| r.thrust)]),
        (
            Panel::new("Body-rate command (Fig. 6)", "time, s", "rad/s"),
            vec![line("", TRUTH, &|r| r.rate.norm())],
        ),
        (
            Panel::new("Estimated disturbance (Fig. 6)", "time, s", "N"),
            vec![
                line("north", TRUTH, &|r| r.estimated_disturbance.x),
                line("east", SETPOINT, &|r| r.estimated_disturbance.y),
                line("down", ESTIMATE, &|r| r.estimated_disturbance.z),
            ],
        ),
        (
            Panel::new("Estimated rate of the rod (Fig. 6)", "time, s", "rad/s"),
            vec![
                line("north", TRUTH, &|r| r.estimated_rod_rate.x),
                line("east", SETPOINT, &|r| r.estimated_rod_rate.y),
            ],
        ),
    ];
    report.picture("pendulum-hardware.svg", move |path| grid(path, 2, &cells));
    let path = |pick: fn(&PendulumRow) -> nalgebra::Vector3<f64>| {
        trace.rows.iter().map(|row| pick(row).into()).collect::<Vec<[f64; 3]>>()
    };
    let paths = vec![
        Curve::new("load", TRUTH, path(|r| r.truth.position)),
        Curve::new("reference", SETPOINT, path(|r| r.reference)),
        Curve::new("vehicle", THIRD, path(|r| r.truth.position - r.truth.rod)),
    ];
    report.picture("pendulum-hardware-path.svg", move |file| {
        curves(file, "The experiment's masses and gains (Fig. 6)", &paths)
    });
}
