//! Closed-loop poles over the tether angle: Fig. 8.

use crate::bench::tether_angle::{AngleScenario, linearise};
use crate::experiment::{Compare, Overrides, Report, Source};
use crate::report::chart::{ESTIMATE, Line, Panel, SETPOINT, TRUTH};
use crate::report::grid::grid;

/// Real and imaginary parts, `inertial` section 6.
type Pole = (f64, f64);
const POLES: [(f64, f64, [Pole; 3]); 4] = [
    (10.0, 0.18, [(-28.52, 70.77), (-3.58, 0.0), (-1.09, 1.84)]),
    (50.0, 0.18, [(-28.52, 70.77), (-3.47, 0.0), (-1.15, 1.84)]),
    (90.0, 0.18, [(-28.52, 70.77), (-2.85, 0.0), (-1.46, 1.90)]),
    (10.0, 0.16, [(-28.13, 70.64), (-4.29, 0.0), (-1.12, 1.75)]),
];

/// Fig. 8.
pub fn poles(settings: &Overrides) -> Result<Report, String> {
    settings.no_seeds()?;
    let mut report = Report::default();
    add_poles(&mut report, settings)?;
    let base = settings.on(AngleScenario::default())?;
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
            Panel::new(format!("Tilt time {title}"), "tether angle, deg", "real part, 1/s"),
            lines,
        ));
    }
    report.picture("poles.svg", move |path| grid(path, 2, &cells));
    Ok(report)
}

/// The poles beside the specification's.
pub fn add_poles(report: &mut Report, settings: &Overrides) -> Result<(), String> {
    let base = settings.on(AngleScenario::default())?;
    for (deg, tilt_time, expected) in POLES {
        let s = AngleScenario { tilt_time, ..base.clone() };
        let found = linearise(&s, deg.to_radians(), None).poles;
        for (re, im) in expected {
            let off = |p: &&nalgebra::Complex<f64>| (p.re - re).hypot(p.im - im);
            let Some(p) = found.iter().min_by(|a, b| off(a).total_cmp(&off(b))) else { continue };
            let at = format!("poles, {deg} deg, tilt time {tilt_time} s, at {re}");
            let near = |value| Compare::Near {
                from: Source::Specification,
                value,
                share: 0.0,
                slack: 0.0051,
            };
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
