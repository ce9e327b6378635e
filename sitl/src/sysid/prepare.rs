//! Resample, low-pass, split, subtract means. `localization` section 8.

use super::record::{CHANNELS, Record};
use iir_filters::filter::{DirectForm2Transposed, Filter};
use iir_filters::filter_design::{FilterType, butter};
use iir_filters::sos::{Sos, zpk2sos};

/// Hz.
pub const RATE: f64 = 100.0;
const ORDER: u32 = 5;
const CUT_OFF: f64 = 10.0;

/// Inputs and output on one clock.
#[derive(Clone, Debug, PartialEq)]
pub struct Signals {
    /// PWM of each motor, or anything that is an input.
    pub inputs: Vec<Vec<f64>>,
    /// Thrust, N.
    pub output: Vec<f64>,
}

/// Estimation and validation halves, the estimation's means taken off both.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// First half.
    pub estimation: Signals,
    /// Second half.
    pub validation: Signals,
    /// Inputs, then output.
    pub means: Vec<f64>,
    /// Whole and filtered, means and all.
    pub filtered: Signals,
    /// Before the filter.
    pub resampled: Signals,
}

impl Signals {
    /// Samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.output.len()
    }
    /// None.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.output.is_empty()
    }
    /// Inputs, then output.
    pub fn channels(&self) -> impl Iterator<Item = &Vec<f64>> {
        self.inputs.iter().chain([&self.output])
    }
    /// The same work on each channel.
    pub fn map(&self, mut work: impl FnMut(usize, &[f64]) -> Vec<f64>) -> Self {
        let inputs: Vec<_> = self.inputs.iter().enumerate().map(|(i, x)| work(i, x)).collect();
        let output = work(inputs.len(), &self.output);
        Self { inputs, output }
    }
}

/// Linear interpolation on a clock of 100 Hz from the first sample on.
#[must_use]
pub fn resample(time: &[f64], values: &[f64]) -> Vec<f64> {
    let (Some(first), Some(last)) = (time.first(), time.last()) else { return Vec::new() };
    let count = ((last - first) * RATE + 1e-6).floor() as usize + 1;
    let mut at = 0;
    (0..count)
        .map(|k| {
            let t = first + k as f64 / RATE;
            while at + 2 < time.len() && time[at + 1] < t {
                at += 1;
            }
            let (t0, t1) = (time[at], time[at + 1]);
            let share = ((t - t0) / (t1 - t0)).clamp(0.0, 1.0);
            values[at] + (values[at + 1] - values[at]) * share
        })
        .collect()
}

/// The low-pass as second-order sections.
///
/// # Errors
/// The filter design's error; not for these constants.
fn low_pass() -> Result<Sos, String> {
    let zpk = butter(ORDER, FilterType::LowPass(CUT_OFF), RATE).map_err(|e| e.to_string())?;
    zpk2sos(&zpk, None).map_err(|e| e.to_string())
}

/// Causal, from the steady state at the first sample: with unit gain at rest that is the filter from
/// rest over what differs from that sample.
fn filter(sos: &Sos, values: &[f64]) -> Vec<f64> {
    let mut filter = DirectForm2Transposed::new(sos);
    let first = values.first().copied().unwrap_or(0.0);
    values.iter().map(|x| first + filter.filter(x - first)).collect()
}

/// One channel through the low-pass.
///
/// # Errors
/// The filter design's error.
pub fn low_pass_channel(values: &[f64]) -> Result<Vec<f64>, String> {
    Ok(filter(&low_pass()?, values))
}

/// All of it.
///
/// # Errors
/// The filter design's error.
pub fn prepare(record: &Record) -> Result<Prepared, String> {
    let resampled = Signals {
        inputs: record.pwm[..CHANNELS].iter().map(|x| resample(&record.time, x)).collect(),
        output: resample(&record.time, &record.thrust),
    };
    let sos = low_pass()?;
    let filtered = resampled.map(|_, x| filter(&sos, x));
    let half = filtered.len() / 2;
    let means: Vec<f64> =
        filtered.channels().map(|x| x[..half].iter().sum::<f64>() / half as f64).collect();
    let part = |from: usize, to: usize| {
        filtered.map(|i, x| x[from..to].iter().map(|x| x - means[i]).collect())
    };
    Ok(Prepared {
        estimation: part(0, half),
        validation: part(half, filtered.len()),
        means,
        filtered,
        resampled,
    })
}
