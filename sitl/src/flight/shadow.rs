//! Shadow estimators: the self-localisation filters run on what the firmware's sense stage reports, for
//! the log; nothing flies on them.

use tautline_firmware::estimate::localization::{
    ErrorState, ErrorStateFilter, ErrorStateMeasurement, ErrorStateNoise, ErrorStateStart,
    LowPassLocator, LowPassState, NoiseReading, article_ekf, article_start,
};
use tautline_firmware::estimate::{Ekf4, Ekf4Measurement, Ekf4State};
use tautline_firmware::frames::{Attitude, Body, V3};
use tautline_firmware::log::topics::EstimatorPosition;
use tautline_firmware::param::Params;
use tautline_firmware::supervisor::GroundState;
use tautline_firmware::vehicle::StepOutput;

/// Milliseconds between two steps of the position filters, as the firmware's own, and of the error-state
/// filter, which costs forty times as much.
const PERIOD: u32 = 4;
const SLOW_PERIOD: u32 = 20;
/// Lower, the vehicle may still stand, m.
const CLEAR: f64 = 0.6;

/// A filter that can run beside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Shadow {
    /// The firmware's own simple filter, on the same inputs
    Simple,
    /// The article's with the tension known, from winch or mode
    Ekf3,
    /// The article's with the tension estimated
    Ekf4,
    /// The article's low-pass solution
    LowPass,
    /// The article's error-state filter
    ErrorState,
}

impl Shadow {
    /// Its topic in the log.
    #[must_use]
    pub fn topic(self) -> &'static str {
        match self {
            Self::Simple => "estimator_simple",
            Self::Ekf3 => "estimator_ekf3",
            // The firmware's own has the plain name.
            Self::Ekf4 => "estimator_ekf4_article",
            Self::LowPass => "estimator_low_pass",
            Self::ErrorState => "estimator_error_state",
        }
    }
}

/// The filters, and their states while in the air.
#[derive(Debug)]
pub struct ShadowEstimators {
    mass: f64,
    has_winch: bool,
    ekf3: Ekf4<f64>,
    ekf4: Ekf4<f64>,
    low_pass: LowPassLocator<f64>,
    error_state: ErrorStateFilter<f64>,
    flying: Option<Flying>,
    step: u32,
}

/// Since the last lift-off.
#[derive(Debug)]
struct Flying {
    three: Ekf4State<f64>,
    four: Ekf4State<f64>,
    low: LowPassState<f64>,
    start: ErrorStateStart<f64>,
    error_state: Option<ErrorState<f64>>,
    accel: V3<f64>,
    gyro: V3<f64>,
    samples: f64,
    altitude: [Option<f64>; 2],
}

fn wide(v: &V3<f32>) -> V3<f64> {
    v.map(f64::from)
}

impl ShadowEstimators {
    /// For a vehicle's parameters.
    #[must_use]
    pub fn new(p: &Params) -> Self {
        let mass = f64::from(p.mass);
        let deviation = |variance: f32| f64::from(variance).sqrt();
        let noise = ErrorStateNoise {
            // Behind the vehicle's own low-pass, averaged over the period.
            accel: 0.5,
            gyro: 0.01,
            altitude: deviation(p.ekf_r_altitude),
            attitude: 0.02,
            length: deviation(p.ekf_r_length),
            // The pull changes in flight; the article's is constant.
            tension_walk: 1.0,
            ..ErrorStateNoise::simulated()
        };
        Self {
            mass,
            has_winch: p.tether_kind.round() as i32 == 1,
            ekf3: article_ekf(mass, NoiseReading::PerStep, true),
            ekf4: article_ekf(mass, NoiseReading::PerStep, false),
            low_pass: LowPassLocator::new(mass, PERIOD as f32 * 1e-3),
            error_state: ErrorStateFilter { mass, dt: f64::from(SLOW_PERIOD) * 1e-3, noise },
            flying: None,
            step: 0,
        }
    }

    /// The pull that the three-state filter takes for known: the winch's set-point, or the estimate of the
    /// mode on the taut tether.
    fn known_tension(&self, out: &StepOutput) -> Option<f64> {
        if let Some(angle) = &out.angle {
            return Some(f64::from(angle.tension));
        }
        if self.has_winch {
            return Some(f64::from(out.actuation.winch.tension));
        }
        out.taut.map(|taut| f64::from(taut.link_force))
    }

