//! Two planes in space: Fig. 12, and who survives.

use crate::bench::tether_angle::{AnchorMotion, AngleScenario, SpatialTrace, fly_spatial};
use crate::campaign::parallel;
use crate::experiment::{Band, Compare, Overrides, Report, Source};
use crate::report::chart::{ESTIMATE, Line, Panel, TRUTH};
use crate::report::grid::grid;

/// Directions of `inertial` section 8, deg.
const DIRECTIONS: [[f64; 2]; 4] = [[25.0, 15.0], [30.0, 30.0], [30.0, 0.0], [35.0, 35.0]];

/// Of all directions and seeds: lost, and flown within these estimate and tracking errors, deg.
fn survivors(
    settings: &Overrides,
    seeds: &[u64],
    base: &AngleScenario,
    [estimate, tracking]: [f64; 2],
) -> Result<[f64; 2], String> {
    let count = (seeds.len() * DIRECTIONS.len()) as f64;
    let (mut lost, mut good) = (0.0, 0.0);
    for [x, y] in DIRECTIONS {
        let AngleScenario { reference, start, .. } = AngleScenario::spatial(x, y);
        let s = settings.on(AngleScenario { reference, start, ..base.clone() })?;
        let work = |seed: &u64| fly_spatial(&s, *seed);
        for trace in parallel::map(seeds, parallel::cores(), work, |_| {}) {
            let trace = trace?;
            let within =
                |figure: [f64; 2], most: f64| SpatialTrace::worse(figure).to_degrees() <= most;
            if trace.is_lost {
                lost += 1.0;
            } else if within(trace.estimate, estimate) && within(trace.tracking, tracking) {
                good += 1.0;
            }
        }
    }
    Ok([lost / count, good / count])
}

/// `inertial` section 8: survival over ten seeds.
pub fn add_space(report: &mut Report, settings: &Overrides) -> Result<(), String> {
    let seeds = settings.seeds(10)?;
    let count = seeds.len() * DIRECTIONS.len();
    let base = AngleScenario::spatial(0.0, 0.0);
    for (name, thrust, limits) in
        [("default", 12.0, [5.0, 7.0]), ("thrust 14 m/s²", 14.0, [3.5, 5.0])]
    {
        let s = AngleScenario { thrust, thrust_true: thrust, ..base.clone() };
        let [lost, good] = survivors(settings, &seeds, &s, limits)?;
        let [estimate, tracking] = limits;
        report.add(format!("in space, {name}: share lost of {count}, 1"), lost, Compare::Alone);
        report.add(
            format!("in space, {name}: share flown within {estimate} and {tracking} deg, 1"),
            good,
            Compare::Claim("at least 0.8 by the specification", good >= 0.8),
        );
    }
    Ok(())
}

/// Fig. 12.
pub fn space(settings: &Overrides) -> Result<Report, String> {
    let mut report = Report::default();
    add_space(&mut report, settings)?;
    let seeds = settings.seeds(10)?;
    let known = AngleScenario { start_known: 3.0, ..AngleScenario::spatial(0.0, 0.0) };
    let [lost, good] = survivors(settings, &seeds, &known, [5.0, 7.0])?;
    report.add("in space, started known to 3 deg: share lost, 1", lost, Compare::Alone);
    report.add(
        "in space, started known to 3 deg: share flown within 5 and 7 deg, 1",
        good,
        Compare::Alone,
    );
    let moving = settings.on(AngleScenario {
        duration: 30.0,
        anchor: AnchorMotion { amplitude: 0.5, period: 8.0 },
        anchor_y: AnchorMotion { amplitude: 0.3, period: 10.0 },
        ..AngleScenario::spatial(25.0, 20.0)
    })?;
    let weak =
        settings.on(AngleScenario { thrust_true: 11.5, ..AngleScenario::spatial(25.0, 20.0) })?;
    let median = |s: &AngleScenario, pick: fn(&SpatialTrace) -> f64| -> Result<f64, String> {
        let work = |seed: &u64| fly_spatial(s, *seed);
        let flown = parallel::map(&seeds, parallel::cores(), work, |_| {});
        let mut all = Vec::new();
        for trace in flown {
            let trace = trace?;
            if !trace.is_lost {
                all.push(pick(&trace).to_degrees());
            }
        }
        all.sort_by(f64::total_cmp);
        Ok(all.get(all.len() / 2).copied().unwrap_or(f64::NAN))
    };
    let near =
        |value, slack| Compare::Near { from: Source::Specification, value, share: 0.3, slack };
    report.add(
        "moving anchor: estimate rms, deg",
        median(&moving, |t| SpatialTrace::worse(t.estimate))?,
        near(2.7, 0.7),
    );
    report.add(
        "moving anchor: tracking rms, deg",
        median(&moving, |t| SpatialTrace::worse(t.tracking))?,
        near(8.8, 1.0),
    );
    report.add(
        "thrust 11.5 for 12 m/s²: bias, deg",
        median(&weak, |t| t.bias[0])?,
        near(-4.9, 0.7),
    );
    let bias = median(&settings.on(AngleScenario::spatial(25.0, 15.0))?, |t| t.bias[0])?;
    report.add(
        "25, 15 deg: bias, deg",
        bias,
        // A median over seeds, 0.014 at most on six first seeds; the article's picture shows several degrees.
        Compare::Refuted {
            claim: "a significant bias of the tether angle in 3-D",
            ours: Band::new(-0.3, 0.3),
        },
    );
    report.notes.push(
        "The article's bias in 3-D does not appear with a right thrust; 4 % of thrust error gives 5 deg. \
         What is lost is lost at the start: near zero a single reading says little of the angle."
            .into(),
    );
    let trace = fly_spatial(&moving, settings.seed)?;
    let line = |name: &'static str,
                colour,
                pick: fn(&crate::bench::tether_angle::SpatialRow) -> f64| {
        Line::new(name, colour, trace.rows.iter().map(|r| (r.time, pick(r).to_degrees())).collect())
    };
    let cells = vec![
        (
            Panel::new("Anchor moves in two axes: angle towards x (Fig. 12)", "time, s", "deg"),
            vec![
                line("true", TRUTH, |r| r.truth[0]),
                line("estimated", ESTIMATE, |r| r.estimate[0]),
            ],
        ),
        (
            Panel::new("angle towards y", "time, s", "deg"),
            vec![
                line("true", TRUTH, |r| r.truth[1]),
                line("estimated", ESTIMATE, |r| r.estimate[1]),
            ],
        ),
    ];
    report.picture("tether-space.svg", move |path| grid(path, 2, &cells));
    Ok(report)
}
