//! Thrust identification: the article's Table 1 on a synthetic record, and on the simulator's own flights.

use super::{Band, Compare, Overrides, Report, Source};
use crate::sysid::{Identified, Model, draw_predictions, identify, parse_csv, prepare};

/// The synthetic record of the specification, the same that the golden vectors hold.
const RECORD: &str = include_str!("../../../tests/golden/sysid.csv");
/// Fit of ours as the specification has it, its tolerance, and the article's: %.
const TABLE: [(f64, f64, Option<f64>); 6] = [
    (37.0, 0.3, Some(46.0)),
    (36.9, 0.3, Some(41.4)),
    (90.5, 0.3, Some(96.8)),
    (88.9, 1.0, None),
    (90.4, 1.0, Some(94.6)),
    (94.9, 2.0, Some(99.6)),
];

/// Coefficients of ARX by the reference: A, then B of each input.
const ARX: [f64; 10] = [
    -1.8080274384615609,
    0.8139944369952388,
    0.0024437284397906,
    -0.0023747197673749027,
    0.0024692928273462185,
    -0.002377087656345044,
    0.0025921578975617934,
    -0.00251116608494077,
    0.0025882948904886517,
    -0.0024984614581453892,
];

/// Largest relative difference of ours from the reference's.
fn arx_difference(model: &Model) -> f64 {
    let Model::Polynomial(p) = model else { return f64::NAN };
    let lags = p.inputs.iter().flat_map(|[b, _]| b.iter().skip(1));
    let ours = p.a.iter().skip(1).chain(lags);
    ours.zip(ARX).map(|(x, y)| (x / y - 1.0).abs()).fold(0.0, f64::max)
}

/// Fits beside the specification's; returns the structures found.
pub fn add_fits(report: &mut Report) -> Result<Vec<Result<Identified, String>>, String> {
    let record = parse_csv(RECORD.as_bytes(), "sysid.csv")?;
    let found = identify(&prepare(&record)?);
    for (result, (value, slack, _)) in found.iter().zip(TABLE) {
        let model = result.as_ref().map_err(Clone::clone)?;
        report.add(
            format!("thrust, {}: fit five steps ahead, %", model.name),
            model.fit,
            Compare::Near { from: Source::Specification, value, share: 0.0, slack: slack + 0.05 },
        );
        if model.name.starts_with("ARX") {
            report.add(
                "thrust, ARX 2,2,1: coefficients against the reference, relative, 1",
                arx_difference(&model.model),
                Compare::AtMost(1e-6),
            );
        }
    }
    Ok(found)
}

/// Table 1.
pub fn table(settings: &Overrides) -> Result<Report, String> {
    settings.no_settings()?;
    let mut report = Report::default();
    let found = add_fits(&mut report)?;
    for (result, (ours, _, article)) in found.iter().zip(TABLE) {
        let model = result.as_ref().map_err(Clone::clone)?;
        if let Some(value) = article {
            report.add(
                format!("{}: fit against the article's, %", model.name),
                model.fit,
                // Nothing random: half a per cent of fit for another minimum of the search.
                Compare::Explained {
                    from: Source::Paper,
                    value,
                    why: "another record: only the order compares",
                    ours: Band::new(ours - 0.5, ours + 0.5),
                },
            );
        }
        report.add(format!("{}: FPE, N²", model.name), model.fpe, Compare::Alone);
        report.add(format!("{}: MSE, N²", model.name), model.mse, Compare::Alone);
    }
    let fit = |name: &str| {
        found.iter().flatten().find(|m| m.name.starts_with(name)).map_or(0.0, |m| m.fit)
    };
    let ordered = fit("state") > fit("ARX")
        && fit("ARX") > fit("transfer")
        && fit("transfer") > fit("process");
    report.add(
        "order of the structures as in the article, 1",
        f64::from(u8::from(ordered)),
        Compare::Claim("state space, then ARX, then transfer function and process", ordered),
    );
    let data = prepare(&parse_csv(RECORD.as_bytes(), "sysid.csv")?)?;
    report.picture("sysid.svg", move |path| draw_predictions(&data, &found, path));
    Ok(report)
}
