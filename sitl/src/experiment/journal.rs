//! The journal article's section VI.

use super::pictures::{self, ScanPanel, TimeSeries};
use super::{Band, Compare, Overrides, Report, scan};
use crate::bench::planar::{BranchChoice, LawKind, PlanarScenario, PlanarSummary};

/// The article's three durations, s.
pub const DURATIONS: [f64; 3] = [7.0, 5.0, 3.0];

/// The base of the robustness runs: one observer branch, as in the tables.
pub fn single(law: LawKind, duration: f64) -> PlanarScenario {
    let mut s = match law {
        LawKind::Force => PlanarScenario::default(),
        LawKind::Attitude | LawKind::Static => PlanarScenario::journal_attitude(),
    };
    s.reference.duration = duration;
    s.observer.branches = BranchChoice::One;
    s.observer.is_above_ground = false;
    s
}

/// Name and unit of the second output.
fn second(law: LawKind) -> (&'static str, &'static str, &'static str) {
    match law {
        LawKind::Force => ("Γb", "link force", "N"),
        LawKind::Attitude | LawKind::Static => ("Γa'", "pitch", "rad"),
    }
}

/// The article shows these as lines that cannot be distinguished from the reference: rad, and N or rad.
const EXACT: [f64; 2] = [2e-3, 0.05];

/// Both controllers, three durations.
pub fn nominal(settings: &Overrides) -> Result<Report, String> {
    let mut report = Report::default();
    for law in [LawKind::Attitude, LawKind::Force] {
        let (name, what, unit) = second(law);
        let scenarios = DURATIONS.map(|t| {
            let mut s = single(law, t);
            s.observer.branches = BranchChoice::BothFromFirst;
            s.observer.is_above_ground = true;
            s
        });
        let flown = scan::traces(settings, scenarios.to_vec())?;
        for (duration, trace) in DURATIONS.iter().zip(&flown) {
            let s = &trace.summary;
            let exact = |ours: f64, bound: f64| Compare::Claim("exact tracking", ours < bound);
            report.add(
                format!("{name} T{duration}: elevation rms, rad"),
                s.rms[0],
                exact(s.rms[0], EXACT[0]),
            );
            report.add(
                format!("{name} T{duration}: elevation max after 1 s, rad"),
                s.max_after_1s[0],
                exact(s.max_after_1s[0], EXACT[0]),
            );
            report.add(
                format!("{name} T{duration}: {what} rms, {unit}"),
                s.rms[1],
                exact(s.rms[1], EXACT[1]),
            );
            report.add(
                format!("{name} T{duration}: {what} max after 1 s, {unit}"),
                s.max_after_1s[1],
                Compare::Alone,
            );
            article(&mut report, &format!("{name} T{duration}"), s);
        }
        let series = TimeSeries::new(flown, DURATIONS.map(|t| format!("{t} s")), law);
        let file = if law == LawKind::Force { "nominal-force.svg" } else { "nominal-attitude.svg" };
        report.picture(file, move |path| pictures::tracking(&series, path));
    }
    Ok(report)
}

/// The article's error, whole run and phases, beside its standard deviation.
fn article(report: &mut Report, name: &str, s: &PlanarSummary) {
    let [whole, ..] = &s.article;
    report.add(format!("{name}: article's error, mean, 1"), whole.mean(), Compare::Alone);
    report.add(format!("{name}: article's error, deviation, 1"), whole.deviation(), Compare::Alone);
}

/// VI-A.
pub fn initial_errors(settings: &Overrides) -> Result<Report, String> {
    let mut report = Report::default();
    for law in [LawKind::Attitude, LawKind::Force] {
        let (name, what, unit) = second(law);
        let mut s = single(law, 5.0);
        s.observer.branches = BranchChoice::BothFromFirst;
        s.observer.is_above_ground = true;
        s.start.state_offset = [-0.15, 0.2, 0.1, 0.3];
        s.start.observer_offset = [0.5, 0.5, 2.0];
        s.start.hold_off = 0.4;
        let mut immediate = s.clone();
        immediate.start.hold_off = 0.0;
        let flown = scan::traces(settings, vec![s, immediate])?;
        let [held_off, immediate] = flown.as_slice() else { continue };
        let p = &held_off.summary;
        report.add(
            format!("{name}: observer converged to 0.01 rad, s"),
            p.converged_at,
            Compare::Claim("less than one second", p.converged_at < 1.0),
        );
        report.add(
            format!("{name}: elevation error of the last 0.5 s, rad"),
            p.max_last[0],
            Compare::Claim("zero error in the end", p.max_last[0] < 3e-3),
        );
        report.add(
            format!("{name}: {what} error of the last 0.5 s, {unit}"),
            p.max_last[1],
            Compare::Claim("zero error in the end", p.max_last[1] < 3e-3),
        );
        report.add(format!("{name}: peak link force, N"), p.link_force[1], Compare::Alone);
        report.add(
            format!("{name}: peak link force without hold-off, N"),
            immediate.summary.link_force[1],
            Compare::Alone,
        );
        let file = if law == LawKind::Force { "initial-force.svg" } else { "initial-attitude.svg" };
        let names = ["hold-off 0.4 s".to_owned(), "no hold-off".to_owned()];
        let series = TimeSeries::new(flown, names, law);
        report.picture(file, move |path| pictures::tracking(&series, path));
    }
    Ok(report)
}

