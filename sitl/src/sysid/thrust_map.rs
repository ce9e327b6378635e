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

/// A mean voltage so far off the nominal one, share, is another battery's.
const VOLTAGE_FAR: f64 = 0.2;
/// What the curve may leave of the mean thrust, share.
const RESIDUAL_LARGE: f64 = 0.05;
/// By how much a wrong lag must be worse, in variances of a right one.
const LAG_DOUBT: f64 = 10.0;
pub(super) const UNEXCITED: &str = "the record does not excite the thrust map";

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
        Self::holding(record.pwm.iter().flatten().copied().fold(0.0, f64::max))
    }

    /// The usual one that holds this value.
    #[must_use]
    pub fn holding(largest: f64) -> Self {
        let (low, high) = match largest {
            x if x <= 1.0 => (0.0, 1.0),
            x if x <= 255.0 => (0.0, 255.0),
            x if x <= 511.0 => (0.0, 511.0),
            _ => (1000.0, 2000.0),
        };
        Self { low, high }
    }

    /// Throttle of each value.
    ///
    /// # Errors
    /// An empty range, or a value outside it.
    pub(super) fn throttle(self, values: &[f64]) -> Result<Vec<f64>, String> {
        let span = self.high - self.low;
        if !(span.is_finite() && span > 0.0) {
            return Err(format!("PWM range {} to {}: empty", self.low, self.high));
        }
        let throttle: Vec<f64> = values.iter().map(|x| (x - self.low) / span).collect();
        match throttle.iter().find(|u| **u < -0.05 || **u > 1.05) {
            Some(u) => {
                let value = self.low + u * span;
                Err(format!("PWM {value:.0} outside {} to {}", self.low, self.high))
            }
            None => Ok(throttle),
        }
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
    /// Time constant of the thrust, s; `None`: the record does not tell it.
    pub lag: Option<f64>,
    /// Nominal voltage that the maximum holds at, V, where it is not the one that was there.
    pub nominal_voltage: Option<f64>,
    /// Whether the vehicle's thrust scale was about the map that this one replaces.
    pub resets_scale: bool,
    /// What is left, N rms.
    pub residual: f64,
    /// Mean thrust of the record, N.
    pub mean: f64,
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
    let channels = record
        .pwm
        .iter()
        .map(|pwm| range.throttle(&resample(&record.time, pwm)))
        .collect::<Result<Vec<_>, _>>()?;
    let voltage = record.voltage.as_ref().map(|voltage| resample(&record.time, voltage));
    let rows = channels.first().map_or(0, Vec::len);
    let (sag, nominal_voltage) = sag(voltage.as_deref(), rows, before);
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
    let free = solve(&data, lag, None).ok_or(UNEXCITED)?;
    let tells = tells_lag(&data, lag, free.residual);
    let old = f64::from(before.thrust_factor);
    let known = free.factor_sd <= FACTOR_KNOWN && (0.0..=1.0).contains(&free.factor);
    let used = if known {
        free
    } else {
        let with = |lag| solve(&data, lag, Some(old));
        let lag = search(|lag| with(lag).map_or(f64::MAX, |s| s.residual))?;
        with(lag).ok_or(UNEXCITED)?
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
        lag: tells.then_some(used.lag),
        nominal_voltage,
        resets_scale: true,
        residual: used.residual,
        mean,
        error_before: mean / expected - 1.0,
        has_voltage: record.voltage.is_some(),
    })
}

/// The thrust's share at each sample that its voltage leaves, and the nominal voltage where it has to be another.
pub(super) fn sag(
    voltage: Option<&[f64]>,
    rows: usize,
    before: &Params,
) -> (Vec<f64>, Option<f64>) {
    let nominal = f64::from(before.nominal_voltage);
    let Some(voltage) = voltage.filter(|_| nominal > 1.0) else { return (vec![1.0; rows], None) };
    let mean = voltage.iter().sum::<f64>() / voltage.len().max(1) as f64;
    let is_far = (mean / nominal - 1.0).abs() > VOLTAGE_FAR;
    let used = if is_far { mean } else { nominal };
    (voltage.iter().map(|v| (v / used).powi(2)).collect(), is_far.then_some(used))
}

