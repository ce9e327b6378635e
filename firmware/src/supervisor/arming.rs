//! May the motors start? Each check with what the operator reads.

use crate::math::GRAVITY;
use crate::signal::ImuHealth;

/// What the checks look at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmingFacts {
    /// The frame has no more rotors than the board has outputs.
    pub outputs_suffice: bool,
    /// One gave no thrust in the last flight.
    pub rotor_is_lost: bool,
    /// State of the inertial sensor.
    pub imu: ImuHealth,
    /// The inertial sensor sits in a known way.
    pub mounting_is_known: bool,
    /// Level and gyro bias were taken.
    pub is_levelled: bool,
    /// Size of the specific force, low-passed, m/s².
    pub felt: f32,
    /// Size of the gyro's bias, rad/s.
    pub gyro_bias: f32,
    /// Cosine of the tilt.
    pub cos_tilt: f32,
    /// An altitude arrived in time.
    pub altitude_is_fresh: bool,
    /// The tether's ground end reports, or the length is fixed.
    pub tether_is_known: bool,
    /// Volts per cell; `None` without a reading.
    pub cell: Option<f32>,
    /// Volts per cell below which no flight starts.
    pub cell_low: f32,
    /// A ground station speaks, or a pilot's radio.
    pub link_is_up: bool,
    /// The mode flies by sticks, or a pilot's switch asks, and their throttle is not at the bottom (or they are missing).
    pub throttle_is_open: bool,
    /// The kill switch of the radio is on.
    pub is_killed: bool,
    /// Weight and tension over the largest thrust.
    pub hover_share: f32,
}

/// What a specific force at rest may be off, m/s²: calibrated parts are within a tenth of it.
const FELT_OFF: f32 = 0.5;
/// A part that reads more at rest is broken, or it was levelled in a turn, rad/s.
const GYRO_BIAS_MAX: f32 = 0.17;

/// One row of [`ARMING_CHECKS`].
#[derive(Clone, Copy, Debug)]
pub struct ArmingCheck {
    /// Short name.
    pub name: &'static str,
    /// What the operator reads when it fails; at most 50 bytes.
    pub text: &'static str,
    /// A forced arming skips it.
    pub may_be_forced: bool,
    /// Whether it passes.
    pub passes: fn(&ArmingFacts) -> bool,
}

/// All checks, in the order in which they are reported. A table: rows look alike.
pub const ARMING_CHECKS: [ArmingCheck; 19] = [
    ArmingCheck {
        name: "imu present",
        text: "Arming denied: IMU: no data",
        may_be_forced: false,
        passes: |f| f.imu != ImuHealth::Missing,
    },
    ArmingCheck {
        name: "imu fresh",
        text: "Arming denied: IMU: data stale",
        may_be_forced: false,
        passes: |f| f.imu != ImuHealth::Stale,
    },
    ArmingCheck {
        name: "imu alive",
        text: "Arming denied: IMU: data frozen",
        may_be_forced: false,
        passes: |f| f.imu != ImuHealth::Frozen,
    },
    ArmingCheck {
        name: "imu in range",
        text: "Arming denied: IMU: data out of range",
        may_be_forced: false,
        passes: |f| f.imu != ImuHealth::OutOfRange,
    },
    ArmingCheck {
        name: "imu rate",
        text: "Arming denied: IMU: wrong sample rate",
        may_be_forced: false,
        passes: |f| f.imu != ImuHealth::Irregular,
    },
    ArmingCheck {
        name: "imu mounting",
        text: "Arming denied: SENS_BOARD_ROT not a right angle",
        may_be_forced: false,
        passes: |f| f.mounting_is_known,
    },
    ArmingCheck {
        name: "levelled",
        text: "Arming denied: not levelled, keep it still",
        may_be_forced: false,
        passes: |f| f.is_levelled,
    },
    ArmingCheck {
        name: "accelerometer",
        text: "Arming denied: accelerometer off, calibrate it",
        may_be_forced: false,
        passes: |f| (f.felt - GRAVITY as f32).abs() < FELT_OFF,
    },
    ArmingCheck {
        name: "gyro",
        text: "Arming denied: gyro bias too large",
        may_be_forced: false,
        passes: |f| f.gyro_bias < GYRO_BIAS_MAX,
    },
    ArmingCheck {
        name: "upright",
        text: "Arming denied: tilted more than 20 deg",
        may_be_forced: false,
        passes: |f| f.cos_tilt > 0.94,
    },
    ArmingCheck {
        name: "altitude",
        text: "Arming denied: no altitude",
        may_be_forced: true,
        passes: |f| f.altitude_is_fresh,
    },
    ArmingCheck {
        name: "tether length",
        text: "Arming denied: no tether length from winch",
        may_be_forced: true,
        passes: |f| f.tether_is_known,
    },
    ArmingCheck {
        name: "battery",
        text: "Arming denied: battery low or not measured",
        may_be_forced: true,
        passes: |f| f.cell.is_some_and(|v| v > f.cell_low),
    },
    ArmingCheck {
        name: "outputs",
        text: "Arming denied: board has too few motor outputs",
        may_be_forced: false,
        passes: |f| f.outputs_suffice,
    },
    ArmingCheck {
        name: "rotors",
        text: "Arming denied: rotor lost, repair and restart",
        may_be_forced: false,
        passes: |f| !f.rotor_is_lost,
    },
    ArmingCheck {
        name: "thrust reserve",
        text: "Arming denied: too heavy for the thrust",
        may_be_forced: false,
        passes: |f| f.hover_share < 0.8,
    },
    ArmingCheck {
        name: "ground station",
        text: "Arming denied: no ground station",
        may_be_forced: true,
        passes: |f| f.link_is_up,
    },
    ArmingCheck {
        name: "throttle",
        text: "Arming denied: throttle open or no sticks",
        may_be_forced: false,
        passes: |f| !f.throttle_is_open,
    },
    ArmingCheck {
        name: "kill switch",
        text: "Arming denied: kill switch is on",
        may_be_forced: false,
        passes: |f| !f.is_killed,
    },
];

