//! May this inertial reading be believed? Range, age, frozen value.

use crate::param::Params;
use crate::signal::{ImuHealth, RawImu};
use crate::time::{Micros, Sample};

/// Identical samples in a row that count as frozen. Noise of one count makes even three unlikely.
const FROZEN_SAMPLES: u16 = 25;
/// Samples at the end of the range in a row that count as a fault.
const CLIPPED_SAMPLES: u16 = 50;
/// What the data registers hold until the sensor starts.
const INVALID: i16 = i16::MIN;

/// Configuration.
#[derive(Clone, Copy, Debug)]
pub struct ImuCheck {
    timeout_us: u64,
}

/// What moves.
#[derive(Clone, Copy, Debug, Default)]
pub struct ImuCheckState {
    last: Option<Sample<RawImu>>,
    repeats: u16,
    clipped: u16,
}

impl ImuCheck {
    pub fn new(params: &Params) -> Self {
        Self { timeout_us: (params.imu_timeout * 1e6) as u64 }
    }

    /// Whether to use this sample.
    pub fn step(&self, state: &mut ImuCheckState, now: Micros, sample: &Sample<RawImu>) -> bool {
        let raw = &sample.value;
        let counts = || raw.accel.iter().chain(&raw.gyro);
        // A part that has not started is as good as absent.
        if now.since(sample.at) > self.timeout_us || counts().all(|&n| n == INVALID) {
            return false;
        }
        if let Some(last) = state.last {
            if sample.at <= last.at {
                return false;
            }
            let same = last.value.accel == raw.accel && last.value.gyro == raw.gyro;
            state.repeats = if same { state.repeats.saturating_add(1) } else { 0 };
        }
        let at_end = counts().any(|&n| n == i16::MAX || n <= i16::MIN + 1);
        state.clipped = if at_end { state.clipped.saturating_add(1) } else { 0 };
        state.last = Some(*sample);
        state.repeats < FROZEN_SAMPLES
    }

    pub fn health(&self, state: &ImuCheckState, now: Micros) -> ImuHealth {
        match state.last {
            None => ImuHealth::Missing,
            Some(last) if now.since(last.at) > self.timeout_us => ImuHealth::Stale,
            Some(_) if state.clipped >= CLIPPED_SAMPLES => ImuHealth::OutOfRange,
            Some(_) if state.repeats >= FROZEN_SAMPLES => ImuHealth::Frozen,
            Some(_) => ImuHealth::Good,
        }
    }
}