/// Whether a lag half as long again or shorter would fit worse than by chance; at an end of the search nothing tells it.
fn tells_lag(data: &Regressors, lag: f64, residual: f64) -> bool {
    let [shortest, longest] = LAGS;
    let count = data.thrust.len() as f64 * INDEPENDENT;
    let is_worse = |other: f64| {
        solve(data, other, None).is_none_or(|fit| {
            count * ((fit.residual / residual.max(1e-9)).powi(2) - 1.0) > LAG_DOUBT
        })
    };
    lag > 1.05 * shortest && lag < 0.95 * longest && is_worse(1.5 * lag) && is_worse(lag / 1.5)
}

#[derive(Clone, Copy)]
struct Solved {
    thrust_max: f64,
    factor: f64,
    factor_sd: f64,
    lag: f64,
    residual: f64,
}

/// The curve alone.
#[derive(Clone, Copy)]
pub(super) struct Curve {
    pub thrust_max: f64,
    pub factor: f64,
    pub factor_sd: f64,
    pub residual: f64,
}

impl Curve {
    /// Whether the points determine it.
    pub fn is_known(&self) -> bool {
        self.factor_sd <= FACTOR_KNOWN && (0.0..=1.0).contains(&self.factor)
    }

    /// Least squares; a given factor leaves the maximum alone. `informative`: share of the rows that count as points
    /// of their own.
    pub fn through(
        [square, linear, thrust]: [&[f64]; 3],
        factor: Option<f64>,
        informative: f64,
    ) -> Option<Self> {
        let rows = thrust.len();
        let y = DVector::from_column_slice(thrust);
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
                let cov = (design.transpose() * &design).try_inverse()? * (variance / informative);
                // f = a/(a+b): its gradient is (b, -a)/(a+b)².
                let gradient = DVector::from_vec(vec![theta[1], -theta[0]]) / (total * total);
                (total, theta[0] / total, (gradient.transpose() * cov * &gradient)[0].sqrt())
            }
        };
        let plausible = thrust_max > 0.0 && thrust_max.is_finite();
        plausible.then_some(Self { thrust_max, factor, factor_sd, residual: variance.sqrt() })
    }
}

/// Least squares at a lag; a given factor leaves the maximum alone.
fn solve(data: &Regressors, lag: f64, factor: Option<f64>) -> Option<Solved> {
    let prepared = |x: &[f64]| low_pass_channel(&lagged(x, lag)).ok();
    let (square, linear) = (prepared(&data.square)?, prepared(&data.linear)?);
    let curve = Curve::through([&square, &linear, &data.thrust], factor, INDEPENDENT)?;
    let Curve { thrust_max, factor, factor_sd, residual } = curve;
    Some(Solved { thrust_max, factor, factor_sd, lag, residual })
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
    pub fn parameters(&self) -> Vec<(&'static str, f64)> {
        let mut settled = vec![("MOT_THR_MAX", self.thrust_max), ("THR_MDL_FAC", self.factor)];
        settled.extend(self.nominal_voltage.map(|voltage| ("MOT_V_NOM", voltage)));
        settled.extend(self.lag.map(|lag| ("MOT_TAU", lag)));
        // The scale corrected the map that this one replaces.
        settled.extend(self.resets_scale.then_some(("THR_SCALE", 1.0)));
        settled
    }

    /// What an operator should know before he flies with it.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if let Some(voltage) = self.nominal_voltage {
            warnings.push(format!(
                "the record's voltage is far from MOT_V_NOM: the maximum holds at {voltage:.1} V, which is the new MOT_V_NOM"
            ));
        }
        let share = self.residual / self.mean.max(1e-9);
        if share > RESIDUAL_LARGE {
            warnings.push(format!(
                "the curve leaves {:.0} % of the mean thrust: a rotor that stalls, a worn battery, or a wrong PWM range",
                share * 100.0
            ));
        }
        warnings
    }
}
