//! The firmware in the scalar of one's choice, reported in single precision.

use crate::scenario::Arithmetic;
use tautline_firmware::fixed::Q16;
use tautline_firmware::param::Params;
use tautline_firmware::sense::ImuScale;
use tautline_firmware::single::Single;
use tautline_firmware::vehicle::{StepInput, StepOutput, Vehicle};

/// The vehicle's firmware.
#[derive(Clone, Debug)]
pub enum Autopilot {
    /// In single precision.
    F32(Box<Vehicle<f32>>),
    /// In double precision.
    F64(Box<Vehicle<f64>>),
    /// In fixed point.
    Q16(Box<Vehicle<Q16>>),
}

impl Autopilot {
    /// On the ground, disarmed.
    #[must_use]
    pub fn new(arithmetic: Arithmetic, params: Params, scale: ImuScale) -> Self {
        match arithmetic {
            Arithmetic::F32 => Self::F32(Box::new(Vehicle::new(params, scale))),
            Arithmetic::F64 => Self::F64(Box::new(Vehicle::new(params, scale))),
            Arithmetic::Q16 => Self::Q16(Box::new(Vehicle::new(params, scale))),
        }
    }

    /// One millisecond.
    pub fn step(&mut self, input: &StepInput) -> &StepOutput {
        match self {
            Self::F32(vehicle) => vehicle.step(input),
            Self::F64(vehicle) => vehicle.step(input),
            Self::Q16(vehicle) => vehicle.step(input),
        }
    }

    /// What the last step said.
    #[must_use]
    pub fn output(&self) -> &StepOutput {
        match self {
            Self::F32(vehicle) => vehicle.output(),
            Self::F64(vehicle) => vehicle.output(),
            Self::Q16(vehicle) => vehicle.output(),
        }
    }

    /// After each step: what a changed parameter concerns is made anew.
    pub fn maintain(&mut self) {
        match self {
            Self::F32(vehicle) => vehicle.maintain(),
            Self::F64(vehicle) => vehicle.maintain(),
            Self::Q16(vehicle) => vehicle.maintain(),
        }
    }

    /// One that runs beside another, in the same scalar, learns what that one's motors do.
    pub fn follow(&mut self, flown: &Self) {
        match (self, flown) {
            (Self::F32(own), Self::F32(flown)) => own.follow(flown),
            (Self::F64(own), Self::F64(flown)) => own.follow(flown),
            (Self::Q16(own), Self::Q16(flown)) => own.follow(flown),
            _ => {}
        }
    }

    /// Its parameters.
    #[must_use]
    pub fn params(&self) -> &Params {
        match self {
            Self::F32(vehicle) => vehicle.params(),
            Self::F64(vehicle) => vehicle.params(),
            Self::Q16(vehicle) => vehicle.params(),
        }
    }

    /// Tension commanded to the winch, N.
    #[must_use]
    pub fn winch_tension(&self) -> f32 {
        match self {
            Self::F32(vehicle) => vehicle.winch_tension(),
            Self::F64(vehicle) => vehicle.winch_tension().single(),
            Self::Q16(vehicle) => vehicle.winch_tension().single(),
        }
    }
}
