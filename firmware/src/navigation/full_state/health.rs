//! Can the full-state filter be believed? Its innovations say so, and what it claims (`fullstate` section 8).
//!
//! None of it sees a wrong azimuth: it is no proof of the horizontal place.

use crate::estimate::MahonyState;
use crate::estimate::full_state::FullState;
use crate::math::so3;
use crate::scalar::Scalar;
use crate::signal::FilterHealth;

/// How long the innovations must fail, steps: 1 s.
const STEPS: u16 = 250;
/// Of a length, that it counts, steps: 0.1 s.
const HEARD: u16 = 25;
/// Cosine of 8 degrees between the filter's down axis and the attitude filter's; 0.5 s.
const TILT_COS: f64 = 0.990_268;
const TILT_STEPS: u16 = 125;
/// What no line and no rotor does: pull, N, and true over commanded thrust; 0.2 s, a line that jerks may seem to.
const PUSH: f64 = -3.0;
const SCALE_MIN: f64 = 0.75;
const SCALE_MAX: f64 = 1.25;
const BROKEN_STEPS: u16 = 50;
/// Low-passes over 1 s, per reading.
const ACCEL_SHARE: f64 = 0.008;
const ALTITUDE_SHARE: f64 = 0.02;
const LENGTH_SHARE: f64 = 0.016;

/// What moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct FullHealth<S: Scalar> {
    pub means: FilterHealth<S>,
    failed_steps: u16,
    /// Since the length was last heard of: old ones are no witness.
    unheard_steps: u16,
    broken_steps: u16,
    tilted_steps: u16,
}

impl<S: Scalar> Default for FullHealth<S> {
    fn default() -> Self {
        let one = S::one();
        Self {
            means: FilterHealth { accel: one, altitude: one, length: one },
            failed_steps: 0,
            unheard_steps: 0,
            broken_steps: 0,
            tilted_steps: 0,
        }
    }
}

impl<S: Scalar> FullHealth<S> {
    /// The accelerometer's squared innovation, the sum of its rows.
    pub fn feel(&mut self, nis: S) {
        follow(&mut self.means.accel, ACCEL_SHARE, nis * S::lit(1.0 / 3.0));
    }

    pub fn altimeter(&mut self, nis: S) {
        follow(&mut self.means.altitude, ALTITUDE_SHARE, nis);
    }

    pub fn length(&mut self, nis: S) {
        follow(&mut self.means.length, LENGTH_SHARE, nis);
        self.unheard_steps = 0;
    }

    /// The filter must begin anew: nothing that flies explains it. One step. While the line `jerks` the accelerometer is no
    /// witness.
    pub fn is_ill(&mut self, state: &FullState<S>, sit: &MahonyState<S>, jerks: bool) -> bool {
        let m = &self.means;
        let count = |bad, steps: u16| if bad { steps.saturating_add(1) } else { 0 };
        let most = FilterHealth::FULL_STATE_MOST;
        let fails = (m.accel > S::from_f32(most.accel) && !jerks)
            || m.altitude > S::from_f32(most.altitude)
            || (m.length > S::from_f32(most.length) && self.unheard_steps < HEARD);
        self.unheard_steps = self.unheard_steps.saturating_add(1);
        self.failed_steps = count(fails, self.failed_steps);
        let down = so3::col_z(&state.attitude.0);
        let cos = so3::dot(&down, &so3::col_z(&sit.attitude.0));
        self.tilted_steps = count(cos < S::lit(TILT_COS), self.tilted_steps);
        let scale = state.thrust_scale;
        let breaks =
            state.tension < S::lit(PUSH) || scale < S::lit(SCALE_MIN) || scale > S::lit(SCALE_MAX);
        self.broken_steps = count(breaks, self.broken_steps);
        self.failed_steps > STEPS
            || self.tilted_steps > TILT_STEPS
            || self.broken_steps > BROKEN_STEPS
    }
}

fn follow<S: Scalar>(mean: &mut S, share: f64, sample: S) {
    *mean += (sample - *mean) * S::lit(share);
}
