//! Lupashin and D'Andrea's figures: sensitivity of one reading, poles, the loop in a plane and in space.

use super::{Ask, Compare, Report};
use crate::parallel;
use crate::report::chart::{ESTIMATE, Line, Panel, Points, SETPOINT, THIRD, TRUTH};
use crate::report::grid::{self, grid};
use crate::tether_angle::{
    AnchorMotion, AngleRow, AngleScenario, AngleTrace, Sensitivity, Setting, SpatialTrace, fly,
    fly_spatial, linearise, sensitivity,
};
use plotters::prelude::SeriesLabelPosition;
use plotters::style::RGBColor;

/// Draws of each point of the sensitivity figures.
const SAMPLES: u32 = 50_000;
/// Tether angle; valid share; bias and deviation of the tether angle, then of the tilt, deg:
/// `inertial` section 3.
const TABLE: [(f64, f64, [f64; 4]); 8] = [
    (0.0, 0.61, [0.1, 11.3, 0.1, 7.6]),
    (5.0, 0.66, [3.3, 8.7, 2.5, 6.2]),
    (10.0, 0.79, [2.8, 6.0, 1.9, 4.9]),
    (20.0, 0.98, [0.4, 5.8, 0.2, 3.6]),
    (30.0, 1.0, [0.14, 5.27, 0.10, 2.44]),
    (45.0, 1.0, [0.12, 4.32, 0.10, 1.67]),
    (60.0, 1.0, [0.09, 3.46, 0.07, 1.35]),
    (90.0, 1.0, [0.05, 2.01, 0.04, 1.17]),
];
/// From here on the specification judges, deg.
const JUDGED: f64 = 20.0;

const NOISY: Setting =
    Setting { angle: 0.0, thrust: [12.0, 12.0], noise: 0.2, length: 3.0, rate: 0.0 };

fn draw_all(settings: &[Setting], seed: u64) -> Result<Vec<Sensitivity>, String> {
    let work = |s: &Setting| sensitivity(s, SAMPLES, seed);
    parallel::map(settings, parallel::cores(), work, |_| {}).into_iter().collect()
}

fn over_angle(base: Setting) -> Vec<Setting> {
    (0..=90).step_by(3).map(|deg| Setting { angle: f64::from(deg).to_radians(), ..base }).collect()
}

/// Figs. 3 to 5 and the specification's Monte-Carlo table.
pub fn sensitivities(ask: &Ask) -> Result<Report, String> {
    let mut report = Report::default();
    monte_carlo(&mut report, ask.seed)?;
    let seed = ask.seed;
    let at = |deg: f64, s: Setting| -> Result<Sensitivity, String> {
        sensitivity(&Setting { angle: deg.to_radians(), noise: 0.0, ..s }, 1, seed)
    };
    let weak = Setting { thrust: [11.5, 12.0], ..NOISY };
    let strong = Setting { thrust: [12.0, 11.5], ..NOISY };
    let mismatch = [
        (10.0, -1.9, 2.4),
        (20.0, -3.7, 4.4),
        (30.0, -5.2, 5.8),
        (45.0, -6.5, 6.7),
        (60.0, -6.6, 6.3),
        (90.0, -3.9, 3.5),
    ];
    for (deg, low, high) in mismatch {
        for (name, s, value) in [("11.5 for 12", weak, low), ("12 for 11.5", strong, high)] {
            let bias = at(deg, s)?.angle[0].to_degrees();
            report.add(
                format!("thrust {name} m/s², {deg} deg: bias of the tether angle, deg"),
                bias,
                Compare::Near { value, share: 0.03, slack: 0.06 },
            );
        }
    }
    for (length, rate, values) in [
        (3.0, 0.2, [3.5, 2.0, 1.4, 0.8, 0.7]),
        (3.0, 0.5, [14.7, 10.3, 7.9, 4.9, 4.4]),
        (3.0, 1.0, [37.0, 31.0, 26.0, 19.0, 18.0]),
        (1.0, 0.5, [6.4, 3.9, 2.8, 1.7, 1.5]),
    ] {
        for (deg, value) in [10.0, 20.0, 30.0, 60.0, 90.0].into_iter().zip(values) {
            let bias = at(deg, Setting { length, rate, ..NOISY })?.angle[0].to_degrees();
            report.add(
                format!("centripetal, {length} m, {rate} rad/s, {deg} deg: bias, deg"),
                bias,
                Compare::Near { value, share: 0.03, slack: 0.06 },
            );
        }
    }
    let none = at(0.0, weak)?;
    report.add(
        "thrust 11.5 for 12 m/s², 0 deg: readings that give an answer, noise-free, 1",
        none.valid,
        Compare::Refuted("no usable observation near 0 deg with a thrust mismatch"),
    );
    pictures(&mut report, ask.seed)?;
    report.notes.push(
        "The article leaves the tension at its nominal value when the thrust is wrong; recomputed, the \
         mismatch cancels exactly at 0 deg."
            .into(),
    );
    Ok(report)
}

