//! One measured distance against inertia, an altimeter's or a winch encoder's: does what it shows fit how the vehicle is
//! accelerated along it?

use super::{VerticalFilter, VerticalState};
use crate::scalar::Scalar;

/// Bandwidth of the observer, rad/s: slow, so that what the sensor invents is seen as its error.
const BANDWIDTH: f64 = 1.0;
/// The error's low-pass and how long its peak is remembered, s.
const ERROR_TIME: f64 = 0.4;
const PEAK_TIME: f64 = 3.0;
/// Of its size, without sign, s.
const ROUGH_TIME: f64 = 1.0;

/// What is known of one sensor.
#[derive(Clone, Copy, Debug)]
pub struct Witness<S> {
    /// By its readings and inertia.
    pub observer: VerticalState<S>,
    /// Low-passed, m.
    pub error: S,
    /// Of the last reading, m.
    pub last: S,
    /// Largest error of late, m.
    pub peak: S,
    /// Mean size of its error, m.
    pub rough: S,
    is_begun: bool,
}

impl<S: Scalar> Default for Witness<S> {
    fn default() -> Self {
        let o = S::zero();
        Self {
            observer: VerticalState::default(),
            error: o,
            last: o,
            peak: o,
            rough: o,
            is_begun: false,
        }
    }
}

impl<S: Scalar> Witness<S> {
    fn filter() -> VerticalFilter<S> {
        VerticalFilter { bandwidth: S::lit(BANDWIDTH), fade: S::lit(5.0) }
    }

    /// `dt` s under an acceleration along it, m/s².
    pub fn predict(&mut self, accel: S, dt: S) {
        Self::filter().predict(&mut self.observer, accel, dt, true);
    }

    /// How far a reading is from what inertia expects, m.
    pub fn error_of(&self, reading: S) -> S {
        if self.is_begun { reading - self.observer.height } else { S::zero() }
    }

    /// Takes a reading, `dt` s after the one before.
    pub fn take(&mut self, reading: S, dt: S) {
        let error = self.error_of(reading);
        let share = |time: f64| (dt * S::lit(1.0 / time)).min(S::one());
        self.last = error;
        self.error += (error - self.error) * share(ERROR_TIME);
        self.rough += (error.abs() - self.rough) * share(ROUGH_TIME);
        self.peak = (self.peak - self.peak * share(PEAK_TIME)).max(self.error.abs());
        if self.is_begun {
            Self::filter().correct(&mut self.observer, reading, dt);
        } else {
            self.is_begun = true;
            self.stand(reading);
        }
    }

    /// It stands at this reading.
    pub fn stand(&mut self, reading: S) {
        self.observer = VerticalState { height: reading, ..VerticalState::default() };
    }

    /// Its zero has moved by a little, m.
    pub fn shift_quietly(&mut self, by: S) {
        self.observer.height += by;
    }

    /// What it shows has jumped by so much, and that is accepted, m.
    pub fn shift(&mut self, by: S) {
        self.observer.height += by;
        (self.error, self.peak) = (S::zero(), S::zero());
    }
}
