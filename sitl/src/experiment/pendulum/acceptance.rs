//! Rows S1 to S9 of `pendulum` section 13, each beside its limit.

use super::cases::{DISTURBANCES, add_error, mean, summaries, worst};
use crate::bench::pendulum::{FilterSet, GainSet, PendulumScenario, PendulumSummary, Precision};
use crate::experiment::{Compare, Overrides, Report, Source};
use crate::scenario::DisturbanceKind;

/// Seeds of a row with random numbers.
const SEEDS: u64 = 6;

struct Table<'a> {
    report: Report,
    settings: &'a Overrides,
}

impl Table<'_> {
    fn fly(
        &mut self,
        name: &str,
        s: PendulumScenario,
        limit: f64,
    ) -> Result<Vec<PendulumSummary>, String> {
        let runs = summaries(self.settings, s, SEEDS)?;
        add_error(&mut self.report, name, &runs, Compare::AtMost(limit));
        Ok(runs)
    }

    fn tilt(&mut self, name: &str, runs: &[PendulumSummary], limit: f64) {
        let tilt = worst(runs, |s| s.tilt_peak).to_degrees();
        self.report.add(format!("{name}: largest tilt, deg"), tilt, Compare::AtMost(limit));
    }
}

/// All rows.
pub fn acceptance(settings: &Overrides) -> Result<Report, String> {
    let mut t = Table { report: Report::default(), settings };
    let base = PendulumScenario::default;
    let helped = || PendulumScenario { vertical_bandwidth: 3.0, soft_start: 4.0, ..base() };

    let runs = t.fly("S1 none, 400 Hz", base(), 0.1)?;
    let [least, most] = runs.first().map_or([0.0; 2], |s| s.thrust);
    t.report.add(
        "S1 none, 400 Hz: least thrust, N",
        least,
        Compare::Claim("at least 2.75 by the specification", least >= 2.75),
    );
    t.report.add("S1 none, 400 Hz: largest thrust, N", most, Compare::AtMost(2.95));
    let settled = mean(&runs, |s| s.within_10_cm_from);
    t.report.add("S1 none, 400 Hz: within 10 cm after, s", settled, Compare::AtMost(4.0));
    t.fly("S1 none, 100 Hz", PendulumScenario { rate: 100.0, ..base() }, 0.4)?;

    let constant = DisturbanceKind::Constant;
    t.fly("S2 constant", PendulumScenario { disturbance: constant, ..base() }, 8.0)?;
    t.fly("S2 constant, E1 + E2", PendulumScenario { disturbance: constant, ..helped() }, 1.5)?;

    let stochastic = DisturbanceKind::Stochastic;
    let s3 = |s: PendulumScenario| PendulumScenario { disturbance: stochastic, ..s };
    let sharp = || PendulumScenario { filter: FilterSet::Recommended, ..helped() };
    for (name, s, limit) in [
        ("S3 stochastic", base(), 13.0),
        ("S3 stochastic, E1 + E2", helped(), 11.0),
        ("S3 stochastic, E1 + E2, reading 1e-6", sharp(), 6.5),
    ] {
        let runs = t.fly(name, s3(s), limit)?;
        let rms = |pick| mean(&runs, pick);
        t.report.add(
            format!("{name}: rod rate error, rad/s"),
            rms(|s| s.rod_rate_rms),
            Compare::AtMost(0.05),
        );
        t.report.add(
            format!("{name}: horizontal disturbance error, N"),
            rms(|s| s.across_rms),
            Compare::AtMost(0.08),
        );
    }
    t.fly(
        "S3b stochastic, robust gains",
        PendulumScenario { gains: GainSet::Robust, ..s3(sharp()) },
        4.0,
    )?;

    for ((name, disturbance), limits) in
        DISTURBANCES.into_iter().zip([[2.0, 2.0], [2.0, 2.0], [7.0, 4.0]])
    {
        let [printed, recommended] = limits;
        let real = PendulumScenario { disturbance, ..PendulumScenario::realistic() };
        let title = format!("S4 realistic, {name}");
        let s = PendulumScenario { filter: FilterSet::Printed, ..real.clone() };
        let runs = t.fly(&title, s, printed)?;
        t.tilt(&title, &runs, 45.0);
        for (rate, precision) in [
            (100.0, Precision::Double),
            (200.0, Precision::Double),
            (400.0, Precision::Double),
            (200.0, Precision::Single),
        ] {
            let bits = if precision == Precision::Single { ", f32" } else { "" };
            let title = format!("S4b realistic, {name}, {rate} Hz{bits}");
            let runs =
                t.fly(&title, PendulumScenario { rate, precision, ..real.clone() }, recommended)?;
            t.tilt(&title, &runs, 30.0);
        }
    }

    t.fly("S5 lag 50 ms", PendulumScenario { lag: 0.05, ..base() }, 0.3)?;
    t.fly(
        "S6 delay 30 ms, lag 30 ms, 1 mrad, E2, 200 Hz",
        PendulumScenario {
            delay: 0.03,
            lag: 0.03,
            rod_noise: 1e-3,
            soft_start: 4.0,
            rate: 200.0,
            ..base()
        },
        3.0,
    )?;
    let hardware = PendulumScenario::experiment;
    t.fly("S7 experiment at 45 Hz, none", hardware(), 0.3)?;
    t.fly(
        "S7 experiment at 45 Hz, stochastic",
        PendulumScenario { disturbance: stochastic, ..hardware() },
        9.0,
    )?;
    t.fly(
        "S8 drag 0.1 N s/m, robust gains, E2",
        PendulumScenario {
            drag: 0.1,
            gains: GainSet::Robust,
            soft_start: 4.0,
            rate: 200.0,
            ..base()
        },
        2.5,
    )?;
    recovery(&mut t)?;
    t.report.notes.push(format!(
        "Rows with random numbers are means over {} seeds, the tilt is the worst; a lost run makes the \
         mean infinite.",
        settings.seeds(SEEDS)?.len()
    ));
    Ok(t.report)
}

/// S9.
fn recovery(t: &mut Table) -> Result<(), String> {
    let fallen = PendulumScenario {
        speed: 0.0,
        start: vec![],
        tilt: 30.0,
        tilt_azimuth: 0.0,
        duration: 25.0,
        ..PendulumScenario::default()
    };
    let name = "S9 hover, tilted 30 deg, no limits";
    let runs = t.fly(name, fallen, 1.0)?;
    let near = |value| Compare::Near { from: Source::Specification, value, share: 0.1, slack: 0.0 };
    for (what, pick, compare) in [
        ("thrust peak, N", (|s| s.thrust_peak) as fn(&PendulumSummary) -> f64, near(6.05)),
        ("rate peak, rad/s", |s| s.rate_peak, near(15.1)),
        ("within 10 cm after, s", |s| s.within_10_cm_from, Compare::AtMost(5.0)),
        ("error at 25 s, cm", |s| 100.0 * s.error_end, Compare::AtMost(1.0)),
    ] {
        t.report.add(format!("{name}: {what}"), mean(&runs, pick), compare);
    }
    Ok(())
}
