//! How much delay, lag, noise and model error the loop bears: `pendulum` section 10.

use super::cases::{DISTURBANCES, mean, summaries};
use crate::bench::pendulum::{FilterSet, GainSet, PendulumScenario};
use crate::experiment::{Compare, Overrides, Report, Source};
use crate::report::chart::{ESTIMATE, Line, Panel, Points, SETPOINT, THIRD, TRUTH};
use crate::report::grid::{self, grid};
use crate::scenario::DisturbanceKind;

const SEEDS: u64 = 3;

struct Sweep<'a> {
    report: Report,
    settings: &'a Overrides,
}

fn near(value: f64) -> Compare {
    Compare::Near { from: Source::Specification, value, share: 0.25, slack: 0.05 }
}

impl Sweep<'_> {
    /// Mean error, cm; infinite if lost.
    fn fly(
        &mut self,
        name: impl Into<String>,
        s: PendulumScenario,
        compare: Compare,
    ) -> Result<f64, String> {
        let runs = summaries(self.settings, s, SEEDS)?;
        let error = 100.0 * mean(&runs, |s| s.error_mean);
        self.report.add(format!("{}: mean error, cm", name.into()), error, compare);
        Ok(error)
    }
}

fn helped() -> PendulumScenario {
    PendulumScenario { soft_start: 4.0, rate: 200.0, ..PendulumScenario::default() }
}

/// All sweeps.
pub fn sweeps(settings: &Overrides) -> Result<Report, String> {
    let mut t = Sweep { report: Report::default(), settings };
    let mut cells = vec![rates(&mut t)?, noise(&mut t)?];
    let (delays, map) = delays(&mut t)?;
    cells.extend([delays, map]);
    models(&mut t)?;
    t.report.notes.push(
        "Printed gains without E1 unless a row says otherwise. An infinite error is a lost run. Over seeds \
         where noise is on."
            .into(),
    );
    t.report.picture("pendulum-sweeps.svg", move |path| grid(path, 2, &cells));
    Ok(t.report)
}

fn rates(t: &mut Sweep) -> Result<grid::Cell, String> {
    let mut lines = Vec::new();
    for ((name, disturbance), colour) in DISTURBANCES.into_iter().zip([TRUTH, SETPOINT, ESTIMATE]) {
        let mut points = Points::new();
        for rate in [45.0, 100.0, 200.0, 400.0, 1000.0] {
            let s = PendulumScenario { disturbance, rate, ..PendulumScenario::realistic() };
            let error = t.fly(format!("realistic, {name}, {rate} Hz"), s, Compare::Alone)?;
            points.push((rate, error));
        }
        lines.push(Line::new(name, colour, points));
    }
    Ok((Panel::new("Over the rate of filter and control, realistic", "Hz", "cm"), lines))
}

fn noise(t: &mut Sweep) -> Result<grid::Cell, String> {
    let (mut printed, mut robust) = (Points::new(), Points::new());
    for (milliradians, reference) in
        [(1.0, 0.15), (5.0, 0.79), (10.0, 1.9), (20.0, 4.9), (50.0, f64::INFINITY)]
    {
        let rod_noise = milliradians * 1e-3;
        let name = format!("noise {milliradians} mrad");
        let compare = if reference.is_finite() { near(reference) } else { Compare::Alone };
        let error = t.fly(&name, PendulumScenario { rod_noise, ..helped() }, compare)?;
        if !reference.is_finite() {
            // Metres of error, or lost outright.
            let is_useless = error > 100.0;
            let claim = Compare::Claim("lost, by the specification", is_useless);
            t.report.add(format!("{name}: useless, 1"), f64::from(is_useless), claim);
        }
        printed.push((milliradians, error));
        let s = PendulumScenario { rod_noise, gains: GainSet::Robust, ..helped() };
        robust.push((milliradians, t.fly(format!("{name}, robust gains"), s, Compare::Alone)?));
    }
    Ok((
        Panel::new("Over the noise of the measured direction", "mrad", "cm"),
        vec![Line::new("printed gains", TRUTH, printed), Line::new("robust gains", THIRD, robust)],
    ))
}

