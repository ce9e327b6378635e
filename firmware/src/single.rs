//! Whatever the vehicle computes with, MAVLink, log and simulator read single precision: converted once, in the report.

use crate::estimate::pendulum::PendulumEstimate;
use crate::estimate::taut::{OutOfPlaneState, TautEstimate};
use crate::estimate::tether_angle::{TetherAngleEstimate, TetherAngleState};
use crate::frames::{Attitude, Body, World};
use crate::model::{PlanarState, TetherAngle, TetherAngleModel};
use crate::scalar::Scalar;
use crate::signal::{
    Actuation, Battery, Capture, Estimate, FilterHealth, FlightReference, Imu, LineSensors,
    LoadReference, PerRotor, PlanarReference, Sensors, TetherState, WinchCommand, Wrench,
};
use crate::time::Sample;
use core::any::Any;
use nalgebra::SMatrix;

/// The same in single precision.
pub trait Single {
    /// The same with `f32` for its scalar.
    type Single;
    /// Converts; what is no number stays.
    fn single(&self) -> Self::Single;
}

/// [`Single::single`], as a plain copy where it is in single precision already.
#[inline]
pub fn in_single<T: Single + 'static>(value: &T) -> T::Single
where
    T::Single: Copy + 'static,
{
    match (value as &dyn Any).downcast_ref::<T::Single>() {
        Some(same) => *same,
        None => value.single(),
    }
}

impl<S: Scalar> Single for S {
    type Single = f32;
    fn single(&self) -> f32 {
        self.to_f32()
    }
}

impl<S: Scalar, const R: usize, const C: usize> Single for SMatrix<S, R, C> {
    type Single = SMatrix<f32, R, C>;
    fn single(&self) -> Self::Single {
        self.map(Scalar::to_f32)
    }
}

impl<T: Single, const N: usize> Single for [T; N] {
    type Single = [T::Single; N];
    fn single(&self) -> Self::Single {
        self.each_ref().map(Single::single)
    }
}

impl<S: Scalar> Single for PerRotor<S> {
    type Single = PerRotor<f32>;
    fn single(&self) -> Self::Single {
        self.map(Scalar::to_f32)
    }
}

impl<T: Single> Single for Option<T> {
    type Single = Option<T::Single>;
    fn single(&self) -> Self::Single {
        self.as_ref().map(Single::single)
    }
}

impl<T: Single> Single for Sample<T> {
    type Single = Sample<T::Single>;
    fn single(&self) -> Self::Single {
        Sample { at: self.at, value: self.value.single() }
    }
}

impl<T: Single> Single for World<T> {
    type Single = World<T::Single>;
    fn single(&self) -> Self::Single {
        World(self.0.single())
    }
}

impl<T: Single> Single for Body<T> {
    type Single = Body<T::Single>;
    fn single(&self) -> Self::Single {
        Body(self.0.single())
    }
}

impl<S: Scalar> Single for Attitude<S> {
    type Single = Attitude<f32>;
    fn single(&self) -> Self::Single {
        Attitude(self.0.single())
    }
}

impl<S: Scalar> Single for LoadReference<S> {
    type Single = LoadReference<f32>;
    fn single(&self) -> Self::Single {
        LoadReference(self.0.single())
    }
}

/// Structs by their fields: those that convert; those that stay.
macro_rules! single {
    ($($name:ident { $($field:ident),* $(; $($kept:ident),*)? })*) => {
        $(impl<S: Scalar> Single for $name<S> {
            type Single = $name<f32>;
            fn single(&self) -> Self::Single {
                $name { $($field: self.$field.single(),)* $($($kept: self.$kept,)*)? }
            }
        })*
    };
}

single! {
    Imu { gyro, accel }
    Capture { position, heading }
    Battery { voltage, current, drawn, cell, remaining }
    Sensors {
        imu, altitude, tether_length, capture, velocity, rod, line, battery, altitude_error;
        imu_health, imu_is_held, accel_is_believed, altitude_is_fresh, altitude_is_ranged, altimeters, tether_is_fresh, imu_temperature
    }
    LineSensors { direction, tension, station_tension, station_direction, magnetic, second_imu }
    TetherState { elevation, azimuth, length, tension; is_taut }
    FilterHealth { accel, altitude, length }
    Estimate {
        attitude, rate, gyro_bias, height, climb, altitude_rate, vibration, position, velocity, tether, position_sd, heading_sd, air_force, thrust_scale, pull, thrust, health;
        restarts, gyro_changes, length_jumps, length_is_stuck, tether_is_gone, aids, source, is_levelled, has_diverged
    }
    FlightReference { position, velocity, yaw, tension }
    PlanarReference { elevation, second }
    PlanarState { elevation, elevation_rate, pitch, pitch_rate }
    OutOfPlaneState { x, covariance }
    TautEstimate { planar, link_force, residual, thrust, thrust_rate, accel, rate, out_of_plane }
    TetherAngle { angle, rate, tilt }
    TetherAngleModel { thrust, length }
    TetherAngleState { posterior, slack, prior; mode, is_running }
    TetherAngleEstimate { planes, models, tension, pull }
    PendulumEstimate { position, velocity, rod, rod_rate, disturbance }
    Wrench { thrust, torque }
    WinchCommand { tension }
    Actuation { thrusts, throttle, winch; is_armed }
}
