//! All estimators over one record, against its truth.

use super::generate::{DT, Sample};
use crate::metrics::Spread;
use crate::plant::V3;
use tautline_firmware::estimate::localization::{
    ErrorState, ErrorStateFilter, ErrorStateMeasurement, ErrorStateNoise, ErrorStateStart,
    LowPassLocator, LowPassState, NoiseReading, article_ekf, article_start,
};
use tautline_firmware::estimate::{Ekf4, Ekf4Measurement, Ekf4State};
use tautline_firmware::frames::{Attitude, Body};
use tautline_firmware::math::GRAVITY;

/// Figures count from here on, s.
pub const SETTLED: f64 = 5.0;
/// Names, in the order of [`Outcome::tracks`].
pub const ESTIMATORS: [&str; 6] = [
    "3-state",
    "4-state",
    "4-state, Q times period",
    "low-pass",
    "error-state",
    "error-state, length",
];

/// An estimator's output at a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fix {
    /// NED, m.
    pub position: V3,
    /// One deviation, m; zero where the estimator has none.
    pub deviation: V3,
    /// N, once there is one.
    pub tension: Option<f64>,
}

/// Root mean squares.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Accuracy {
    /// North, east, down, m.
    pub axes: [f64; 3],
    /// N.
    pub tension: f64,
}

impl Accuracy {
    /// In three dimensions, m.
    #[must_use]
    pub fn distance(&self) -> f64 {
        self.axes.iter().map(|x| x * x).sum::<f64>().sqrt()
    }
}

/// One estimator over the record.
#[derive(Clone, Debug)]
pub struct Track {
    /// Sample by sample.
    pub fixes: Vec<Fix>,
    /// From the start.
    pub whole: Accuracy,
    /// From 5 s on.
    pub settled: Accuracy,
    /// Share of position errors within three deviations from 5 s on, worst axis.
    pub covered: f64,
}

/// What is run, beside the record.
#[derive(Clone, Copy, Debug)]
pub struct Setup {
    /// kg.
    pub mass: f64,
    /// True tension, N, for the three-state filter and the errors.
    pub tension: f64,
    /// Of the error-state filter.
    pub noise: ErrorStateNoise<f64>,
}

/// The error-state filter at the end of the record.
pub type Last = Option<ErrorState<f64>>;

/// Every estimator.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// As [`ESTIMATORS`].
    pub tracks: [Track; 6],
    /// The 4-state filter at its end.
    pub ekf4: Ekf4State<f64>,
    /// The error-state filter without length at its end.
    pub eskf: Last,
}

/// A sample as the core takes it.
#[must_use]
pub fn measurement(s: &Sample, with_length: bool) -> ErrorStateMeasurement<f64> {
    ErrorStateMeasurement {
        cable: Ekf4Measurement {
            attitude: Attitude::from_euler(s.euler.x, s.euler.y, s.euler.z),
            accel: Body(s.accel * GRAVITY),
            thrust: s.thrust,
            altitude: Some(s.altitude),
            length: with_length.then_some(s.length),
        },
        gyro: Body(s.gyro),
    }
}

/// Runs them all.
#[must_use]
pub fn run(samples: &[Sample], setup: &Setup) -> Outcome {
    let article = |reading, known| article_ekf(setup.mass, reading, known);
    let known = Some(setup.tension);
    let (three, _) = ekf(samples, article(NoiseReading::PerStep, true), article_start(known));
    let (four, ekf4) = ekf(samples, article(NoiseReading::PerStep, false), article_start(None));
    let scaled = article(NoiseReading::TimesPeriod(DT), false);
    let (times, _) = ekf(samples, scaled, article_start(None));
    let (plain, eskf) = error_state(samples, setup, false);
    let (length, _) = error_state(samples, setup, true);
    let fixes = [three, four, times, low_pass(samples, setup.mass), plain, length];
    Outcome { tracks: fixes.map(|fixes| track(samples, setup, fixes)), ekf4, eskf }
}

fn ekf(samples: &[Sample], filter: Ekf4<f64>, start: Ekf4State<f64>) -> (Vec<Fix>, Ekf4State<f64>) {
    let mut state = start;
    let fixes = samples.iter().map(|s| {
        // A refused step keeps the state; the error shows in the figures.
        let _ = filter.step(&mut state, &measurement(s, false).cable);
        let c = state.covariance.diagonal();
        Fix {
            position: state.position(),
            deviation: V3::new(c.x, c.y, c.z).map(f64::sqrt),
            tension: Some(state.tension()),
        }
    });
    (fixes.collect(), state)
}

fn low_pass(samples: &[Sample], mass: f64) -> Vec<Fix> {
    let filter = LowPassLocator::new(mass, DT as f32);
    let mut state = LowPassState::default();
    let fixes = samples.iter().map(|s| {
        let _ = filter.step(&mut state, &measurement(s, false).cable);
        Fix {
            position: state.solution.map_or(V3::zeros(), |at| at.position.0),
            tension: state.solution.map(|at| at.tension),
            ..Fix::default()
        }
    });
    fixes.collect()
}

fn error_state(samples: &[Sample], setup: &Setup, with_length: bool) -> (Vec<Fix>, Last) {
    let filter = ErrorStateFilter { mass: setup.mass, dt: DT, noise: setup.noise };
    let mut start = ErrorStateStart::default();
    let mut state: Last = None;
    let mut last = None;
    let fixes = samples.iter().map(|s| {
        let z = measurement(s, with_length);
        if state.is_none() {
            state = start.step(setup.mass, setup.noise.accel, &z);
        }
        let Some(x) = &mut state else {
            return Fix { position: V3::new(0.0, 0.0, -s.altitude), ..Fix::default() };
        };
        let step = filter.correct(x, &z);
        last = Some(*x);
        let fix = Fix {
            position: x.position.0,
            deviation: V3::from_fn(|i, _| x.deviation(i)),
            tension: Some(x.tension),
        };
        if let Ok(step) = step {
            filter.predict(x, &z, &step);
        }
        fix
    });
    (fixes.collect(), last)
}

fn track(samples: &[Sample], setup: &Setup, fixes: Vec<Fix>) -> Track {
    let mut spreads = [[Spread::default(); 4]; 2];
    let (mut inside, mut count) = ([0_u32; 3], 0_u32);
    for (s, fix) in samples.iter().zip(&fixes) {
        let off = fix.position - s.truth;
        let settled = s.time >= SETTLED;
        let from = if settled { 2 } else { 1 };
        for spread in spreads.iter_mut().take(from) {
            let tension = fix.tension.map(|tension| tension - setup.tension);
            for (spread, e) in spread.iter_mut().zip(off.iter().copied().chain(tension)) {
                spread.add(e);
            }
        }
        if settled {
            count += 1;
            for (inside, (e, sd)) in inside.iter_mut().zip(off.iter().zip(fix.deviation.iter())) {
                *inside += u32::from(e.abs() <= 3.0 * sd);
            }
        }
    }
    let accuracy = |s: &[Spread; 4]| {
        let [n, e, d, tension] = s.map(|s| s.rms().unwrap_or(f64::NAN));
        Accuracy { axes: [n, e, d], tension }
    };
    let [whole, settled] = &spreads;
    let covered = inside.iter().min().map_or(0.0, |n| f64::from(*n) / f64::from(count.max(1)));
    Track { whole: accuracy(whole), settled: accuracy(settled), covered, fixes }
}
