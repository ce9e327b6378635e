//! Every failure: what shows it, how long it must last, where it ends.

use super::{Failsafe, FailsafeAction, FailsafeFacts, Failure};
use crate::signal::ImuHealth;
use crate::supervisor::mode::{Mode, Needs};

/// Battery sag under a manoeuvre shall not land the vehicle.
const BATTERY_DELAY_US: u64 = 3_000_000;

/// A gust at the fence is none of its business.
const FENCE_DELAY_US: u64 = 500_000;

/// Tilt at which nothing can be saved (80°), and how long it must last.
const CAPSIZED_COS: f32 = 0.17;
const CAPSIZED_DELAY_US: u64 = 300_000;

/// So long an attitude that nobody measures stays near level; after that the motors would only push somewhere.
const BLIND_DELAY_US: u64 = 1_200_000;

/// Whether a failure matters in this mode. Descent is where most of them end: there the flag stays up.
fn concerns(mode: Mode, need: impl Fn(&Needs) -> bool) -> bool {
    need(&mode.rule().needs) || mode == FailsafeAction::LEVEL
}

/// All failures, ordered as [`Failure`].
pub const FAILSAFES: [Failsafe; 23] = [
    Failsafe {
        failure: Failure::ImuLost,
        name: "imu_lost",
        text: "IMU lost: descending blind",
        is_present: |_, f| is_blind(f),
        delay: |_| 0,
        action: |_| FailsafeAction::Descend,
    },
    Failsafe {
        failure: Failure::ImuClipped,
        name: "imu_clipped",
        text: "IMU out of range: descending",
        is_present: |_, f| f.imu == ImuHealth::OutOfRange,
        delay: |_| 0,
        action: |_| FailsafeAction::Descend,
    },
    Failsafe {
        failure: Failure::EstimatorDiverged,
        name: "estimator_diverged",
        text: "Position estimate diverged: descending",
        is_present: |_, f| f.has_diverged && concerns(f.mode, |needs| needs.position),
        delay: |_| 0,
        action: |_| FailsafeAction::Descend,
    },
    Failsafe {
        failure: Failure::AltimeterLost,
        name: "altimeter_lost",
        text: "Altimeter lost: descending",
        is_present: |_, f| !f.altitude_is_fresh && concerns(f.mode, |needs| needs.altitude),
        delay: |_| 0,
        action: |_| FailsafeAction::Descend,
    },
    Failsafe {
        failure: Failure::TetherSlack,
        name: "tether_slack",
        text: "Tether slack: descending",
        is_present: |_, f| !f.is_taut && !f.is_gone && concerns(f.mode, |needs| needs.taut),
        delay: |c| c.slack_delay_us,
        action: |_| FailsafeAction::Descend,
    },
    Failsafe {
        failure: Failure::TetherLengthLost,
        name: "tether_length_lost",
        text: "Tether length lost: landing",
        is_present: |_, f| !f.tether_is_known && concerns(f.mode, |needs| needs.position),
        delay: |_| 0,
        action: |_| FailsafeAction::Land,
    },
    Failsafe {
        failure: Failure::BatteryCritical,
        name: "battery_critical",
        text: "Battery critical: descending",
        is_present: |c, f| f.cell.is_some_and(|v| v < c.cell_critical),
        delay: |_| BATTERY_DELAY_US,
        action: |_| FailsafeAction::Descend,
    },
    Failsafe {
        failure: Failure::BatteryLow,
        name: "battery_low",
        text: "Battery low: landing",
        is_present: |c, f| f.cell.is_some_and(|v| v < c.cell_low),
        delay: |_| BATTERY_DELAY_US,
        action: |_| FailsafeAction::Land,
    },
    Failsafe {
        failure: Failure::LinkLost,
        name: "link_lost",
        text: "Ground station lost",
        is_present: |c, f| f.link_silence_us.is_some_and(|us| us > c.link_delay_us),
        delay: |_| 0,
        action: |c| c.link_action,
    },
    Failsafe {
        failure: Failure::SticksLost,
        name: "sticks_lost",
        text: "Sticks lost: descending",
        is_present: |_, f| !f.sticks_are_up && f.mode.rule().needs.sticks,
        delay: |_| 500_000,
        action: |_| FailsafeAction::Descend,
    },
    Failsafe {
        failure: Failure::Capsized,
        name: "capsized",
        text: "Capsized: motors off",
        is_present: |_, f| f.cos_tilt < CAPSIZED_COS,
        delay: |_| CAPSIZED_DELAY_US,
        action: |_| FailsafeAction::Terminate,
    },
    Failsafe {
        failure: Failure::CaptureLost,
        name: "capture_lost",
        text: "Motion capture lost: descending",
        is_present: |_, f| !f.has_capture && concerns(f.mode, |needs| needs.position),
        delay: |c| c.capture_delay_us,
        action: |_| FailsafeAction::Descend,
    },
    // No fact shows these two: the mode that flies raises them.
    Failsafe {
        failure: Failure::ModeFailed,
        name: "mode_failed",
        text: "Flight mode failed: holding",
        is_present: |_, _| false,
        delay: |_| 0,
        action: |_| FailsafeAction::Hold,
    },
    Failsafe {
        failure: Failure::NoLiftOff,
        name: "no_lift_off",
        text: "Take-off failed: no lift-off",
        is_present: |_, _| false,
        delay: |_| 0,
        action: |_| FailsafeAction::Terminate,
    },
    Failsafe {
        failure: Failure::TetherGone,
        name: "tether_gone",
        text: "Tether gone: descending",
        is_present: |_, f| f.is_gone && concerns(f.mode, |needs| needs.taut),
        delay: |_| 0,
        action: |_| FailsafeAction::Descend,
    },
    Failsafe {
        failure: Failure::ImuIrregular,
        name: "imu_irregular",
        text: "IMU sample rate wrong: landing",
        is_present: |_, f| f.imu == ImuHealth::Irregular,
        delay: |_| 0,
        action: |_| FailsafeAction::Land,
    },
    Failsafe {
        failure: Failure::ImuGone,
        name: "imu_gone",
        text: "IMU lost: motors off",
        is_present: |_, f| is_blind(f),
        delay: |_| BLIND_DELAY_US,
        action: |_| FailsafeAction::Terminate,
    },
    Failsafe {
        failure: Failure::LineCaught,
        name: "line_caught",
        text: "Line caught: it does not pay out, holding",
        is_present: |_, f| f.line.is_caught && concerns(f.mode, |needs| needs.position),
        delay: |_| 0,
        action: |_| FailsafeAction::Hold,
    },
    Failsafe {
        failure: Failure::OverTension,
        name: "over_tension",
        text: "Line tension far too high: landing",
        is_present: |_, f| f.line.is_pulled && concerns(f.mode, |needs| needs.position),
        delay: |_| 0,
        action: |_| FailsafeAction::Land,
    },
    // As those two above.
    Failsafe {
        failure: Failure::LandingOverdue,
        name: "landing_overdue",
        text: "Landing finds no ground: descending",
        is_present: |_, _| false,
        delay: |_| 0,
        action: |_| FailsafeAction::Descend,
    },
    Failsafe {
        failure: Failure::RotorLost,
        name: "rotor_lost",
        text: "Rotor lost: landing on the others",
        is_present: |_, f| f.rotor_is_lost,
        delay: |_| 0,
        action: |_| FailsafeAction::Land,
    },
    Failsafe {
        failure: Failure::FenceBreached,
        name: "fence_breached",
        text: "Fence breached",
        is_present: |c, f| f.is_outside && c.fence_action.is_some(),
        delay: |_| FENCE_DELAY_US,
        action: |c| c.fence_action.unwrap_or(FailsafeAction::Hold),
    },
    Failsafe {
        failure: Failure::RadioLost,
        name: "radio_lost",
        text: "No pilot: radio failsafe",
        is_present: |c, f| f.radio_is_lost && c.radio_action.is_some(),
        delay: |_| 0,
        action: |c| c.radio_action.unwrap_or(FailsafeAction::Hold),
    },
];

/// Nothing says how the vehicle turns.
const fn is_blind(f: &FailsafeFacts) -> bool {
    matches!(f.imu, ImuHealth::Missing | ImuHealth::Stale | ImuHealth::Frozen)
}