/// What is wrong in Figs. 4 and 5.
pub fn with_error(s: &mut PlanarScenario, parameter: usize, error: f64) {
    let e = &mut s.model_error;
    match parameter {
        0 => e.mass = error,
        1 => e.length = error,
        _ => e.inertia = error,
    }
}

const PARAMETERS: [&str; 3] = ["mass", "length", "inertia"];

/// Figs. 4 and 5.
pub fn parameters(settings: &Overrides) -> Result<Report, String> {
    let mut report = Report::default();
    for law in [LawKind::Attitude, LawKind::Force] {
        let (name, ..) = second(law);
        let mut panels = Vec::new();
        for (parameter, what) in PARAMETERS.iter().enumerate() {
            let reach = if parameter == 0 { 0.15 } else { 0.30 };
            let errors: Vec<f64> = (-10..=10).map(|k| reach * f64::from(k) / 10.0).collect();
            let mut panel = ScanPanel::new(format!("Δ{what}, %"));
            for duration in DURATIONS {
                let scenarios = errors
                    .iter()
                    .map(|&error| {
                        let mut s = single(law, duration);
                        with_error(&mut s, parameter, error);
                        s
                    })
                    .collect();
                let flown = scan::summaries(settings, scenarios)?;
                for (&error, s) in errors.iter().zip(&flown) {
                    panel.add(duration, error * 100.0, s);
                }
                let kept: Vec<f64> = errors
                    .iter()
                    .zip(&flown)
                    .filter(|(_, s)| !s.is_lost())
                    .map(|(e, _)| *e * 100.0)
                    .collect();
                let low = kept.iter().copied().fold(f64::INFINITY, f64::min);
                let high = kept.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                let title = format!("{name} T{duration}, {what}");
                report.add(format!("{title}: lowest error kept, percent"), low, Compare::Alone);
                report.add(format!("{title}: highest error kept, percent"), high, Compare::Alone);
            }
            panels.push(panel);
        }
        let file = if law == LawKind::Force { "fig5-force.svg" } else { "fig4-attitude.svg" };
        let title =
            format!("{name}: mean tracking error (dashed: ± deviation) over wrong parameters");
        report.picture(file, move |path| pictures::scan(&panels, &title, path));
    }
    let at = |law, error| {
        let mut s = single(law, 7.0);
        with_error(&mut s, 0, error);
        s
    };
    let flown = scan::summaries(
        settings,
        vec![
            at(LawKind::Attitude, 0.1),
            at(LawKind::Attitude, -0.1),
            at(LawKind::Force, 0.1),
            at(LawKind::Force, -0.1),
        ],
    )?;
    let [over_a, under_a, over_b, under_b] = flown.as_slice() else { return Ok(report) };
    let error = |s: &PlanarSummary| if s.is_lost() { f64::NAN } else { s.article[0].mean() };
    report.add(
        "Γa' T7: article's error, mass +10 %, 1",
        error(over_a),
        Compare::Claim("over-estimating the mass is the better side for Γa'", {
            !over_a.is_lost() && under_a.is_lost()
        }),
    );
    report.add(
        "Γb T7: article's error, mass -10 %, 1",
        error(under_b),
        // No random numbers: a tenth leaves room for another rounding and another step.
        Compare::Refuted {
            claim: "under-estimating the mass is the better side for Γb",
            ours: Band::around(0.360, 0.1),
        },
    );
    report.add("Γb T7: article's error, mass +10 %, 1", error(over_b), Compare::Alone);
    report.add(
        "Γa' T7: article's error, mass +10 % (Γb beside it above), 1",
        error(over_a),
        Compare::Refuted {
            claim: "Γa' is more robust than Γb in mean tracking error",
            ours: Band::around(0.518, 0.1),
        },
    );
    report.notes.push(
        "The article does not give its hold durations, on which this mean depends; ours are 5 s. With a \
         mass under-estimated by as little as 1 % the published end of Γa' (1.5 N of link force) is \
         unstable with its observer, so its figure cannot be reproduced on that side."
            .into(),
    );
    Ok(report)
}

