//! How much more or less than commanded do the rotors give? Measured in slack flight, where thrust is
//! the only force along the body's axis: `flight` section 5.
//!
//! On a taut link this cannot be seen: at rest every thrust error looks like link force.

use crate::scalar::Scalar;

/// Largest believable correction; beyond, the link was not slack or the battery is wrong.
const CORRECTION_MAX: f64 = 0.15;

/// Configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThrustCalibration<S> {
    /// kg.
    pub mass: S,
    /// Samples to average.
    pub samples: u16,
}

/// Running means.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ThrustCalibrationState<S> {
    count: u16,
    lift: S,
    thrust: S,
}

/// How a calibration ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Calibrated<S> {
    /// True over assumed thrust.
    Ratio(S),
    /// Too far from one to be an error of the rotors alone.
    Implausible,
}

impl<S: Scalar> ThrustCalibration<S> {
    /// Takes the specific force along the body's up axis, m/s², and the assumed thrust, N; the result
    /// once there are enough.
    pub fn step(
        &self,
        state: &mut ThrustCalibrationState<S>,
        up: S,
        thrust: S,
    ) -> Option<Calibrated<S>> {
        state.count = state.count.saturating_add(1);
        let share = S::one() / S::lit(f64::from(state.count));
        state.lift += (up * self.mass - state.lift) * share;
        state.thrust += (thrust - state.thrust) * share;
        if state.count < self.samples {
            return None;
        }
        let ratio = state.lift / state.thrust.max(S::lit(0.1));
        let is_plausible = (ratio - S::one()).abs() <= S::lit(CORRECTION_MAX);
        Some(if is_plausible { Calibrated::Ratio(ratio) } else { Calibrated::Implausible })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ratio_is_that_of_the_means_and_a_pull_on_the_link_is_implausible() {
        let block = ThrustCalibration { mass: 1.2_f64, samples: 500 };
        let run = |lift: f64| {
            let mut state = ThrustCalibrationState::default();
            (0..500)
                .filter_map(|i| {
                    let noise = if i % 2 == 0 { 1.0 } else { -1.0 };
                    block.step(&mut state, (lift + noise) / 1.2, 12.0)
                })
                .last()
        };
        assert!(matches!(run(12.6), Some(Calibrated::Ratio(r)) if (r - 1.05).abs() < 1e-9));
        assert_eq!(run(8.0), Some(Calibrated::Implausible));
    }
}