/// `inertial` section 3: the table and its limits.
pub fn monte_carlo(report: &mut Report, seed: u64) -> Result<(), String> {
    let settings = TABLE.map(|(deg, ..)| Setting { angle: deg.to_radians(), ..NOISY });
    let found = draw_all(&settings, seed)?;
    for ((deg, valid, table), ours) in TABLE.iter().zip(found) {
        let judge = |value: f64, share: f64, slack: f64| {
            if *deg >= JUDGED { Compare::Near { value, share, slack } } else { Compare::Alone }
        };
        report.add(
            format!("one reading, {deg} deg: valid, 1"),
            ours.valid,
            Compare::Near { value: *valid, share: 0.0, slack: 0.01 },
        );
        let figures = [ours.angle[0], ours.angle[1], ours.tilt[0], ours.tilt[1]];
        let names = [
            "bias of the angle",
            "deviation of the angle",
            "bias of the tilt",
            "deviation of the tilt",
        ];
        for ((name, ours), value) in names.iter().zip(figures).zip(table) {
            report.add(
                format!("one reading, {deg} deg: {name}, deg"),
                ours.to_degrees(),
                judge(*value, 0.06, 0.08),
            );
        }
    }
    Ok(())
}

fn pictures(report: &mut Report, seed: u64) -> Result<(), String> {
    let curve = |base: Setting, pick: fn(&Sensitivity) -> f64| -> Result<Points, String> {
        let settings = over_angle(base);
        let found = draw_all(&settings, seed)?;
        let rows = settings.iter().zip(&found);
        Ok(rows.map(|(s, f)| (s.angle.to_degrees(), pick(f).to_degrees())).collect())
    };
    let four = |title: &'static str, base: Setting| -> Result<_, String> {
        Ok((
            Panel::new(title, "tether angle, deg", "deg"),
            vec![
                Line::new("deviation, tether", SETPOINT, curve(base, |s| s.angle[1])?),
                Line::new("deviation, tilt", ESTIMATE, curve(base, |s| s.tilt[1])?),
                Line::new("bias, tether", TRUTH, curve(base, |s| s.angle[0])?),
                Line::new("bias, tilt", THIRD, curve(base, |s| s.tilt[0])?),
            ],
        ))
    };
    let mut centripetal = Vec::new();
    for (length, rate, colour) in
        [(3.0, 0.2, THIRD), (3.0, 0.5, SETPOINT), (3.0, 1.0, ESTIMATE), (1.0, 0.5, TRUTH)]
    {
        let base = Setting { length, rate, noise: 0.0, ..NOISY };
        let name = format!("{length} m, {rate} rad/s");
        centripetal.push(Line::new(name, colour, curve(base, |s| s.angle[0])?));
    }
    let cells = vec![
        four("Noise of 0.2 m/s² (Fig. 3)", NOISY)?,
        four("and thrust 11.5 for 12 m/s² (Fig. 4)", Setting { thrust: [11.5, 12.0], ..NOISY })?,
        four("and thrust 12 for 11.5 m/s²", Setting { thrust: [12.0, 11.5], ..NOISY })?,
        (Panel::new("Bias by neglected rate (Fig. 5)", "tether angle, deg", "deg"), centripetal),
    ];
    report.picture("sensitivity.svg", move |path| grid(path, 2, &cells));
    Ok(())
}

/// Real and imaginary parts, `inertial` section 6.
type Pole = (f64, f64);
const POLES: [(f64, f64, [Pole; 3]); 4] = [
    (10.0, 0.18, [(-28.52, 70.77), (-3.58, 0.0), (-1.09, 1.84)]),
    (50.0, 0.18, [(-28.52, 70.77), (-3.47, 0.0), (-1.15, 1.84)]),
    (90.0, 0.18, [(-28.52, 70.77), (-2.85, 0.0), (-1.46, 1.90)]),
    (10.0, 0.16, [(-28.13, 70.64), (-4.29, 0.0), (-1.12, 1.75)]),
];