/// Fig. 7.
pub fn general_model(settings: &Overrides) -> Result<Report, String> {
    let mut report = Report::default();
    type Change = fn(&mut PlanarScenario, f64);
    let changes: [(&str, f64, f64, Change); 3] = [
        ("attachment rx/J, m/(kg m²)", -0.2, 0.2, |s, x| {
            s.plant.attachment[0] = x * s.plant.inertia
        }),
        ("attachment rz/J, m/(kg m²)", -0.6, 0.24, |s, x| {
            s.plant.attachment[1] = x * s.plant.inertia;
        }),
        ("link mass, % of the vehicle", 0.0, 40.0, |s, x| {
            s.plant.link_mass = x / 100.0 * s.plant.mass;
        }),
    ];
    let mut panels = Vec::new();
    for (what, low, high, change) in changes {
        let values: Vec<f64> = (0..=20).map(|k| low + (high - low) * f64::from(k) / 20.0).collect();
        let mut panel = ScanPanel::new(what);
        for duration in DURATIONS {
            let scenarios = values
                .iter()
                .map(|&x| {
                    let mut s = single(LawKind::Force, duration);
                    change(&mut s, x);
                    s
                })
                .collect();
            let flown = scan::summaries(settings, scenarios)?;
            for (&x, s) in values.iter().zip(&flown) {
                panel.add(duration, x, s);
            }
        }
        panels.push(panel);
    }
    report.picture("fig7-general-model.svg", move |path| {
        pictures::scan(
            &panels,
            "Γb: mean tracking error (dashed: ± deviation) over the general model",
            path,
        )
    });

    let heavy = |duration| {
        let mut s = single(LawKind::Force, duration);
        s.plant.link_mass = 0.2;
        s
    };
    let mut plausible = single(LawKind::Force, 5.0);
    plausible.plant.link_mass = 0.01;
    plausible.plant.attachment = [0.03, 0.03];
    let mut stiffer = plausible.clone();
    stiffer.controller.elevation_poles = vec![-2.0, -3.0, -4.0, -5.0];
    stiffer.controller.second_poles = [-2.0, -3.0];
    let mut above = single(LawKind::Force, 5.0);
    above.plant.attachment = [0.0, -0.05];
    let mut below = single(LawKind::Force, 5.0);
    below.plant.attachment = [0.0, 0.05];
    let flown = scan::summaries(
        settings,
        vec![heavy(7.0), heavy(5.0), heavy(3.0), plausible, stiffer, above, below],
    )?;
    let [h7, h5, h3, plausible, stiffer, above, below] = flown.as_slice() else {
        return Ok(report);
    };
    let stable = "stable with a link of 20 % of the vehicle's mass";
    for (name, s) in [("T7", h7), ("T5", h5)] {
        report.add(
            format!("Γb {name}, link 20 %: elevation rms, rad"),
            s.rms[0],
            Compare::Claim(stable, !s.is_lost()),
        );
    }
    // Both tumble, and how far depends on every rounding: a quarter.
    report.add(
        "Γb T3, link 20 %: elevation rms, rad",
        h3.rms[0],
        Compare::Refuted { claim: stable, ours: Band::around(1.185, 0.25) },
    );
    report.add(
        "Γb plausible case, article's poles: elevation rms, rad",
        plausible.rms[0],
        Compare::Refuted { claim: "stable near the reference", ours: Band::around(0.813, 0.25) },
    );
    report.add(
        "Γb plausible case, poles doubled: elevation error at the end, rad",
        stiffer.final_elevation,
        Compare::Claim(
            "stable near the reference",
            !stiffer.is_lost() && stiffer.final_elevation < 0.1,
        ),
    );
    report.add("Γb rz -0.05 m: elevation rms, rad", above.rms[0], Compare::Alone);
    report.add(
        "Γb rz +0.05 m: elevation rms, rad",
        below.rms[0],
        Compare::Claim("rz <= 0 is better", above.rms[0] < below.rms[0]),
    );
    Ok(report)
}

