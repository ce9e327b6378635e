//! Position and velocity in free flight: inertial navigation held by motion capture.
//!
//! A sample shows where the vehicle was a while ago. It is compared with what was believed then, and the
//! difference corrects the present: a fixed-gain observer of position, velocity and accelerometer bias with
//! three equal poles. Assumes a known, constant delay and a rough level; a tilt error looks like a bias.

use crate::frames::{V3, World};
use crate::math::GRAVITY;
use crate::math::history::History;
use crate::math::so3;
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::Capture;
use crate::time::{Micros, OUTER_DT, Sample};

/// How far back a sample may reach, in steps of 4 ms: 124 ms.
pub const MEMORY: usize = 32;
/// Farther from what was believed than this, m, a sample is an outlier; so many in a row, and the truth is
/// there.
const GATE: f64 = 0.5;
const OUTLIERS: u8 = 10;
/// A sample after a longer gap, s, corrects as if it came after this one.
const PERIOD_MAX: f64 = 0.1;

/// Configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CaptureFilter<S> {
    bandwidth: S,
    /// Age of a sample, in steps.
    delay: usize,
    timeout_us: u64,
}

/// What moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CaptureState<S: Scalar> {
    /// m.
    pub position: World<V3<S>>,
    /// m/s.
    pub velocity: World<V3<S>>,
    bias: V3<S>,
    past: History<V3<S>, MEMORY>,
    at: Micros,
    outliers: u8,
}

/// Steps of 4 ms in a delay, s.
pub(crate) fn delay_steps(delay: f32) -> usize {
    ((delay / OUTER_DT as f32 + 0.5) as usize).min(MEMORY - 1)
}

impl<S: Scalar> CaptureFilter<S> {
    /// From the parameters.
    #[must_use]
    pub fn new(p: &Params) -> Self {
        Self {
            bandwidth: S::from_f32(p.capture_bandwidth),
            delay: delay_steps(p.capture_delay),
            timeout_us: (p.capture_timeout * 1e6) as u64,
        }
    }

    /// From a first sample, at rest.
    #[must_use]
    pub fn start(&self, sample: &Sample<Capture<S>>) -> CaptureState<S> {
        let position = sample.value.position;
        CaptureState {
            position,
            velocity: World(V3::zeros()),
            bias: V3::zeros(),
            past: History::constant(position.0),
            at: sample.at,
            outliers: 0,
        }
    }

    /// Whether a sample arrived lately.
    #[must_use]
    pub fn is_fresh(&self, state: &CaptureState<S>, now: Micros) -> bool {
        now.since(state.at) < self.timeout_us
    }

    /// One step of 4 ms with the specific force in world axes, m/s².
    pub fn predict(&self, state: &mut CaptureState<S>, specific_force: &World<V3<S>>) {
        let dt = S::lit(OUTER_DT);
        let mut accel = specific_force.0 - state.bias;
        accel.z += S::lit(GRAVITY);
        state.position.0 += state.velocity.0 * dt + accel * (dt * dt * S::lit(0.5));
        state.velocity.0 += accel * dt;
        state.past.push(state.position.0);
    }

    /// Takes a sample; starts anew after a gap or a row of outliers.
    pub fn correct(&self, state: &mut CaptureState<S>, sample: &Sample<Capture<S>>) {
        let then = state.past.ago(self.delay).copied().unwrap_or(state.position.0);
        let off = sample.value.position.0 - then;
        state.outliers = if so3::norm(&off) > S::lit(GATE) { state.outliers + 1 } else { 0 };
        if !self.is_fresh(state, sample.at) || state.outliers >= OUTLIERS {
            *state = CaptureState { velocity: state.velocity, ..self.start(sample) };
            return;
        }
        if state.outliers > 0 {
            return;
        }
        let period = S::from_f32(sample.at.seconds_since(state.at)).min(S::lit(PERIOD_MAX));
        let w = (self.bandwidth * period).min(S::lit(0.3));
        let per = S::one() / period.max(S::lit(1e-3));
        let three = S::lit(3.0);
        let shift = off * (three * w);
        state.position.0 += shift;
        for past in state.past.iter_mut() {
            *past += shift;
        }
        state.velocity.0 += off * (three * w * w * per);
        state.bias -= off * (w * w * w * per * per);
        state.at = sample.at;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(us: u64, x: f64) -> Sample<Capture<f64>> {
        let position = World(V3::new(x, 0.0, -1.0));
        Sample { at: Micros(us), value: Capture { position, heading: None } }
    }

    /// At 1 m/s, samples 20 ms late, 83 a second.
    fn flown(filter: &CaptureFilter<f64>, seconds: u64) -> CaptureState<f64> {
        let mut state = filter.start(&sample(0, -0.02));
        let hover = World(V3::new(0.0, 0.0, -GRAVITY));
        for ms in (4..=seconds * 1000).step_by(4) {
            filter.predict(&mut state, &hover);
            if ms % 12 == 0 {
                filter.correct(&mut state, &sample(ms * 1000, ms as f64 * 1e-3 - 0.02));
            }
        }
        state
    }

    #[test]
    fn late_samples_of_a_steady_motion_leave_no_error() {
        let state = flown(&CaptureFilter::new(&Params::default()), 6);
        let off = state.position.0 - V3::new(6.0, 0.0, -1.0);
        assert!(off.norm() < 1e-3 && (state.velocity.0.x - 1.0).abs() < 1e-3, "{off} {state:?}");
    }

    #[test]
    fn a_wild_sample_is_left_out_and_a_row_of_them_believed() {
        let filter = CaptureFilter::new(&Params::default());
        let mut state = flown(&filter, 6);
        let before = state.position;
        for k in 1..u64::from(OUTLIERS) {
            filter.correct(&mut state, &sample(6_000_000 + k * 10_000, 50.0));
            assert_eq!(state.position, before);
        }
        filter.correct(&mut state, &sample(6_100_000, 50.0));
        assert!((state.position.0.x - 50.0).abs() < 1e-9);
    }
}
