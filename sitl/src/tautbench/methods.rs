//! The firmware's own methods over a flight's recorded inputs, in open loop: what each says goes the way of a stranger's
//! estimates.
//!
//! All of them run on what the firmware's sense stage reports. The articles' filters have the attitude of the simple
//! firmware, which knows as little as they do; the thrust that acts is the recorded flight's.

use super::columns::Table;
use super::data::About;
use super::estimates::{Estimate, columns};
use super::record::{TRUTH_EVERY, time_s};
use crate::flight::tape::{Begin, Item};
use crate::flight::{Autopilot, Shadow, ShadowEstimators};
use crate::plant::V3;
use nalgebra::{Quaternion, Vector3};
use tautline_firmware::estimate::tether_angle::{
    TetherAngleEstimator, TetherAngleEstimatorState, TetherAnglesState,
};
use tautline_firmware::frames::{Attitude, Body};
use tautline_firmware::signal::Imu;
use tautline_firmware::supervisor::GroundState;
use tautline_firmware::vehicle::StepOutput;

/// Milliseconds of an outer step.
const OUTER: u32 = 4;
/// The tether-angle filter starts from a place that is known, at such a height, m.
const START_HEIGHT: f32 = 1.0;

/// A row of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// The firmware's, with `EST_KIND` 1.
    FullState,
    /// The firmware's, with `EST_KIND` 0.
    Simple,
    /// \[TF15\] and \[TF17\] share it.
    HighGain,
    /// \[LD13\].
    TetherAngle,
    /// \[RS21\], four states.
    Ekf4,
    /// \[RS21\], three states and the tension that the winch is asked for.
    Ekf3,
    /// \[RS21\], the authors' earlier method.
    LowPass,
    /// 17 states, ours, on the model of \[RS21\].
    ErrorState,
    /// \[YR25\].
    Pendulum,
}

impl Method {
    /// In the order of the table.
    pub const ALL: [Self; 9] = [
        Self::FullState,
        Self::Simple,
        Self::HighGain,
        Self::TetherAngle,
        Self::Ekf4,
        Self::Ekf3,
        Self::LowPass,
        Self::ErrorState,
        Self::Pendulum,
    ];

    /// In tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::FullState => "full-state filter",
            Self::Simple => "simple filter",
            Self::HighGain => "[TF15], [TF17] high-gain observer",
            Self::TetherAngle => "[LD13] tether-angle filter",
            Self::Ekf4 => "[RS21] 4-state filter",
            Self::Ekf3 => "[RS21] 3-state filter",
            Self::LowPass => "[RS21] low-pass solution",
            Self::ErrorState => "17-state filter",
            Self::Pendulum => "[YR25] pendulum filter",
        }
    }

    /// Why it says nothing of a flight, if so.
    #[must_use]
    pub fn why_not(self, about: &About) -> Option<&'static str> {
        match self {
            Self::HighGain | Self::TetherAngle if about.has_winch => {
                Some("its model is a link of known, constant length")
            }
            Self::Pendulum => Some(
                "it knows a load on a rod in free flight, by motion capture of both: there is no line and no anchor in its model",
            ),
            _ => None,
        }
    }

    fn shadow(self) -> Option<Shadow> {
        match self {
            Self::Ekf4 => Some(Shadow::Ekf4),
            Self::Ekf3 => Some(Shadow::Ekf3),
            Self::LowPass => Some(Shadow::LowPass),
            Self::ErrorState => Some(Shadow::ErrorState),
            _ => None,
        }
    }
}

/// What those methods that apply say of a flight.
///
/// # Errors
/// One line: no start in the stream, or parameters that this build does not know.
pub fn run(items: &[Item], about: &About) -> Result<Vec<(Method, Table)>, String> {
    let applies = |method: &Method| method.why_not(about).is_none();
    let mut said: Vec<_> = Method::ALL
        .into_iter()
        .filter(applies)
        .map(|method| (method, Table::new(columns())))
        .collect();
    let mut running = None;
    let mut step = 0_u64;
    for item in items {
        let input = match item {
            Item::Begin(begin) => {
                running = Some(Running::start(begin)?);
                continue;
            }
            Item::Step(input, _) => input,
        };
        let running = running.as_mut().ok_or("the stream has no start")?;
        running.flown.step(input);
        running.flown.maintain();
        running.other.step(input);
        running.other.maintain();
        running.other.follow(&running.flown);
        running.observe();
        step += 1;
        if step.is_multiple_of(TRUTH_EVERY) {
            for (method, table) in &mut said {
                table.rows.push(running.estimate(*method).row(time_s(step)));
            }
        }
    }
    Ok(said)
}

/// Everything that runs, since the last start of the firmware.
struct Running {
    flown: Autopilot,
    /// The same with the other position filter.
    other: Autopilot,
    flies_simple: bool,
    shadows: ShadowEstimators,
    angle: Option<Angle>,
}

/// The tether-angle filter, and the outer step that is being averaged.
struct Angle {
    filter: TetherAngleEstimator<f32>,
    state: Option<TetherAngleEstimatorState<f32>>,
    sum: Imu,
    samples: u32,
    length: f32,
}

fn nothing() -> Imu {
    Imu { gyro: Body(Vector3::zeros()), accel: Body(Vector3::zeros()) }
}