/// Fig. 8.
pub fn poles(ask: &Ask) -> Result<Report, String> {
    let mut report = Report::default();
    add_poles(&mut report, ask)?;
    let base = ask.on(AngleScenario::default())?;
    let mut cells = Vec::new();
    for (tilt_time, title) in [(0.18, "0.18 s, as Fig. 8"), (0.16, "0.16 s, as the text")] {
        let s = AngleScenario { tilt_time, ..base.clone() };
        let mut lines: Vec<Line> = Vec::new();
        for (i, colour) in [(0, ESTIMATE), (2, SETPOINT), (3, TRUTH)] {
            let way = (0..=90).map(|deg| {
                let pole = linearise(&s, f64::from(deg).to_radians(), None).poles;
                pole.get(i).map_or((f64::NAN, 0.0), |p| (f64::from(deg), p.re))
            });
            let name = ["fast pair", "", "tilt", "tether pair"].get(i).copied().unwrap_or("");
            lines.push(Line::new(name, colour, way.collect()));
        }
        cells.push((
            Panel::new(format!("Tilt time {title}"), "tether angle, deg", "real part, 1/s")
                .legend(SeriesLabelPosition::MiddleRight),
            lines,
        ));
    }
    report.picture("poles.svg", move |path| grid(path, 2, &cells));
    Ok(report)
}

/// The poles beside the specification's.
pub fn add_poles(report: &mut Report, ask: &Ask) -> Result<(), String> {
    let base = ask.on(AngleScenario::default())?;
    for (deg, tilt_time, expected) in POLES {
        let s = AngleScenario { tilt_time, ..base.clone() };
        let found = linearise(&s, deg.to_radians(), None).poles;
        for (re, im) in expected {
            let off = |p: &&nalgebra::Complex<f64>| (p.re - re).hypot(p.im - im);
            let Some(p) = found.iter().min_by(|a, b| off(a).total_cmp(&off(b))) else { continue };
            let at = format!("poles, {deg} deg, tilt time {tilt_time} s, at {re}");
            let near = |value| Compare::Near { value, share: 0.0, slack: 0.0051 };
            report.add(format!("{at}: real part, 1/s"), p.re, near(re));
            report.add(format!("{at}: imaginary part, 1/s"), p.im, near(im));
        }
    }
    let stable = (0..=90).all(|deg| {
        linearise(&base, f64::from(deg).to_radians(), None).poles.iter().all(|p| p.re < 0.0)
    });
    report.add(
        "poles, 0 to 90 deg: all stable, 1",
        f64::from(u8::from(stable)),
        Compare::Claim("stable for all configurations", stable),
    );
    Ok(())
}

fn runs(s: &AngleScenario, seeds: &[u64]) -> Result<Vec<AngleTrace>, String> {
    let work = |seed: &u64| fly(s, *seed);
    parallel::map(seeds, parallel::cores(), work, |_| {}).into_iter().collect()
}

fn worst(traces: &[AngleTrace], pick: impl Fn(&AngleTrace) -> f64) -> f64 {
    traces.iter().map(pick).fold(0.0, |worst, x| if x <= worst { worst } else { x })
}

/// `inertial` section 7: limits over five seeds.
pub fn add_loop(report: &mut Report, ask: &Ask) -> Result<Vec<AngleTrace>, String> {
    let traces = runs(&ask.on(AngleScenario::default())?, &ask.seeds(5)?)?;
    let deg = |x: f64| x.to_degrees();
    let mut limit = |name: &str, ours: f64, most: f64| {
        report.add(format!("loop, worst of {}: {name}", traces.len()), ours, Compare::AtMost(most));
    };
    limit("lost, 1", traces.iter().filter(|t| t.summary.is_lost).count() as f64, 0.0);
    limit("tether angle estimate rms, deg", deg(worst(&traces, |t| t.summary.angle)), 2.8);
    limit("tilt estimate rms, deg", deg(worst(&traces, |t| t.summary.tilt)), 0.8);
    limit("tracking rms, deg", deg(worst(&traces, |t| t.summary.tracking)), 7.5);
    Ok(traces)
}

fn series(trace: &AngleTrace, pick: impl Fn(&AngleRow) -> f64) -> Points {
    trace.rows.iter().map(|row| (row.time, pick(row).to_degrees())).collect()
}

fn angles(title: &'static str, trace: &AngleTrace) -> grid::Cell {
    let line = |name: &'static str, colour: RGBColor, pick: fn(&AngleRow) -> f64| {
        Line::new(name, colour, series(trace, pick))
    };
    (
        Panel::new(title, "time, s", "deg").legend(SeriesLabelPosition::UpperLeft),
        vec![
            line("reference", SETPOINT, |r| r.reference).dashed(),
            line("tether", TRUTH, |r| r.truth.angle),
            line("tether, estimated", ESTIMATE, |r| r.estimate.angle),
            line("tilt, estimated", THIRD, |r| r.estimate.tilt),
        ],
    )
}

