//! How much thrust acts now? The commanded thrusts behind each rotor's lag, then through the same
//! filter as the accelerometer (`fullstate` section 2), so that the two line up in time.

use crate::math::filter::{Biquad, BiquadState};
use crate::scalar::Scalar;
use crate::signal::MAX_ROTORS;

/// Configuration.
#[derive(Clone, Copy, Debug)]
pub struct ThrustModel<S> {
    /// `1 - exp(-dt/tau)`.
    pub lag: S,
    /// True over commanded thrust.
    pub scale: S,
    /// The accelerometer's filter.
    pub filter: Biquad<S>,
}

/// What moves.
#[derive(Clone, Copy, Debug, Default)]
pub struct ThrustModelState<S> {
    rotors: [S; MAX_ROTORS],
    filter: Option<BiquadState<S>>,
}

impl<S: Scalar> ThrustModel<S> {
    /// Total thrust, N, one step after `commanded` was sent.
    pub fn step(&self, state: &mut ThrustModelState<S>, commanded: &[S]) -> S {
        let mut total = S::zero();
        for (thrust, command) in state.rotors.iter_mut().zip(commanded) {
            *thrust += (*command - *thrust) * self.lag;
            total += *thrust;
        }
        total *= self.scale;
        let filter = state.filter.get_or_insert_with(|| self.filter.settled(total));
        self.filter.step(filter, total)
    }
}