impl ArmingCheck {
    /// The first check that fails.
    #[must_use]
    pub fn first_failure(facts: &ArmingFacts, force: bool) -> Option<&'static Self> {
        ARMING_CHECKS
            .iter()
            .filter(|check| !(force && check.may_be_forced))
            .find(|check| !(check.passes)(facts))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn good() -> ArmingFacts {
        ArmingFacts {
            outputs_suffice: true,
            rotor_is_lost: false,
            imu: ImuHealth::Good,
            mounting_is_known: true,
            is_levelled: true,
            felt: 9.8,
            gyro_bias: 0.01,
            cos_tilt: 1.0,
            altitude_is_fresh: true,
            tether_is_known: true,
            cell: Some(3.9),
            cell_low: 3.5,
            link_is_up: true,
            throttle_is_open: false,
            is_killed: false,
            hover_share: 0.5,
        }
    }

    #[test]
    fn each_fault_is_refused_with_its_own_text() {
        assert!(ArmingCheck::first_failure(&good(), false).is_none());
        let faults = [
            ArmingFacts { imu: ImuHealth::Missing, ..good() },
            ArmingFacts { imu: ImuHealth::Stale, ..good() },
            ArmingFacts { imu: ImuHealth::Frozen, ..good() },
            ArmingFacts { imu: ImuHealth::OutOfRange, ..good() },
            ArmingFacts { imu: ImuHealth::Irregular, ..good() },
            ArmingFacts { mounting_is_known: false, ..good() },
            ArmingFacts { is_levelled: false, ..good() },
            ArmingFacts { felt: 10.8, ..good() },
            ArmingFacts { gyro_bias: 0.2, ..good() },
            ArmingFacts { cos_tilt: 0.5, ..good() },
            ArmingFacts { altitude_is_fresh: false, ..good() },
            ArmingFacts { tether_is_known: false, ..good() },
            ArmingFacts { cell: None, ..good() },
            ArmingFacts { outputs_suffice: false, ..good() },
            ArmingFacts { rotor_is_lost: true, ..good() },
            ArmingFacts { hover_share: f32::NAN, ..good() },
            ArmingFacts { link_is_up: false, ..good() },
            ArmingFacts { throttle_is_open: true, ..good() },
            ArmingFacts { is_killed: true, ..good() },
        ];
        for (fault, check) in faults.iter().zip(&ARMING_CHECKS) {
            let failed = ArmingCheck::first_failure(fault, false).unwrap();
            assert_eq!(failed.name, check.name);
            assert!(failed.text.len() <= 50);
            assert_eq!(ArmingCheck::first_failure(fault, true).is_none(), check.may_be_forced);
        }
    }
}
