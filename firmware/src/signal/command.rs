//! What the vehicle is told to do.

use super::PerRotor;
use crate::frames::{Body, V3};
use crate::scalar::Scalar;

/// Total thrust and torque asked of the mixer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrench<S: Scalar = f32> {
    /// Along the body's up axis, N.
    pub thrust: S,
    /// N m.
    pub torque: Body<V3<S>>,
}

/// What the mixer could not give. Integrators read it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MixerReport {
    /// Roll or pitch torque was cut.
    pub tilt_is_saturated: bool,
    /// Yaw torque was cut.
    pub yaw_is_saturated: bool,
    /// The sum of thrusts is not what was asked.
    pub thrust_is_saturated: bool,
}

/// What the actuators get.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Actuation<S: Scalar = f32> {
    /// Thrust of each rotor, N.
    pub thrusts: PerRotor<S>,
    /// Throttle of each rotor, 0..1; the driver maps it to a pulse.
    pub throttle: PerRotor<S>,
    /// Whether the motors may turn. When not, every throttle is zero.
    pub is_armed: bool,
    /// For the ground end.
    pub winch: WinchCommand<S>,
}

/// Command to a constant-tension winch.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WinchCommand<S> {
    /// Tension set-point, N.
    pub tension: S,
}