/// Fig. 8.
pub fn noise(settings: &Overrides) -> Result<Report, String> {
    let mut report = Report::default();
    let at = |law, epsilon| {
        let mut s = single(law, 5.0);
        s.observer.epsilon = epsilon;
        s.noise.accel_variance = 0.1;
        s.noise.gyro_variance = 0.01;
        s
    };
    let cases: Vec<(LawKind, f64)> = [LawKind::Force, LawKind::Attitude]
        .into_iter()
        .flat_map(|law| [0.1, 0.3, 0.5, 0.7, 1.0].map(|epsilon| (law, epsilon)))
        .collect();
    let flown =
        scan::traces(settings, cases.iter().map(|&(law, epsilon)| at(law, epsilon)).collect())?;
    for ((law, epsilon), trace) in cases.iter().zip(&flown) {
        let (name, what, unit) = second(*law);
        let s = &trace.summary;
        let is_lost = f64::from(u8::from(s.is_lost()));
        let compare = match (law, epsilon) {
            (_, 0.1) => Compare::Refuted {
                claim: "bounded with the published gains",
                ours: Band::new(1.0, 1.0),
            },
            (LawKind::Force, e) if *e > 0.6 => Compare::Claim(
                "small and bounded with reduced gains",
                !s.is_lost() && s.rms[0] < 0.1,
            ),
            (_, e) if *e > 0.9 => Compare::Claim(
                "small and bounded with reduced gains",
                !s.is_lost() && s.rms[0] < 0.1,
            ),
            _ => Compare::Alone,
        };
        let case = format!("{name} ε {epsilon}");
        report.add(format!("{case}: lost, 1"), is_lost, compare);
        report.add(format!("{case}: elevation rms, rad"), s.rms[0], Compare::Alone);
        report.add(format!("{case}: {what} rms, {unit}"), s.rms[1], Compare::Alone);
    }
    report.notes.push(
        "The article reduced gains without printing them. The published ε of 0.1 is lost in this noise; \
         0.7 to 1 flies. A variance per sample is no physical unit: at another rate it is another noise."
            .into(),
    );
    let shown: Vec<_> = cases
        .iter()
        .zip(flown)
        .filter(|((law, epsilon), _)| *law == LawKind::Force && *epsilon > 0.6 && *epsilon < 0.8)
        .map(|(_, trace)| trace)
        .collect();
    report.picture("fig8-noise.svg", move |path| pictures::noisy(&shown, path));
    Ok(report)
}

/// VI-E.
pub fn motors(settings: &Overrides) -> Result<Report, String> {
    let mut report = Report::default();
    const LAGS: [f64; 5] = [0.02, 0.04, 0.08, 0.12, 0.15];
    const CLAIM: &str = "stable up to 0.08 s";
    let mut curves = Vec::new();
    for law in [LawKind::Force, LawKind::Attitude] {
        for duration in DURATIONS {
            for is_modelled in [false, true] {
                let scenarios = LAGS.map(|lag| {
                    let mut s = single(law, duration);
                    s.plant.motor_lag = lag;
                    s.observer.motor_lag = if is_modelled { lag } else { 0.0 };
                    s
                });
                let (name, ..) = second(law);
                let mut points = Vec::new();
                for (lag, s) in LAGS.iter().zip(scan::summaries(settings, scenarios.to_vec())?) {
                    if !s.is_lost() {
                        points.push((*lag, s.max_after_1s[0].to_degrees()));
                    }
                    let modelled = if is_modelled { "told" } else { "not told" };
                    let is_claimed = *lag <= 0.08;
                    // The shorter the move, the shorter the lag that loses it; Γa' before Γb.
                    let bearable = match (law, duration) {
                        (LawKind::Force, d) if d < 4.0 => 0.03,
                        (LawKind::Force, _) => 0.08,
                        (_, d) if d < 4.0 => 0.0,
                        (_, d) if d < 6.0 => 0.03,
                        _ => 0.08,
                    };
                    let is_lost_here = !is_modelled && *lag > bearable;
                    let compare = match (is_claimed, is_lost_here) {
                        (false, _) => Compare::Alone,
                        (true, false) => Compare::Claim(CLAIM, !s.is_lost()),
                        (true, true) => Compare::Refuted { claim: CLAIM, ours: Band::LOST },
                    };
                    report.add(
                        format!(
                            "{name} T{duration}, {lag} s, observer {modelled}: elevation max, rad"
                        ),
                        if s.is_lost() { f64::INFINITY } else { s.max_after_1s[0] },
                        compare,
                    );
                }
                curves.push((is_modelled, format!("{name} {duration} s"), points));
            }
        }
    }
    report
        .notes
        .push("inf: lost. The observer, not the controller, is what cannot bear the lag.".into());
    report.picture("motors.svg", move |path| pictures::lags(&curves, path));
    Ok(report)
}
