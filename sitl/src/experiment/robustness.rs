//! `planar` section 10: what still flies, and how badly. Ours beside the reference's, within 20 %.

use super::journal::{single, with_error};
use super::{Band, Compare, Overrides, Report, Source, scan};
use crate::bench::planar::{LawKind, PlanarScenario};
use crate::campaign::parallel;

const LOST: f64 = f64::INFINITY;
const SHARE: f64 = 0.2;

/// Within 20 %, or within the rounding of the printed reference.
fn near(value: f64, rounding: f64) -> Compare {
    Compare::Near { from: Source::Specification, value, share: SHARE, slack: rounding }
}

/// Runs every table.
pub fn run(settings: &Overrides) -> Result<Report, String> {
    let mut report = Report::default();
    mass_errors(settings, &mut report)?;
    single_errors(settings, &mut report)?;
    general(settings, &mut report)?;
    offsets(settings, &mut report)?;
    motors(settings, &mut report)?;
    noise(settings, &mut report)?;
    limits(settings, &mut report)?;
    report.notes.push("inf: lost.".into());
    Ok(report)
}

fn name(law: LawKind) -> &'static str {
    if law == LawKind::Force { "Γb" } else { "Γa'" }
}

/// The article's mean error of each scenario, infinite where lost.
fn article_errors(
    settings: &Overrides,
    report: &mut Report,
    cases: Vec<(String, PlanarScenario, f64)>,
) -> Result<(), String> {
    let flown = scan::summaries(settings, cases.iter().map(|(_, s, _)| s.clone()).collect())?;
    for ((title, _, expected), s) in cases.into_iter().zip(flown) {
        let ours = if s.is_lost() { LOST } else { s.article[0].mean() };
        let compare = if expected == LOST {
            Compare::Claim("lost in the reference too", ours == LOST)
        } else {
            near(expected, 0.006)
        };
        report.add(format!("{title}: article's error, 1"), ours, compare);
    }
    Ok(())
}

fn mass_errors(settings: &Overrides, report: &mut Report) -> Result<(), String> {
    const ERRORS: [f64; 6] = [-15.0, -10.0, -5.0, 5.0, 10.0, 15.0];
    let (force, attitude) = (LawKind::Force, LawKind::Attitude);
    let table = [
        (force, 7.0, [0.57, 0.36, 0.17, 0.16, 0.31, 0.45]),
        (force, 5.0, [0.61, 0.37, 0.17, 0.16, 0.30, LOST]),
        (force, 3.0, [LOST, LOST, 0.20, LOST, LOST, LOST]),
        (attitude, 7.0, [LOST, LOST, LOST, 0.29, 0.52, 0.71]),
        (attitude, 5.0, [LOST, LOST, LOST, 0.30, 0.54, 0.73]),
    ];
    let mut cases = Vec::new();
    for (law, duration, expected) in table {
        for (error, expected) in ERRORS.into_iter().zip(expected) {
            let mut s = single(law, duration);
            with_error(&mut s, 0, error / 100.0);
            let title = format!("{} T{duration}, mass {error:+} %", name(law));
            cases.push((title, s, expected));
        }
    }
    article_errors(settings, report, cases)
}

fn single_errors(settings: &Overrides, report: &mut Report) -> Result<(), String> {
    let (force, attitude) = (LawKind::Force, LawKind::Attitude);
    let table = [
        (force, 7.0, 1, -0.3, 0.022),
        (force, 7.0, 1, 0.3, 0.013),
        (force, 5.0, 1, -0.3, 0.037),
        (force, 5.0, 1, 0.3, 0.023),
        (force, 3.0, 1, -0.3, 0.084),
        (force, 3.0, 1, 0.3, 0.101),
        (attitude, 5.0, 1, -0.3, 0.031),
        (attitude, 5.0, 1, 0.3, 0.020),
        (force, 5.0, 2, -0.5, 0.022),
        (force, 5.0, 2, 1.0, 0.011),
        (force, 5.0, 2, -0.8, 0.08),
        (attitude, 5.0, 2, -0.5, 0.17),
        (attitude, 5.0, 2, 1.0, 0.08),
    ];
    let cases = table
        .into_iter()
        .map(|(law, duration, parameter, error, expected)| {
            let mut s = single(law, duration);
            with_error(&mut s, parameter, error);
            let what = if parameter == 1 { "length" } else { "inertia" };
            let title = format!("{} T{duration}, {what} {:+} %", name(law), error * 100.0);
            (title, s, expected)
        })
        .collect();
    article_errors(settings, report, cases)
}

