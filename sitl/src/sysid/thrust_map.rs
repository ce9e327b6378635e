//! The firmware's thrust map from the same record: a simulation model's static gain, in the
//! curve's own terms.
//!
//! `T = thrust_max Σ sag (f u² + (1-f) u)` behind a first-order lag: linear in `thrust_max f` and
//! `thrust_max (1-f)` for a given lag, which is searched.

use super::arx::least_squares;
use super::polynomial::rational;
use super::prepare::{RATE, low_pass_channel, resample};
use super::record::Record;
use nalgebra::{DMatrix, DVector};
use tautline_firmware::param::Params;

/// The curve counts as identified when its share of the square law is known this well.
const FACTOR_KNOWN: f64 = 0.1;
/// Lags searched, s.
const LAGS: [f64; 2] = [0.003, 0.3];
/// Residuals low-passed at a tenth of the sampling rate carry about a fifth of the samples' information.
const INDEPENDENT: f64 = 0.2;

/// What a PWM value means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PwmRange {
    /// Throttle 0.
    pub low: f64,
    /// Throttle 1.
    pub high: f64,
}

impl PwmRange {
    /// By the largest value: a throttle, a byte, nine bits as the AR.Drone's, or microseconds.
    #[must_use]
    pub fn guess(record: &Record) -> Self {
        let largest = record.pwm.iter().flatten().copied().fold(0.0, f64::max);
        let (low, high) = match largest {
            x if x <= 1.0 => (0.0, 1.0),
            x if x <= 255.0 => (0.0, 255.0),
            x if x <= 511.0 => (0.0, 511.0),
            _ => (1000.0, 2000.0),
        };
        Self { low, high }
    }
}

/// Parameters for the firmware.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThrustFit {
    /// Of one rotor at full throttle and nominal voltage, N.
    pub thrust_max: f64,
    /// Share of the square law.
    pub factor: f64,
    /// Whether the record determines the curve; else the factor is the one that was there.
    pub factor_is_known: bool,
    /// One deviation of the factor.
    pub factor_sd: f64,
    /// Time constant of the thrust, s.
    pub lag: f64,
    /// What is left, N rms.
    pub residual: f64,
    /// Over the mean thrust of the record, what the parameters before would have given, minus one.
    pub error_before: f64,
    /// Whether the battery's voltage was in the record.
    pub has_voltage: bool,
}

struct Regressors {
    square: Vec<f64>,
    linear: Vec<f64>,
    thrust: Vec<f64>,
}

fn lagged(x: &[f64], lag: f64) -> Vec<f64> {
    let keep = (-1.0 / (RATE * lag)).exp();
    let first = x.first().copied().unwrap_or(0.0);
    let moved: Vec<f64> = x.iter().map(|x| x - first).collect();
    rational(&[1.0 - keep], &[1.0, -keep], &moved).iter().map(|x| x + first).collect()
}

/// Fits the map.
///
/// # Errors
/// A PWM range that the record leaves, or a record that does not excite it.
pub fn fit_thrust_map(
    record: &Record,
    range: PwmRange,
    before: &Params,
) -> Result<ThrustFit, String> {
    let span = range.high - range.low;
    if !(span.is_finite() && span > 0.0) {
        return Err(format!("PWM range {} to {}: empty", range.low, range.high));
    }
    let channels: Vec<Vec<f64>> = record
        .pwm
        .iter()
        .map(|pwm| resample(&record.time, pwm).iter().map(|x| (x - range.low) / span).collect())
        .collect();
    let outside = channels.iter().flatten().find(|u| **u < -0.05 || **u > 1.05);
    if let Some(u) = outside {
        let value = range.low + u * span;
        return Err(format!("PWM {value:.0} outside {} to {}", range.low, range.high));
    }
    let nominal = f64::from(before.nominal_voltage);
    let sag: Vec<f64> = match &record.voltage {
        Some(voltage) if nominal > 1.0 => {
            resample(&record.time, voltage).iter().map(|v| (v / nominal).powi(2)).collect()
        }
        _ => vec![1.0; channels.first().map_or(0, Vec::len)],
    };
    let sum = |power: i32| -> Vec<f64> {
        sag.iter()
            .enumerate()
            .map(|(t, sag)| sag * channels.iter().map(|u| u[t].max(0.0).powi(power)).sum::<f64>())
            .collect()
    };
    let data = Regressors {
        square: sum(2),
        linear: sum(1),
        thrust: low_pass_channel(&resample(&record.time, &record.thrust))?,
    };
    let lag = search(|lag| solve(&data, lag, None).map_or(f64::MAX, |s| s.residual))?;
    let free = solve(&data, lag, None).ok_or("the record does not excite the thrust map")?;
    let old = f64::from(before.thrust_factor);
    let known = free.factor_sd <= FACTOR_KNOWN && (0.0..=1.0).contains(&free.factor);
    let used = if known {
        free
    } else {
        let with = |lag| solve(&data, lag, Some(old));
        let lag = search(|lag| with(lag).map_or(f64::MAX, |s| s.residual))?;
        with(lag).ok_or("the record does not excite the thrust map")?
    };
    let n = data.thrust.len() as f64;
    let mean = data.thrust.iter().sum::<f64>() / n;
    let expected = f64::from(before.rotor_thrust_max) * f64::from(before.thrust_scale) / n
        * data.square.iter().zip(&data.linear).map(|(q, l)| old * q + (1.0 - old) * l).sum::<f64>();
    Ok(ThrustFit {
        thrust_max: used.thrust_max,
        factor: used.factor,
        factor_is_known: known,
        factor_sd: free.factor_sd,
        lag: used.lag,
        residual: used.residual,
        error_before: mean / expected - 1.0,
        has_voltage: record.voltage.is_some(),
    })
}

