//! Raw readings → [`Sensors`]: mounting, calibration, filters, checks. Runs inside the step, so the
//! simulator runs it too. NaN cannot enter: registers hold integers, and the few floats that drivers
//! compute are checked here.

mod altimeter;
mod battery;
mod calibrate;
mod check;
mod line;
mod mount;
mod radio;

pub use mount::Mounting;
pub use radio::{MODE_SLOTS, Pilot, Switches};

use crate::frames::{Body, V3, World};
use crate::math::filter::{Biquad, Biquad3State};
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::{
    Capture, Imu, ImuHealth, RawBarometer, RawBattery, RawCapture, RawImu, RawLineSensors,
    RawRadio, RawRange, RawTether, Sensors, take,
};
use crate::time::{INNER_DT, Micros, Sample};
pub use altimeter::Motion;
use altimeter::{Altimeter, AltimeterState};
use battery::{BatteryMonitor, BatteryState};
use calibrate::Calibration;
use check::{ImuCheck, ImuCheckState};
use line::{LineSense, LineState};

/// What one count of the inertial sensor means, as its driver set it up.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ImuScale {
    /// rad/s per count.
    pub gyro: f32,
    /// m/s² per count.
    pub accel: f32,
    /// Samples per second that reach the step.
    pub rate_hz: f32,
}

/// Everything that drivers may hand over at one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RawSensors {
    /// Inertial sensor.
    pub imu: Option<Sample<RawImu>>,
    /// Barometer.
    pub barometer: Option<Sample<RawBarometer>>,
    /// Rangefinder.
    pub range: Option<Sample<RawRange>>,
    /// Battery monitor.
    pub battery: Option<Sample<RawBattery>>,
    /// Ground end of the tether.
    pub tether: Option<Sample<RawTether>>,
    /// The line's own sensors.
    pub line: RawLineSensors,
    /// Motion capture of the vehicle.
    pub capture: Option<Sample<RawCapture>>,
    /// Against the ground, nose, right, down, m/s.
    pub velocity: Option<Sample<[f32; 3]>>,
    /// Motion capture of a rod on top: vehicle → load, NED, any length.
    pub rod: Option<Sample<[f32; 3]>>,
    /// A pilot's radio.
    pub radio: Option<Sample<RawRadio>>,
}

impl RawSensors {
    /// Takes what is newer. Every field by name: one that is forgotten here does not compile.
    pub fn merge(&mut self, newer: Self) {
        let Self { imu, barometer, range, battery, tether, line, capture, velocity, rod, radio } =
            newer;
        if !line.is_empty() {
            self.line.merge(line);
        }
        take(&mut self.imu, imu);
        take(&mut self.barometer, barometer);
        take(&mut self.range, range);
        take(&mut self.battery, battery);
        take(&mut self.tether, tether);
        take(&mut self.capture, capture);
        take(&mut self.velocity, velocity);
        take(&mut self.rod, rod);
        take(&mut self.radio, radio);
    }
}

/// Configuration of the stage.
#[derive(Clone, Copy, Debug)]
pub struct Sense<S: Scalar> {
    mounting: Mounting,
    mounting_is_known: bool,
    calibration: Calibration<S>,
    accel_filter: Biquad<S>,
    gyro_filter: Biquad<S>,
    notch: Biquad<S>,
    check: ImuCheck,
    altimeter: Altimeter<S>,
    battery: BatteryMonitor<S>,
    line: LineSense<S>,
}

/// What moves in the stage.
#[derive(Clone, Copy, Debug, Default)]
pub struct SenseState<S: Scalar> {
    accel_filter: Biquad3State<S>,
    gyro_filter: Biquad3State<S>,
    accel_notch: Biquad3State<S>,
    gyro_notch: Biquad3State<S>,
    check: ImuCheckState,
    /// The last reading.
    inertial: Option<Imu<S>>,
    altimeter: AltimeterState<S>,
    battery: BatteryState<S>,
    line: LineState<S>,
    tether_at: Option<Micros>,
    temperature: f32,
}

/// No motion capture sees farther, m.
const CAPTURE_FAR: f32 = 1e4;
/// A tether length older than this counts as lost.
const TETHER_TIMEOUT_US: u64 = 500_000;

fn finite<S: Scalar>(v: [f32; 3]) -> Option<World<V3<S>>> {
    v.iter().all(|x| x.is_finite()).then(|| World(V3::from(v.map(S::from_f32))))
}

fn captured<S: Scalar>(sample: Sample<RawCapture>) -> Option<Sample<Capture<S>>> {
    let position = finite(sample.value.position)
        .filter(|_| sample.value.position.iter().all(|x| x.abs() < CAPTURE_FAR))?;
    let heading = sample.value.heading.filter(|x| x.abs() < 100.0).map(S::from_f32);
    Some(Sample { at: sample.at, value: Capture { position, heading } })
}