fn general(settings: &Overrides, report: &mut Report) -> Result<(), String> {
    let table = [
        (5.0, 1.0, 0.009),
        (5.0, 5.0, 0.048),
        (5.0, 10.0, 0.106),
        (5.0, 20.0, 0.264),
        (5.0, 30.0, 0.50),
        (5.0, 40.0, LOST),
        (3.0, 20.0, LOST),
    ];
    let cases = table
        .into_iter()
        .map(|(duration, share, expected)| {
            let mut s = single(LawKind::Force, duration);
            s.plant.link_mass = share / 100.0;
            (format!("Γb T{duration}, link mass {share} %"), s, expected)
        })
        .collect();
    article_errors(settings, report, cases)
}

/// Steady elevation error, degrees.
fn offsets(settings: &Overrides, report: &mut Report) -> Result<(), String> {
    let table = [
        ([0.0, -0.10], 21.0),
        ([0.0, -0.03], 9.7),
        ([0.0, 0.03], 21.8),
        ([0.0, 0.05], 36.0),
        ([0.0, 0.10], LOST),
        ([0.01, 0.0], 7.5),
        ([-0.01, 0.0], 8.9),
        ([-0.03, 0.0], 31.0),
        ([0.03, 0.0], 40.0),
        ([0.05, 0.0], LOST),
        ([-0.05, 0.0], LOST),
    ];
    let scenarios = table
        .iter()
        .map(|(attachment, _)| {
            let mut s = single(LawKind::Force, 5.0);
            s.plant.attachment = *attachment;
            s
        })
        .collect();
    for ((attachment, expected), s) in table.iter().zip(scan::summaries(settings, scenarios)?) {
        let [x, z] = attachment;
        let ours = if s.is_lost() { LOST } else { s.max_last[0].to_degrees() };
        let compare = if *expected == LOST {
            Compare::Claim("lost in the reference too", ours == LOST)
        } else {
            near(*expected, 0.6)
        };
        report.add(
            format!("Γb T5, attachment ({x}, {z}) m: steady elevation error, deg"),
            ours,
            compare,
        );
    }
    Ok(())
}