fn delays(t: &mut Sweep) -> Result<(grid::Cell, grid::Cell), String> {
    let mut delays: [Points; 2] = Default::default();
    let mut lags: [Points; 2] = Default::default();
    let sets = [("printed", GainSet::Printed), ("robust", GainSet::Robust)];
    for ((name, gains), (delays, lags)) in sets.into_iter().zip(delays.iter_mut().zip(&mut lags)) {
        for ms in [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0] {
            let s = PendulumScenario { delay: ms * 1e-3, gains, ..helped() };
            let error = t.fly(format!("delay {ms} ms, {name} gains"), s, Compare::Alone)?;
            delays.push((ms, error));
            let s = PendulumScenario { lag: ms * 1e-3, gains, ..helped() };
            let error = t.fly(format!("lag {ms} ms, {name} gains"), s, Compare::Alone)?;
            lags.push((ms, error));
        }
    }
    // Pairs of delay and lag, ms, and who survives them: printed gains, robust with either filter.
    for (delay, lag, survives) in [
        (20.0, 50.0, [true, true, true]),
        (30.0, 30.0, [true, true, true]),
        (40.0, 20.0, [true, true, true]),
        (40.0, 30.0, [true, true, false]),
        (50.0, 20.0, [true, true, false]),
        (30.0, 50.0, [false, false, false]),
        (50.0, 30.0, [false, false, false]),
    ] {
        let setups = [
            ("printed gains", GainSet::Printed, FilterSet::Printed),
            ("robust gains", GainSet::Robust, FilterSet::Printed),
            ("robust gains, reading 1e-6", GainSet::Robust, FilterSet::Recommended),
        ];
        for ((name, gains, filter), expected) in setups.into_iter().zip(survives) {
            let s = PendulumScenario {
                delay: delay * 1e-3,
                lag: lag * 1e-3,
                rod_noise: 1e-3,
                gains,
                filter,
                ..helped()
            };
            let runs = summaries(t.settings, s, SEEDS)?;
            // A limit cycle of a third of a metre is no flight either.
            let flies = mean(&runs, |s| s.error_mean) < 0.3;
            let text = if expected { "survives, by the specification" } else { "fails, by it" };
            let title = format!("delay {delay} ms and lag {lag} ms, {name}: flies, 1");
            t.report.add(title, f64::from(flies), Compare::Claim(text, flies == expected));
        }
    }
    let panel = |title: &'static str| Panel::new(title, "ms", "cm");
    let lines = |[printed, robust]: [Points; 2]| {
        vec![Line::new("printed gains", TRUTH, printed), Line::new("robust gains", THIRD, robust)]
    };
    Ok((
        (panel("Over the age of the measurements"), lines(delays)),
        (panel("Over the time constant of the body rates"), lines(lags)),
    ))
}

fn models(t: &mut Sweep) -> Result<(), String> {
    // From (70), as in the specification: how much of a vertical error is learnt depends on the start.
    let plain = PendulumScenario::default;
    for (name, s, reference) in [
        ("mass 5 % heavy", PendulumScenario { mass_error: 0.05, ..plain() }, 7.4),
        ("thrust 5 % strong", PendulumScenario { thrust_error: 0.05, ..plain() }, 8.9),
        ("thrust 5 % weak", PendulumScenario { thrust_error: -0.05, ..plain() }, 8.1),
    ] {
        t.fly(name, s.clone(), near(reference))?;
        let helped = PendulumScenario { vertical_bandwidth: 3.0, soft_start: 4.0, ..s };
        t.fly(format!("{name}, E1 + E2"), helped, Compare::Alone)?;
    }
    let drag = |drag, gains, filter, vertical_bandwidth| PendulumScenario {
        drag,
        gains,
        filter,
        vertical_bandwidth,
        ..helped()
    };
    let (printed, robust) = (GainSet::Printed, GainSet::Robust);
    let (slow, sharp) = (FilterSet::Printed, FilterSet::Recommended);
    for (name, s, reference) in [
        ("drag 0.1 N s/m, printed", drag(0.1, printed, slow, 0.0), 40.0),
        ("drag 0.1 N s/m, reading 1e-6", drag(0.1, printed, sharp, 0.0), 0.85),
        ("drag 0.1 N s/m, robust", drag(0.1, robust, slow, 0.0), 1.1),
        ("drag 0.1 N s/m, robust, 1e-6, E1", drag(0.1, robust, sharp, 3.0), 0.47),
        ("drag 0.3 N s/m, robust, 1e-6, E1", drag(0.3, robust, sharp, 3.0), 1.4),
    ] {
        t.fly(name, s, near(reference))?;
    }
    let known = PendulumScenario {
        disturbance: DisturbanceKind::Stochastic,
        knows_state: true,
        ..PendulumScenario::default()
    };
    t.fly("stochastic, true state fed back, 400 Hz", known, near(1.1))?;
    Ok(())
}
