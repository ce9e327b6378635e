//! Does the azimuth stay where it is over a day? With a compass, with the station's encoders, and with neither.

use super::flown::fly_all;
use super::{Compare, Overrides, Report};
use crate::scenario::Scenario;

/// Flights of each.
const SEEDS: u64 = 2;
/// Of a soak, s; a tenth of it without a heading sensor, where a quarter of an hour is enough to get lost.
const DAY: f64 = 86_400.0;
/// Largest azimuth error with a sensor, rad: 3 degrees; and largest that nobody was told of: 15 degrees.
const KEPT: f64 = 0.0524;
const TOLD: f64 = 0.262;

const CASES: [(&str, &str, f64, f64); 3] = [
    (
        "compass, calibrated to 3 %",
        "magnetometer = true\nmagnetic_offset = 6e-7\nmagnetic_scale = 0.01",
        1.0,
        KEPT,
    ),
    ("line direction at the station", "ground_angles = true", 1.0, KEPT),
    ("neither", "", 0.1, f64::INFINITY),
];

/// All of it; `--set seeds=N`, and for a part of a day `--set mission.2.seconds`.
pub fn run(settings: &Overrides) -> Result<Report, String> {
    let mut report = Report::default();
    let seeds = settings.seeds(SEEDS)?;
    for (name, sensors, share, most) in CASES {
        let scenario = settings.on(scenario(sensors, DAY * share)?)?;
        let flown = fly_all(&scenario, &seeds, DAY * share + 600.0)?;
        let lost = flown.iter().filter(|(_, why)| why.is_some()).count();
        let places = || flown.iter().filter_map(|(summary, _)| summary.place);
        let degrees = |of: fn(&crate::metrics::PlaceSummary) -> f64| {
            places().map(|place| of(&place)).fold(0.0, f64::max).to_degrees()
        };
        let hours = DAY * share / 3600.0;
        let name = format!("{name}, {hours:.1} h");
        // Who does not know where North is lands somewhere else than where the reference says.
        let all_land = if most.is_finite() { Compare::AtMost(0.0) } else { Compare::Alone };
        report.add(format!("{name}: lost"), lost as f64, all_land);
        let limit =
            if most.is_finite() { Compare::AtMost(most.to_degrees()) } else { Compare::Alone };
        let azimuth = degrees(|place| place.azimuth_max_rad);
        report.add(
            format!("{name}: largest azimuth error, minute's mean, degrees"),
            azimuth,
            limit,
        );
        let unnoticed = degrees(|place| place.azimuth_unnoticed_max_rad);
        let limit = Compare::AtMost(TOLD.to_degrees());
        report.add(format!("{name}: largest before it was told, degrees"), unnoticed, limit);
        let level = places().map(|place| place.kept[0]).fold(1.0, f64::min);
        let claim = Compare::Claim("95 % of the time", level >= 0.95);
        report.add(format!("{name}: level error within 2σ"), level, claim);
    }
    report.notes.push(
        "Winch of 10 m, 3 m/s with gusts, fed through the line; largest of all flights.".into(),
    );
    Ok(report)
}

fn scenario(sensors: &str, seconds: f64) -> Result<Scenario, String> {
    let text = format!(
        r#"
        [sensors]
        {sensors}
        [station]
        supply_voltage = 400
        [wind]
        speed = 3
        gusts = true
        [[mission]]
        do = "arm"
        [[mission]]
        do = "takeoff"
        altitude = 5
        [[mission]]
        do = "hold"
        seconds = {seconds}
        [[mission]]
        do = "land"
        "#
    );
    Scenario::parse(&text, "heading-soak").map_err(|e| e.0)
}