fn motors(settings: &Overrides, report: &mut Report) -> Result<(), String> {
    let lagged = |law, duration, lag: f64, is_modelled: bool| {
        let mut s = single(law, duration);
        s.plant.motor_lag = lag;
        s.observer.motor_lag = if is_modelled { lag } else { 0.0 };
        s
    };
    let (force, attitude) = (LawKind::Force, LawKind::Attitude);
    let mut cases: Vec<(String, PlanarScenario, f64)> =
        [(0.02, 0.002), (0.04, 0.004), (0.08, 0.010), (0.12, 0.023), (0.15, 0.041)]
            .into_iter()
            .map(|(lag, e)| (format!("Γb T5, motors {lag} s"), lagged(force, 5.0, lag, false), e))
            .collect();
    cases.push(("Γb T3, motors 0.03 s".into(), lagged(force, 3.0, 0.03, false), LOST));
    let mut strong = lagged(force, 3.0, 0.08, false);
    strong.reference.second = [10.0, 12.0];
    cases.push(("Γb T3, 10 to 12 N, motors 0.08 s".into(), strong, 0.019));
    cases.push(("Γa' T5, motors 0.04 s".into(), lagged(attitude, 5.0, 0.04, false), LOST));
    cases.push(("Γa' T5, motors 0.08 s, told".into(), lagged(attitude, 5.0, 0.08, true), 0.025));
    cases.push(("Γa' T5, motors 0.15 s, told".into(), lagged(attitude, 5.0, 0.15, true), 0.048));
    article_errors(settings, report, cases)?;

    let conference = |lag: f64, is_modelled: bool| {
        let mut s = PlanarScenario::conference();
        s.observer.branches = crate::bench::planar::BranchChoice::One;
        s.observer.is_above_ground = false;
        s.plant.motor_lag = lag;
        s.observer.motor_lag = if is_modelled { lag } else { 0.0 };
        s
    };
    let flown = scan::summaries(
        settings,
        vec![conference(0.01, false), conference(0.08, true), conference(0.15, true)],
    )?;
    let [short, medium, long] = flown.as_slice() else { return Ok(()) };
    let elevation = |s: &crate::bench::planar::PlanarSummary| {
        if s.is_lost() { LOST } else { s.max_after_1s[0] }
    };
    report.add("compression, motors 0.01 s: elevation max, rad", elevation(short), {
        Compare::Claim("lost in the reference too", short.is_lost())
    });
    report.add(
        "compression, motors 0.08 s, told: elevation max, rad",
        elevation(medium),
        near(0.049, 1e-3),
    );
    report.add(
        "compression, motors 0.08 s, told: link force max, N",
        medium.max_after_1s[1],
        near(2.65, 0.01),
    );
    report.add("compression, motors 0.15 s, told: elevation max, rad", elevation(long), {
        Compare::Claim("fails from about 0.12 s", long.is_lost() || long.max_after_1s[0] > 0.15)
    });
    Ok(())
}

/// Five seeds; the reference's random numbers are others, so a factor of two is agreement.
fn noise(settings: &Overrides, report: &mut Report) -> Result<(), String> {
    let table = [
        (LawKind::Force, 0.3, 1000.0, [3.0, 5.0], LOST),
        (LawKind::Force, 0.5, 1000.0, [3.0, 5.0], 0.034),
        (LawKind::Force, 0.5, 250.0, [3.0, 5.0], 0.17),
        (LawKind::Force, 0.7, 1000.0, [3.0, 5.0], 0.014),
        (LawKind::Force, 0.7, 250.0, [3.0, 5.0], 0.045),
        (LawKind::Force, 1.0, 1000.0, [3.0, 5.0], 0.017),
        (LawKind::Force, 1.0, 250.0, [3.0, 5.0], 0.025),
        (LawKind::Force, 0.3, 1000.0, [10.0, 12.0], 0.027),
        (LawKind::Force, 0.3, 250.0, [10.0, 12.0], 0.135),
        (LawKind::Attitude, 0.7, 1000.0, [0.0, 0.0], 0.070),
        (LawKind::Attitude, 0.7, 250.0, [0.0, 0.0], 0.33),
        (LawKind::Attitude, 1.0, 1000.0, [0.0, 0.0], 0.017),
        (LawKind::Attitude, 1.0, 250.0, [0.0, 0.0], 0.086),
    ];
    for (law, epsilon, rate_hz, second, expected) in table {
        let mut s = single(law, 5.0);
        s.observer.epsilon = epsilon;
        s.rate_hz = rate_hz;
        s.substeps = (2000.0 / rate_hz).ceil() as u32;
        if law == LawKind::Force {
            s.reference.second = second;
        }
        s.noise.accel_variance = 0.1;
        s.noise.gyro_variance = 0.01;
        let seeds: Vec<Overrides> = (0..5)
            .map(|k| Overrides { seed: settings.seed + k, sets: settings.sets.clone() })
            .collect();
        let flown = parallel::map(
            &seeds,
            parallel::cores(),
            |settings| scan::summaries(settings, vec![s.clone()]),
            |_| {},
        );
        let mut sum = 0.0;
        let mut lost = 0;
        for s in flown {
            for s in s? {
                sum += s.rms[0];
                lost += u32::from(s.is_lost());
            }
        }
        let ours = if lost > 2 { LOST } else { sum / 5.0 };
        let force =
            if law == LawKind::Force { format!(", {} N", second[0]) } else { String::new() };
        let compare = if expected == LOST {
            Compare::Claim("lost in the reference too", ours == LOST)
        } else if law == LawKind::Attitude && epsilon > 0.9 && rate_hz < 500.0 {
            // The mean of five seeds: 0.15 to 0.21 from six first seeds; twice that spread.
            Compare::Explained {
                from: Source::Specification,
                value: expected,
                why: "40 seeds spread from 0.07 to 0.45",
                ours: Band::new(0.12, 0.27),
            }
        } else {
            Compare::Near { from: Source::Specification, value: expected, share: 0.5, slack: 0.003 }
        };
        report.add(
            format!("{} noise, ε {epsilon}, {rate_hz} Hz{force}: elevation rms, rad", name(law)),
            ours,
            compare,
        );
    }
    report.notes.push(
        "Noise is compared within 50 %: five seeds of our own random numbers against five of the \
         reference's."
            .into(),
    );
    Ok(())
}