    /// One millisecond of those that are asked for.
    pub fn step(&mut self, out: &StepOutput, is_asked: impl Fn(Shadow) -> bool) {
        self.step = self.step.wrapping_add(1);
        let in_air = matches!(out.ground, GroundState::InAir | GroundState::Landing);
        let height = f64::from(out.estimate.height);
        if !in_air || height < CLEAR {
            self.flying = None;
            return;
        }
        let gyro_bias = wide(&out.estimate.gyro_bias.0);
        let flying = self.flying.get_or_insert_with(|| Flying {
            three: article_start(Some(1.0)),
            four: article_start(None),
            low: LowPassState::default(),
            start: ErrorStateStart::default(),
            error_state: None,
            accel: V3::zeros(),
            gyro: V3::zeros(),
            samples: 0.0,
            altitude: [None; 2],
        });
        if let Some(altitude) = out.sensors.altitude {
            flying.altitude = [Some(f64::from(altitude.value)); 2];
        }
        let Some(imu) = out.sensors.imu else { return };
        flying.accel += wide(&imu.value.accel.0);
        flying.gyro += wide(&imu.value.gyro.0) - gyro_bias;
        flying.samples += 1.0;
        let known = self.known_tension(out);
        let Some(flying) = &mut self.flying else { return };
        let [altitude, slow_altitude] = &mut flying.altitude;
        let cable = |accel: V3<f64>, altitude: Option<f64>| Ekf4Measurement {
            attitude: Attitude(out.estimate.attitude.0.map(f64::from)),
            accel: Body(accel),
            thrust: f64::from(out.estimate.thrust),
            altitude,
            length: None,
        };
        if self.step.is_multiple_of(PERIOD) {
            let z = cable(wide(&imu.value.accel.0), altitude.take());
            if let Some(tension) = known {
                flying.three.x.w = tension;
            }
            // A refused step keeps the state; nothing flies on it.
            if is_asked(Shadow::Ekf3) {
                let _ = self.ekf3.step(&mut flying.three, &z);
            }
            if is_asked(Shadow::Ekf4) {
                let _ = self.ekf4.step(&mut flying.four, &z);
            }
            if is_asked(Shadow::LowPass) {
                let _ = self.low_pass.step(&mut flying.low, &z);
            }
        }
        if self.step.is_multiple_of(SLOW_PERIOD) && is_asked(Shadow::ErrorState) {
            let mean = 1.0 / flying.samples;
            let z = ErrorStateMeasurement {
                cable: cable(flying.accel * mean, slow_altitude.take()),
                gyro: Body(flying.gyro * mean),
            };
            (flying.accel, flying.gyro, flying.samples) = (V3::zeros(), V3::zeros(), 0.0);
            match &mut flying.error_state {
                None => {
                    let noise = self.error_state.noise.accel;
                    flying.error_state = flying.start.step(self.mass, noise, &z);
                }
                Some(x) => {
                    if let Ok(step) = self.error_state.correct(x, &z) {
                        self.error_state.predict(x, &z, &step);
                    }
                }
            }
        }
    }

    /// What one estimates now; `None` on the ground, and before it has started.
    #[must_use]
    pub fn record(&self, shadow: Shadow, timestamp: u64) -> Option<EstimatorPosition> {
        let flying = self.flying.as_ref()?;
        let three = |v: V3<f64>| -> [f32; 3] { v.map(|x| x as f32).into() };
        let record = |position: V3<f64>, sd: V3<f64>, tension: f64| EstimatorPosition {
            timestamp,
            position: three(position),
            position_sd: three(sd),
            tension: tension as f32,
            tension_is_negative: tension < 0.0,
        };
        let filter = |x: &Ekf4State<f64>| {
            let c = x.covariance.diagonal();
            record(x.position(), V3::new(c.x, c.y, c.z).map(f64::sqrt), x.tension())
        };
        match shadow {
            // A whole firmware: see `beside.rs`.
            Shadow::Simple => None,
            Shadow::Ekf3 => Some(filter(&flying.three)),
            Shadow::Ekf4 => Some(filter(&flying.four)),
            Shadow::LowPass => {
                flying.low.solution.map(|at| record(at.position.0, V3::zeros(), at.tension))
            }
            Shadow::ErrorState => flying
                .error_state
                .map(|x| record(x.position.0, V3::from_fn(|i, _| x.deviation(i)), x.tension)),
        }
    }
}
