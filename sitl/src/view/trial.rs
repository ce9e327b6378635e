//! Which fault shows which row of the failsafe table, in a hold of the default vehicle on its winch.

use crate::scenario::FaultKind;
use tautline_firmware::supervisor::Failure;

/// One.
#[derive(Clone, Copy, Debug)]
pub struct Trial {
    /// What the firmware finds.
    pub failure: Failure,
    /// What is broken.
    pub kind: FaultKind,
    /// How much, in the kind's unit.
    pub value: f64,
    /// One motor, from 1.
    pub motor: Option<usize>,
}

const fn trial(failure: Failure, kind: FaultKind, value: f64) -> Trial {
    Trial { failure, kind, value, motor: None }
}

/// Those that one fault shows; the rest want another vehicle, mode or phase.
pub const TRIALS: &[Trial] = &[
    trial(Failure::ImuLost, FaultKind::ImuSilent, 0.0),
    trial(Failure::ImuClipped, FaultKind::GyroClipped, 0.0),
    trial(Failure::AltimeterLost, FaultKind::AltimeterLost, 0.0),
    trial(Failure::TetherLengthLost, FaultKind::WinchSilent, 0.0),
    trial(Failure::BatteryCritical, FaultKind::BatteryAt, 0.0),
    trial(Failure::BatteryLow, FaultKind::BatteryAt, 0.1),
    trial(Failure::LinkLost, FaultKind::LinkLost, 0.0),
    Trial { motor: Some(1), ..trial(Failure::Capsized, FaultKind::MotorStop, 0.0) },
    trial(Failure::TetherGone, FaultKind::TetherBroken, 0.0),
    trial(Failure::ImuIrregular, FaultKind::ImuRate, 500.0),
    trial(Failure::ImuGone, FaultKind::ImuDead, 0.0),
    trial(Failure::LineCaught, FaultKind::WinchTension, 15.0),
];
