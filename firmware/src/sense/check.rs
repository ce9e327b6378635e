//! May this inertial reading be believed? Age, repeats, rate and range.

use crate::param::Params;
use crate::signal::{ImuHealth, RawImu};
use crate::time::{Micros, Sample};

/// An axis at the end of its range counts two, one within takes one off: from so many on its readings are not
/// believed, and from so many the sensor has failed (50 in a row).
const DOUBTFUL: u8 = 20;
const CLIPPED: u8 = 100;
const CLIPPED_MOST: u8 = 200;
/// What the data registers hold until the sensor starts.
const INVALID: i16 = i16::MIN;
/// The rate is counted over so long, µs, and may be off by this share.
const RATE_WINDOW_US: u64 = 2_000_000;
const RATE_TOLERANCE: f32 = 0.2;

/// Configuration.
#[derive(Clone, Copy, Debug)]
pub struct ImuCheck {
    timeout_us: u64,
    /// Samples in a window.
    expected: f32,
}

/// What moves.
#[derive(Clone, Copy, Debug, Default)]
pub struct ImuCheckState {
    /// The last sample that was new, as it is believed.
    last: Option<Sample<RawImu>>,
    /// The same as it came.
    came: RawImu,
    /// Newer ones are the same to the last bit.
    is_repeating: bool,
    clipped_accel: u8,
    clipped_gyro: u8,
    /// Begin of the window, and new samples in it.
    window: Option<Micros>,
    counted: u32,
    /// Of the last full window.
    is_irregular: bool,
}

fn score(before: u8, counts: [i16; 3]) -> u8 {
    let clips = counts.into_iter().any(is_at_end);
    if clips { (before + 2).min(CLIPPED_MOST) } else { before.saturating_sub(1) }
}

fn is_at_end(count: i16) -> bool {
    count == i16::MAX || count <= i16::MIN + 1
}

impl ImuCheck {
    pub fn new(params: &Params, rate_hz: f32) -> Self {
        Self {
            timeout_us: (params.imu_timeout * 1e6) as u64,
            expected: rate_hz * (RATE_WINDOW_US as f32 * 1e-6),
        }
    }

    /// The sample, if it is new and in time. An axis at the end of its range says what it said before: how much more it
    /// would say nobody knows.
    pub fn step(
        &self,
        state: &mut ImuCheckState,
        now: Micros,
        sample: Option<&Sample<RawImu>>,
    ) -> Option<Sample<RawImu>> {
        self.count(state, now);
        let sample = sample?;
        let raw = &sample.value;
        let counts = || raw.accel.iter().chain(&raw.gyro);
        // A part that has not started is as good as absent.
        if now.since(sample.at) > self.timeout_us || counts().all(|&n| n == INVALID) {
            return None;
        }
        let mut believed = *sample;
        if let Some(last) = state.last {
            if sample.at <= last.at {
                return None;
            }
            // Noise of one count makes even three equal ones unlikely.
            state.is_repeating = state.came.accel == raw.accel && state.came.gyro == raw.gyro;
            if state.is_repeating {
                return None;
            }
            let kept = |now: &mut [i16; 3], before: [i16; 3]| {
                for (count, before) in now.iter_mut().zip(before) {
                    *count = if is_at_end(*count) { before } else { *count };
                }
            };
            kept(&mut believed.value.accel, last.value.accel);
            kept(&mut believed.value.gyro, last.value.gyro);
        }
        state.clipped_accel = score(state.clipped_accel, raw.accel);
        state.clipped_gyro = score(state.clipped_gyro, raw.gyro);
        state.came = *raw;
        state.counted += 1;
        state.last = Some(believed);
        Some(believed)
    }

    fn count(&self, state: &mut ImuCheckState, now: Micros) {
        let began = *state.window.get_or_insert(now);
        if now.since(began) >= RATE_WINDOW_US {
            let off = (state.counted as f32 - self.expected).abs();
            state.is_irregular = off > self.expected * RATE_TOLERANCE;
            (state.window, state.counted) = (Some(now), 0);
        }
    }

    /// Whether what it said last still holds, for want of something newer.
    pub fn holds(&self, state: &ImuCheckState, now: Micros) -> bool {
        state.last.is_some_and(|last| now.since(last.at) <= self.timeout_us)
    }

    /// Whether the accelerometer says how the vehicle is accelerated.
    pub fn believes_accel(&self, state: &ImuCheckState) -> bool {
        state.clipped_accel < DOUBTFUL
    }

    pub fn health(&self, state: &ImuCheckState, now: Micros) -> ImuHealth {
        match state.last {
            None => ImuHealth::Missing,
            Some(_) if !self.holds(state, now) && state.is_repeating => ImuHealth::Frozen,
            Some(_) if !self.holds(state, now) => ImuHealth::Stale,
            Some(_) if state.clipped_accel.max(state.clipped_gyro) >= CLIPPED => {
                ImuHealth::OutOfRange
            }
            Some(_) if state.is_irregular => ImuHealth::Irregular,
            Some(_) => ImuHealth::Good,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Health after a second of clipped samples that change or not.
    fn after_a_second(reading: impl Fn(i16) -> RawImu) -> ImuHealth {
        let check = ImuCheck::new(&Params::default(), 1000.0);
        let mut state = ImuCheckState::default();
        for ms in 0..1000_i16 {
            let at = Micros(u64::from(ms.unsigned_abs()) * 1000);
            check.step(&mut state, at, Some(&Sample { at, value: reading(ms) }));
        }
        check.health(&state, Micros(1_000_000))
    }

    #[test]
    fn a_frozen_sensor_is_found_out_even_with_an_axis_at_its_end() {
        let clipped = |x| RawImu { accel: [x, 0, i16::MAX], gyro: [0; 3], temperature: 25.0 };
        assert_eq!(after_a_second(|ms| clipped(ms % 7)), ImuHealth::OutOfRange);
        assert_eq!(after_a_second(|_| clipped(3)), ImuHealth::Frozen);
    }
}