impl<S: Scalar> Sense<S> {
    /// From the parameters and the driver's scale.
    #[must_use]
    #[inline(never)]
    pub fn new(params: &Params, scale: ImuScale) -> Self {
        let mounting = Mounting::from_parameter(params.board_rotation);
        let calibration = Calibration::new(params, scale);
        Self {
            line: LineSense::new(params, calibration, ImuCheck::new(params, scale.rate_hz)),
            mounting: mounting.unwrap_or(Mounting::ALIGNED),
            mounting_is_known: mounting.is_some(),
            calibration,
            accel_filter: Biquad::low_pass(params.accel_cutoff, scale.rate_hz),
            gyro_filter: Biquad::low_pass(params.gyro_cutoff, scale.rate_hz),
            notch: Biquad::notch(params.notch_freq, params.notch_bandwidth, scale.rate_hz),
            check: ImuCheck::new(params, scale.rate_hz),
            altimeter: Altimeter::new(params),
            battery: BatteryMonitor::new(params),
        }
    }

    /// The filter that the accelerometer passes; the thrust model passes the same one.
    #[must_use]
    pub fn accel_filter(&self) -> &Biquad<S> {
        &self.accel_filter
    }

    /// One step; `motion`: of the last attitude, for the altimeters.
    pub fn step(
        &self,
        state: &mut SenseState<S>,
        now: Micros,
        raw: &RawSensors,
        motion: &Motion<S>,
    ) -> Sensors<S> {
        let fresh = self.check.step(&mut state.check, now, raw.imu.as_ref());
        let imu_is_held = fresh.is_none();
        if let Some(sample) = fresh {
            if sample.value.temperature.is_finite() {
                state.temperature = sample.value.temperature;
            }
            state.inertial = Some(self.convert(state, &sample.value));
        }
        // Who integrates goes on with the last reading: each step is a millisecond, whatever arrived in it.
        let holds = self.check.holds(&state.check, now);
        let imu = state.inertial.filter(|_| holds).map(|value| Sample { at: now, value });
        let altitude = self.altimeter.step(&mut state.altimeter, raw, motion, S::lit(INNER_DT));
        let tether_length = raw.tether.filter(|sample| sample.value.length_mm >= 0).map(|sample| {
            state.tether_at = Some(sample.at);
            Sample { at: sample.at, value: S::from_f32(sample.value.length_mm as f32 * 1e-3) }
        });
        let battery = self.battery.step(&mut state.battery, raw.battery);
        let current = battery.as_ref().map_or(0.0, |battery| battery.current.to_f32());
        Sensors {
            line: self.line.step(&mut state.line, now, &raw.line, &self.mounting, current),
            imu,
            altitude,
            tether_length,
            capture: raw.capture.and_then(captured),
            velocity: raw.velocity.and_then(|sample| {
                let World(value) = finite(sample.value)?;
                Some(Sample { at: sample.at, value: Body(value) })
            }),
            rod: raw.rod.and_then(|sample| {
                let value = finite(sample.value)?;
                Some(Sample { at: sample.at, value })
            }),
            battery,
            imu_is_held,
            accel_is_believed: self.check.believes_accel(&state.check),
            imu_health: self.check.health(&state.check, now),
            altitude_is_fresh: self.altimeter.is_fresh(&state.altimeter, now),
            altitude_is_ranged: self.altimeter.is_ranged(&state.altimeter, now),
            altitude_error: self.altimeter.error(&state.altimeter),
            altimeters: self.altimeter.report(&state.altimeter),
            tether_is_fresh: state.tether_at.is_some_and(|at| now.since(at) < TETHER_TIMEOUT_US),
            imu_temperature: state.temperature,
        }
    }

    /// Whether the parameters say how the inertial sensor sits.
    #[must_use]
    pub fn mounting_is_known(&self) -> bool {
        self.mounting_is_known
    }

    fn convert(&self, state: &mut SenseState<S>, raw: &RawImu) -> Imu<S> {
        let accel = self.calibration.accel(self.mounting.to_body(raw.accel));
        let gyro = self.calibration.gyro(self.mounting.to_body(raw.gyro));
        let accel = state.accel_notch.step(&self.notch, accel);
        let gyro = state.gyro_notch.step(&self.notch, gyro);
        Imu {
            accel: Body(state.accel_filter.step(&self.accel_filter, accel)),
            gyro: Body(state.gyro_filter.step(&self.gyro_filter, gyro)),
        }
    }
}

impl ImuHealth {
    /// What to tell the operator.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Good => "IMU good",
            Self::Missing => "IMU: no data",
            Self::Stale => "IMU: data stale",
            Self::Frozen => "IMU: data frozen",
            Self::OutOfRange => "IMU: data out of range",
            Self::Irregular => "IMU: wrong sample rate",
        }
    }
}