#[derive(Clone, Copy)]
struct Solved {
    thrust_max: f64,
    factor: f64,
    factor_sd: f64,
    lag: f64,
    residual: f64,
}

/// Least squares at a lag; a given factor leaves the maximum alone.
fn solve(data: &Regressors, lag: f64, factor: Option<f64>) -> Option<Solved> {
    let prepared = |x: &[f64]| low_pass_channel(&lagged(x, lag)).ok();
    let (square, linear) = (prepared(&data.square)?, prepared(&data.linear)?);
    let rows = data.thrust.len();
    let y = DVector::from_column_slice(&data.thrust);
    let design = match factor {
        None => DMatrix::from_fn(rows, 2, |r, c| if c == 0 { square[r] } else { linear[r] }),
        Some(f) => DMatrix::from_fn(rows, 1, |r, _| f * square[r] + (1.0 - f) * linear[r]),
    };
    let theta = least_squares(design.clone(), &y)?;
    let off = &y - &design * &theta;
    let variance = off.norm_squared() / rows as f64;
    let (thrust_max, factor, factor_sd) = match factor {
        Some(f) => (theta[0], f, 0.0),
        None => {
            let total = theta[0] + theta[1];
            let cov = (design.transpose() * &design).try_inverse()? * (variance / INDEPENDENT);
            // f = a/(a+b): its gradient is (b, -a)/(a+b)².
            let gradient = DVector::from_vec(vec![theta[1], -theta[0]]) / (total * total);
            (total, theta[0] / total, (gradient.transpose() * cov * &gradient)[0].sqrt())
        }
    };
    let plausible = thrust_max > 0.0 && thrust_max.is_finite();
    plausible.then_some(Solved { thrust_max, factor, factor_sd, lag, residual: variance.sqrt() })
}

/// Golden-section search over the lag, in its logarithm.
fn search(cost: impl Fn(f64) -> f64) -> Result<f64, String> {
    const SHARE: f64 = 0.618_033_988_749_894_9;
    let [mut low, mut high] = LAGS.map(f64::ln);
    for _ in 0..28 {
        let (a, b) = (high - SHARE * (high - low), low + SHARE * (high - low));
        if cost(a.exp()) < cost(b.exp()) {
            high = b;
        } else {
            low = a;
        }
    }
    let lag = ((low + high) / 2.0).exp();
    if cost(lag) < f64::MAX { Ok(lag) } else { Err("no lag fits the record".into()) }
}

impl ThrustFit {
    /// Name and value of each parameter that it settles.
    #[must_use]
    pub fn parameters(&self) -> [(&'static str, f64); 4] {
        [
            ("MOT_THR_MAX", self.thrust_max),
            ("THR_MDL_FAC", self.factor),
            ("MOT_TAU", self.lag),
            // The scale corrected the map that this one replaces.
            ("THR_SCALE", 1.0),
        ]
    }
}