/// How far a parameter may be off before the loop is lost.
struct Limit {
    /// So many steps of the scan are agreement too.
    steps: f64,
    what: &'static str,
    unit: &'static str,
    scale: f64,
    step: f64,
    end: f64,
    base: fn(f64) -> PlanarScenario,
    change: fn(&mut PlanarScenario, f64),
    expected: [f64; 3],
}

fn force(duration: f64) -> PlanarScenario {
    single(LawKind::Force, duration)
}
fn attitude(duration: f64) -> PlanarScenario {
    single(LawKind::Attitude, duration)
}
fn strong(duration: f64) -> PlanarScenario {
    let mut s = force(duration);
    s.reference.second = [10.0, 12.0];
    s
}
fn stiff(duration: f64) -> PlanarScenario {
    let mut s = force(duration);
    s.controller.elevation_poles = vec![-2.0, -3.0, -4.0, -5.0];
    s.controller.second_poles = [-2.0, -3.0];
    s
}
fn modelled_lag(s: &mut PlanarScenario, lag: f64) {
    s.plant.motor_lag = lag;
    s.observer.motor_lag = lag;
}

fn limit_rows() -> Vec<Limit> {
    let percent = |what, base, change, step, end, expected| Limit {
        steps: 1.0,
        what,
        unit: "percent",
        scale: 100.0,
        step,
        end,
        base,
        change,
        expected,
    };
    let metres = |what, base: fn(f64) -> PlanarScenario, change, end: f64, expected| Limit {
        steps: 1.0,
        what,
        unit: "m",
        scale: 1.0,
        step: 0.005_f64.copysign(end),
        end,
        base,
        change,
        expected,
    };
    let seconds = |what, base, change, expected| Limit {
        steps: 1.0,
        what,
        unit: "s",
        scale: 1.0,
        step: 0.01,
        end: 0.4,
        base,
        change,
        expected,
    };
    let mass: fn(&mut PlanarScenario, f64) = |s, x| s.model_error.mass = x;
    let length: fn(&mut PlanarScenario, f64) = |s, x| s.model_error.length = x;
    let inertia: fn(&mut PlanarScenario, f64) = |s, x| s.model_error.inertia = x;
    let link: fn(&mut PlanarScenario, f64) = |s, x| s.plant.link_mass = x;
    let rx: fn(&mut PlanarScenario, f64) = |s, x| s.plant.attachment[0] = x;
    let rz: fn(&mut PlanarScenario, f64) = |s, x| s.plant.attachment[1] = x;
    let lag: fn(&mut PlanarScenario, f64) = |s, x| s.plant.motor_lag = x;
    vec![
        percent("Γb mass low", force, mass, -0.01, -0.6, [-18.0, -17.0, -6.0]),
        percent("Γb mass high", force, mass, 0.01, 0.6, [16.0, 11.0, 4.0]),
        percent("Γb mass low, 10 to 12 N", strong, mass, -0.01, -0.6, [-54.0, -50.0, -46.0]),
        percent("Γb mass high, 10 to 12 N", strong, mass, 0.01, 0.6, [44.0, 42.0, 20.0]),
        percent("Γa' mass low", attitude, mass, -0.01, -0.6, [0.0, 0.0, 0.0]),
        percent("Γa' mass high", attitude, mass, 0.01, 0.6, [60.0, 57.0, 4.0]),
        percent("Γb length low", force, length, -0.05, -0.6, [-60.0; 3]),
        percent("Γb length high", force, length, 0.05, 1.0, [100.0; 3]),
        percent("Γa' length low", attitude, length, -0.05, -0.6, [-60.0; 3]),
        percent("Γa' length high", attitude, length, 0.05, 1.0, [100.0; 3]),
        percent("Γb inertia low", force, inertia, -0.1, -0.9, [-90.0; 3]),
        percent("Γb inertia high", force, inertia, 0.1, 3.0, [300.0; 3]),
        percent("Γa' inertia low", attitude, inertia, -0.1, -0.9, [-90.0; 3]),
        percent("Γa' inertia high", attitude, inertia, 0.1, 3.0, [300.0; 3]),
        percent("Γb link mass", force, link, 0.02, 0.6, [36.0, 34.0, 12.0]),
        metres("Γb rx low", force, rx, -0.2, [-0.03, -0.03, -0.035]),
        metres("Γb rx high", force, rx, 0.2, [0.03, 0.03, 0.03]),
        metres("Γb rz low", force, rz, -0.2, [-0.2, -0.2, -0.2]),
        metres("Γb rz high", force, rz, 0.2, [0.05, 0.055, 0.06]),
        metres("Γb rx low, poles doubled", stiff, rx, -0.3, [-0.165, -0.17, -0.175]),
        metres("Γb rx high, poles doubled", stiff, rx, 0.3, [0.14, 0.14, 0.145]),
        metres("Γb rz low, poles doubled", stiff, rz, -0.3, [-0.3, -0.3, -0.3]),
        metres("Γb rz high, poles doubled", stiff, rz, 0.3, [0.285, 0.295, 0.3]),
        seconds("Γb motors", force, lag, [0.4, 0.21, 0.02]),
        seconds("Γb motors, told", force, modelled_lag, [0.4, 0.4, 0.36]),
        // Whether 0.07 and 0.08 s fly at T7 turns on the last bit: 1e-14 rad on the reference decides.
        Limit { steps: 2.0, ..seconds("Γa' motors", attitude, lag, [0.06, 0.03, 0.0]) },
        seconds("Γa' motors, told", attitude, modelled_lag, [0.4, 0.4, 0.4]),
    ]
}

fn limits(settings: &Overrides, report: &mut Report) -> Result<(), String> {
    let rows = limit_rows();
    let cases: Vec<(&Limit, f64, f64)> = rows
        .iter()
        .flat_map(|row| {
            super::journal::DURATIONS.into_iter().zip(row.expected).map(move |(t, e)| (row, t, e))
        })
        .collect();
    let found = parallel::map(
        &cases,
        parallel::cores(),
        |(row, duration, _)| {
            scan::limit(settings, row.step, row.end, |x| {
                let mut s = (row.base)(*duration);
                (row.change)(&mut s, x);
                s
            })
        },
        |_| {},
    );
    for ((row, duration, expected), found) in cases.into_iter().zip(found) {
        let slack = row.step.abs() * row.scale * (row.steps + 0.01);
        report.add(
            format!("{} T{duration}: still flies at, {}", row.what, row.unit),
            found? * row.scale,
            near(expected, slack),
        );
    }
    Ok(())
}
