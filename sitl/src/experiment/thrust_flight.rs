//! A vehicle whose rotors differ from its parameters: excited in free flight, identified from its own
//! log, flown on the tether before and after.

use super::angle_flight::{BASE, LONGEST};
use super::flown::why_lost;
use super::{Compare, Overrides, Report};
use crate::campaign::parallel;
use crate::flight::Flight;
use crate::scenario::{Scenario, Step, TetherKind, set_param};
use crate::sysid::{PwmRange, ThrustFit, fit_thrust_map, read_log};
use tautline_firmware::param::Params;
use tautline_firmware::supervisor::Mode;

/// By how much the parameters overstate the thrust, and its curve: the true one is 1.
const THRUST_ASSUMED: f64 = 1.06;
const FACTOR_ASSUMED: f32 = 0.8;
/// Of the excitation, s and m.
const EXCITED: f64 = 60.0;
const HEIGHT: f64 = 5.0;
/// Flights.
const SEEDS: u64 = 5;

/// The vehicle with wrong parameters.
fn vehicle() -> Result<Scenario, String> {
    let mut s = Scenario::parse(BASE, "angle.toml").map_err(|e| e.0)?;
    let v = &s.vehicle;
    let true_max = v.thrust_coefficient * v.rotor_speed_max * v.rotor_speed_max;
    s.params.insert("MOT_THR_MAX".into(), (true_max * THRUST_ASSUMED) as f32);
    s.params.insert("THR_MDL_FAC".into(), FACTOR_ASSUMED);
    s.vehicle.common_thrust_error = 0.0;
    Ok(s)
}

/// Shakes it without a tether and identifies from the log.
fn identify(settings: &Overrides, seed: u64) -> Result<ThrustFit, String> {
    let mut s = settings.on(vehicle()?)?;
    s.tether.kind = TetherKind::None;
    s.mission = vec![
        Step::Altitude,
        Step::Arm,
        Step::Excite { altitude: HEIGHT, seconds: EXCITED },
        Step::AwaitDisarmed { timeout: 60.0 },
    ];
    let mut params = s.params().map_err(|e| e.0)?;
    params.log_full = 1.0;
    let mut flight = Flight::new(&s, params, seed, Vec::new()).map_err(|e| e.0)?;
    flight.fly(200.0);
    if let Some(why) = why_lost(&flight) {
        return Err(format!("excitation, seed {seed}: {why}"));
    }
    let log = flight.finish_log().map_err(|e| e.to_string())?.unwrap_or_default();
    let mut before = Params::default();
    let record = read_log(log.as_slice(), "log", &mut before)?;
    fit_thrust_map(&record, PwmRange::guess(&record), &before)
}

/// Tether Angle at 30 deg: mean thrust error, estimate and tracking rms, rad.
fn fly(settings: &Overrides, seed: u64, known: Option<&ThrustFit>) -> Result<[f64; 3], String> {
    let s = settings.on(vehicle()?)?;
    let mut params = s.params().map_err(|e| e.0)?;
    for (name, value) in known.iter().flat_map(|fit| fit.parameters()) {
        set_param(&mut params, name, value as f32)?;
    }
    let mut flight = Flight::unrecorded(&s, params, seed).map_err(|e| e.0)?;
    let (mut sum, mut count) = (0.0, 0.0);
    while flight.world.time() < LONGEST && !flight.is_over() {
        flight.step(&mut |_| {});
        let out = flight.output();
        if out.mode == Mode::TetherAngle {
            sum += flight.world.environment.plant.thrust() / f64::from(out.estimate.thrust) - 1.0;
            count += 1.0;
        }
    }
    let lost = why_lost(&flight).unwrap_or_else(|| "never flew the mode".into());
    let flown = flight.metrics.angle.summary().ok_or(format!("seed {seed}: {lost}"))?;
    Ok([sum / count, flown.estimate_rms_rad, flown.tracking_rms_rad])
}

/// Before and after.
pub fn run(settings: &Overrides) -> Result<Report, String> {
    let mut report = Report::default();
    let seeds = settings.seeds(SEEDS)?;
    let truth = vehicle()?.vehicle;
    let true_max = truth.thrust_coefficient * truth.rotor_speed_max * truth.rotor_speed_max;
    let work = |seed: &u64| -> Result<_, String> {
        let fit = identify(settings, *seed)?;
        Ok((fit, fly(settings, *seed, None)?, fly(settings, *seed, Some(&fit))?))
    };
    let mut worst = [[0.0_f64; 3]; 2];
    let mut off = [0.0_f64; 3];
    for result in parallel::map(&seeds, parallel::cores(), work, |_| {}) {
        let (fit, before, after) = result?;
        for (worst, now) in worst.iter_mut().zip([before, after]) {
            worst.iter_mut().zip(now).for_each(|(worst, x)| *worst = worst.max(x.abs()));
        }
        let lag = fit.lag.ok_or("the flight does not tell the motors' lag")?;
        let now = [
            fit.thrust_max / true_max - 1.0,
            fit.factor - truth.throttle_curve.powi(2),
            lag - truth.rotor_time_constant,
        ];
        off.iter_mut().zip(now).for_each(|(off, x)| *off = off.max(x.abs()));
    }
    let [max, factor, lag] = off;
    report.add("identified maximum, error, %", 100.0 * max, Compare::Alone);
    report.add("identified share of the square law, error, 1", factor, Compare::Alone);
    report.add("identified lag, error, s", lag, Compare::Alone);
    let [before, after] = worst;
    let names = ["thrust error, %", "tether angle estimate rms, deg", "tracking rms, deg"];
    for (i, name) in names.into_iter().enumerate() {
        let scale = if i == 0 { 100.0 } else { 180.0 / std::f64::consts::PI };
        let pick = |x: &[f64; 3]| scale * x.get(i).copied().unwrap_or(f64::NAN);
        let (old, new) = (pick(&before), pick(&after));
        report.add(format!("before: {name}"), old, Compare::Alone);
        report.add(format!("after: {name}"), new, Compare::Claim("smaller after", new < old));
    }
    report.notes.push(format!(
        "Worst of {} seeds. Parameters told 6 % too much thrust and a curve of 0.8 for 1; excitation of 60 s \
         without a tether, then the flight of angle.toml.",
        seeds.len()
    ));
    Ok(report)
}