/// Figs. 9 to 11 and the rows of `inertial` section 7.
pub fn planar_loop(ask: &Ask) -> Result<Report, String> {
    let mut report = Report::default();
    let traces = add_loop(&mut report, ask)?;
    let base = ask.on(AngleScenario::default())?;
    let seeds = ask.seeds(5)?;
    let still = vec![30.0; 6];
    let walk = AnchorMotion { amplitude: 0.5, period: 6.0 };
    let at = |reference: &[f64]| AngleScenario {
        start: reference.iter().take(1).copied().collect(),
        reference: reference.to_vec(),
        ..base.clone()
    };
    let moving = AngleScenario { anchor: walk, ..at(&still) };
    let free = AngleScenario { tension_min: 0.0, ..at(&[30.0, 60.0, 20.0, 60.0, 20.0, 30.0]) };
    let guarded = AngleScenario { tension_min: base.tension_min, ..free.clone() };
    let cases: [(&str, AngleScenario, Option<[f64; 2]>); 9] = [
        (
            "thrust 11.5 for 12 m/s²",
            AngleScenario { thrust_true: 11.5, ..base.clone() },
            Some([6.8, 9.1]),
        ),
        (
            "thrust 12.5 for 12 m/s²",
            AngleScenario { thrust_true: 12.5, ..base.clone() },
            Some([9.0, 14.5]),
        ),
        (
            "gyro bias 0.02 rad/s",
            AngleScenario { gyro_bias: 0.02, ..base.clone() },
            Some([2.5, 8.2]),
        ),
        ("at 10 deg", at(&[10.0; 4]), Some([2.7, 4.4])),
        ("60 to 80 deg", at(&[60.0, 80.0, 80.0, 80.0]), Some([1.0, 4.1])),
        ("moving anchor", moving.clone(), Some([2.75, 7.6])),
        ("steps of 30 to 40 deg, guard", guarded, Some([2.2, 14.0])),
        ("steps of 30 to 40 deg, no guard", free, None),
        (
            "attachment 3 cm below, compensated",
            AngleScenario { attachment: 0.03, compensates: true, ..base.clone() },
            Some([1.8, 5.8]),
        ),
    ];
    let mut walked = None;
    for (name, s, reference) in cases {
        let flown = runs(&s, &seeds)?;
        let mean = |pick: fn(&AngleTrace) -> f64| {
            flown.iter().map(pick).sum::<f64>().to_degrees() / flown.len() as f64
        };
        let near = |i: usize| {
            reference.map_or(Compare::Alone, |r| {
                let value = r.get(i).copied().unwrap_or(0.0);
                Compare::Near { value, share: 0.35, slack: 0.8 }
            })
        };
        let lost = flown.iter().filter(|t| t.summary.is_lost).count();
        report.add(format!("{name}: lost, 1"), lost as f64, Compare::Alone);
        report.add(format!("{name}: estimate rms, deg"), mean(|t| t.summary.angle), near(0));
        report.add(format!("{name}: tracking rms, deg"), mean(|t| t.summary.tracking), near(1));
        if name == "moving anchor" {
            walked = flown.into_iter().next();
        }
    }
    let literal = runs(&AngleScenario { sigma: 0.4, ..base.clone() }, &seeds)?;
    report.add(
        "process noise 0.4 rad/s² as printed: lost, 1",
        literal.iter().filter(|t| t.summary.is_lost).count() as f64,
        Compare::Refuted("a process noise of 0.4 rad/s²"),
    );
    report.notes.push(
        "References are the middle of the specification's ranges; with 0.4 times the period, 0.005, the \
         filter is sound."
            .into(),
    );
    let mut cells = Vec::new();
    if let Some(trace) = traces.first() {
        cells.push(minimal(trace, &base, ask.seed)?);
        cells.push(angles("Steps in the tether angle (Fig. 10)", trace));
    }
    if let Some(trace) = &walked {
        cells.push(angles("Anchor moved 0.5 m in 6 s (Fig. 11)", trace));
        let tension = trace.rows.iter().map(|r| (r.time, r.tension)).collect();
        cells.push((
            Panel::new("its tension over mass", "time, s", "m/s²"),
            vec![Line::new("", TRUTH, tension)],
        ));
    }
    report.picture("tether-loop.svg", move |path| grid(path, 2, &cells));
    Ok(report)
}