impl Running {
    fn start(begin: &Begin) -> Result<Self, String> {
        let params = begin.params()?;
        let flies_simple = params.estimator_kind < 0.5;
        let mut others = params;
        others.estimator_kind = f32::from(u8::from(flies_simple));
        let start = |params| Autopilot::new(begin.scalar, params, begin.scale);
        let angle = TetherAngleEstimator::try_new(&params).ok().map(|filter| Angle {
            filter,
            state: None,
            sum: nothing(),
            samples: 0,
            length: params.tether_length,
        });
        Ok(Self {
            flown: start(params),
            other: start(others),
            flies_simple,
            shadows: ShadowEstimators::new(&params),
            angle,
        })
    }

    fn simple(&self) -> &StepOutput {
        if self.flies_simple { self.flown.output() } else { self.other.output() }
    }

    fn full(&self) -> &StepOutput {
        if self.flies_simple { self.other.output() } else { self.flown.output() }
    }

    /// Those beside, with what the simple firmware knows and the winch that was flown.
    fn observe(&mut self) {
        let seen = StepOutput { actuation: self.flown.output().actuation, ..*self.simple() };
        self.shadows.step(&seen, |_| true);
        if let Some(angle) = &mut self.angle {
            angle.step(&seen);
        }
    }

    fn estimate(&self, method: Method) -> Estimate {
        match method {
            Method::FullState => of_firmware(self.full()),
            Method::Simple => of_firmware(self.simple()),
            Method::HighGain => of_observer(self.simple()),
            Method::TetherAngle => {
                let attitude = &self.simple().estimate.attitude;
                self.angle.as_ref().and_then(|angle| angle.estimate(attitude)).unwrap_or_default()
            }
            _ => method.shadow().and_then(|shadow| self.of_shadow(shadow)).unwrap_or_default(),
        }
    }

    fn of_shadow(&self, shadow: Shadow) -> Option<Estimate> {
        let record = self.shadows.record(shadow, 0)?;
        let position = V3::from(record.position.map(f64::from));
        // A filter that has run away says nothing.
        let is_finite = position.iter().all(|x| x.is_finite()) && record.tension.is_finite();
        is_finite.then(|| Estimate {
            position: Some(position),
            position_sigma: sigma(V3::from(record.position_sd.map(f64::from))),
            // What is fed into it is no estimate of its own.
            tension: (shadow != Shadow::Ekf3).then(|| f64::from(record.tension)),
            ..Estimate::default()
        })
    }
}

/// Deviations, unless there are none.
fn sigma(sd: V3) -> Option<V3> {
    sd.iter().all(|x| x.is_finite() && *x > 0.0).then_some(sd)
}

fn of_firmware(out: &StepOutput) -> Estimate {
    let estimate = &out.estimate;
    let [w, x, y, z] = estimate.attitude.quaternion().map(f64::from);
    Estimate {
        position: estimate.position.map(|position| position.0.map(f64::from)),
        position_sigma: sigma(estimate.position_sd.map(f64::from)),
        tension: estimate.tether.map(|tether| f64::from(tether.tension)),
        attitude: Some(Quaternion::new(w, x, y, z)),
        ..Estimate::default()
    }
}

/// Elevation from whichever side of the anchor, and the pull.
fn of_observer(out: &StepOutput) -> Estimate {
    let Some(taut) = &out.taut else { return Estimate::default() };
    let elevation = f64::from(taut.planar.elevation);
    Estimate {
        elevation: Some(elevation.sin().asin()).filter(|x| x.is_finite()),
        tension: Some(f64::from(taut.link_force)).filter(|x| x.is_finite()),
        ..Estimate::default()
    }
}

impl Angle {
    fn step(&mut self, seen: &StepOutput) {
        let estimate = &seen.estimate;
        if !matches!(seen.ground, GroundState::InAir | GroundState::Landing) {
            self.state = None;
            return;
        }
        if let Some(imu) = seen.sensors.imu {
            self.sum.gyro.0 += imu.value.gyro.0 - estimate.gyro_bias.0;
            self.sum.accel.0 += imu.value.accel.0;
            self.samples += 1;
        }
        if self.samples < OUTER {
            return;
        }
        let mean = 1.0 / self.samples as f32;
        let imu = Imu { gyro: Body(self.sum.gyro.0 * mean), accel: Body(self.sum.accel.0 * mean) };
        (self.sum, self.samples) = (nothing(), 0);
        let is_taut = estimate.tether.is_some_and(|tether| tether.is_taut);
        match (&mut self.state, &estimate.position) {
            (Some(state), _) => {
                self.filter.step(state, &imu, estimate.thrust, &estimate.attitude);
            }
            (None, Some(position)) if is_taut && estimate.height > START_HEIGHT => {
                let attitude = &estimate.attitude;
                self.state = Some(self.filter.start(position, attitude, &imu, estimate.thrust));
            }
            _ => {}
        }
    }

    fn estimate(&self, attitude: &Attitude<f32>) -> Option<Estimate> {
        let seen = self.filter.estimate(self.state.as_ref()?, attitude);
        let planes = TetherAnglesState { planes: seen.planes };
        let [north, west, up] = planes.direction().map(f64::from).into();
        let position = V3::new(north, -west, -up) * f64::from(self.length);
        let is_known = seen.is_running() && position.iter().all(|x| x.is_finite());
        is_known.then(|| Estimate {
            position: Some(position),
            tension: Some(f64::from(seen.tension)).filter(|x| x.is_finite()),
            ..Estimate::default()
        })
    }
}