/// One reading after the other, beside the truth: Fig. 9.
fn minimal(trace: &AngleTrace, s: &AngleScenario, seed: u64) -> Result<grid::Cell, String> {
    let mut points = [Points::new(), Points::new()];
    let mut rng = seed.wrapping_mul(7);
    for row in trace.rows.iter().step_by(4) {
        rng += 1;
        let at = Setting {
            angle: row.truth.angle,
            thrust: [s.thrust_true, s.thrust],
            noise: 0.2,
            length: s.length,
            rate: 0.0,
        };
        let one = sensitivity(&at, 1, rng)?;
        if one.valid > 0.5 {
            let [angle, tilt] = &mut points;
            angle.push((row.time, (row.truth.angle + one.angle[0]).to_degrees()));
            tilt.push((row.time, (row.truth.tilt + one.tilt[0]).to_degrees()));
        }
    }
    let [angle, tilt] = points;
    Ok((
        Panel::new("Each reading alone (Fig. 9)", "time, s", "deg")
            .legend(SeriesLabelPosition::UpperLeft),
        vec![
            Line::new("tether by one reading", ESTIMATE, angle),
            Line::new("tilt by one reading", THIRD, tilt),
            Line::new("tether", TRUTH, series(trace, |r| r.truth.angle)),
            Line::new("tilt", SETPOINT, series(trace, |r| r.truth.tilt)),
        ],
    ))
}

/// Directions of `inertial` section 8, deg.
const DIRECTIONS: [[f64; 2]; 4] = [[25.0, 15.0], [30.0, 30.0], [30.0, 0.0], [35.0, 35.0]];

/// Of all directions and seeds: lost, and flown within these estimate and tracking errors, deg.
fn survivors(
    ask: &Ask,
    seeds: &[u64],
    base: &AngleScenario,
    [estimate, tracking]: [f64; 2],
) -> Result<[f64; 2], String> {
    let count = (seeds.len() * DIRECTIONS.len()) as f64;
    let (mut lost, mut good) = (0.0, 0.0);
    for [x, y] in DIRECTIONS {
        let AngleScenario { reference, start, .. } = AngleScenario::spatial(x, y);
        let s = ask.on(AngleScenario { reference, start, ..base.clone() })?;
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
pub fn add_space(report: &mut Report, ask: &Ask) -> Result<(), String> {
    let seeds = ask.seeds(10)?;
    let count = seeds.len() * DIRECTIONS.len();
    let base = AngleScenario::spatial(0.0, 0.0);
    for (name, thrust, limits) in
        [("default", 12.0, [5.0, 7.0]), ("thrust 14 m/s²", 14.0, [3.5, 5.0])]
    {
        let s = AngleScenario { thrust, thrust_true: thrust, ..base.clone() };
        let [lost, good] = survivors(ask, &seeds, &s, limits)?;
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
pub fn space(ask: &Ask) -> Result<Report, String> {
    let mut report = Report::default();
    add_space(&mut report, ask)?;
    let seeds = ask.seeds(10)?;
    let known = AngleScenario { start_known: 3.0, ..AngleScenario::spatial(0.0, 0.0) };
    let [lost, good] = survivors(ask, &seeds, &known, [5.0, 7.0])?;
    report.add("in space, started known to 3 deg: share lost, 1", lost, Compare::Alone);
    report.add(
        "in space, started known to 3 deg: share flown within 5 and 7 deg, 1",
        good,
        Compare::Alone,
    );
    let moving = ask.on(AngleScenario {
        duration: 30.0,
        anchor: AnchorMotion { amplitude: 0.5, period: 8.0 },
        anchor_y: AnchorMotion { amplitude: 0.3, period: 10.0 },
        ..AngleScenario::spatial(25.0, 20.0)
    })?;
    let weak = ask.on(AngleScenario { thrust_true: 11.5, ..AngleScenario::spatial(25.0, 20.0) })?;
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
    let near = |value, slack| Compare::Near { value, share: 0.3, slack };
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
    let bias = median(&ask.on(AngleScenario::spatial(25.0, 15.0))?, |t| t.bias[0])?;
    report.add(
        "25, 15 deg: bias, deg",
        bias,
        Compare::Refuted("a significant bias of the tether angle in 3-D"),
    );
    report.notes.push(
        "The article's bias in 3-D does not appear with a right thrust; 4 % of thrust error gives 5 deg. \
         What is lost is lost at the start: near zero a single reading says little of the angle."
            .into(),
    );
    let trace = fly_spatial(&moving, ask.seed)?;
    let line = |name: &'static str, colour, pick: fn(&crate::tether_angle::SpatialRow) -> f64| {
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
