//! What fails in the air, and in which named safe state it ends. The most severe action wins.

mod table;

pub use table::FAILSAFES;

use super::line::LineFault;
use super::mode::Mode;
use crate::param::Params;
use crate::signal::ImuHealth;
use crate::time::Micros;

/// What can fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Failure {
    /// No fresh, living inertial data.
    ImuLost = 0,
    /// Inertial data at the end of its range.
    ImuClipped = 1,
    /// The position estimate contradicts its measurements.
    EstimatorDiverged = 2,
    /// Neither rangefinder nor barometer.
    AltimeterLost = 3,
    /// No tension.
    TetherSlack = 4,
    /// The winch no longer says how much it paid out.
    TetherLengthLost = 5,
    /// Battery below the critical voltage.
    BatteryCritical = 6,
    /// Battery below the low voltage.
    BatteryLow = 7,
    /// The ground station is silent.
    LinkLost = 8,
    /// Radio and joystick are silent in a mode that flies by it.
    SticksLost = 9,
    /// Tilted beyond anything a flight asks for.
    Capsized = 10,
    /// Free flight without motion capture.
    CaptureLost = 11,
    /// The flight mode itself can't go on.
    ModeFailed = 12,
    /// Full thrust, and still on the ground.
    NoLiftOff = 13,
    /// What held the vehicle does so no more: a cut cable.
    TetherGone = 14,
    /// Inertial samples come at a wrong rate.
    ImuIrregular = 15,
    /// No inertial data for so long that nothing is known of the attitude.
    ImuGone = 16,
    /// The line is held fast somewhere.
    LineCaught = 17,
    /// The winch pulls far more than it is asked.
    OverTension = 18,
    /// Down where the ground should be, and it is not there.
    LandingOverdue = 19,
    /// A rotor gives no thrust, and the others do its work.
    RotorLost = 20,
    /// Higher or further out than the fence.
    FenceBreached = 21,
    /// Nobody is heard any more by the radio, and no joystick speaks.
    RadioLost = 22,
}

/// Where a failure ends. Ordered by severity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FailsafeAction {
    /// Tether Hold where it is.
    Hold,
    /// Return and land, then motors off.
    Land,
    /// Level descent where it is, then motors off.
    Descend,
    /// Motors off at once.
    Terminate,
}

impl FailsafeAction {
    /// What needs nothing: where a landing has no position to go by.
    pub const LEVEL: Mode = Mode::Descent;

    /// How far a mode goes by itself: no failsafe takes a vehicle from a landing back into the air.
    #[must_use]
    pub fn rank(mode: Mode) -> u8 {
        if mode == Self::LEVEL { 2 } else { u8::from(mode.lands()) }
    }

    /// The mode in which it flies; `None` when the motors stop.
    #[must_use]
    pub const fn mode(self) -> Option<Mode> {
        match self {
            Self::Hold => Some(Mode::TetherHold),
            Self::Land => Some(Mode::Land),
            Self::Descend => Some(Self::LEVEL),
            Self::Terminate => None,
        }
    }
}

/// What the table looks at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FailsafeFacts {
    /// Present mode.
    pub mode: Mode,
    /// Cosine of the tilt.
    pub cos_tilt: f32,
    /// State of the inertial sensor.
    pub imu: ImuHealth,
    /// From the estimator.
    pub has_diverged: bool,
    /// An altitude arrived in time.
    pub altitude_is_fresh: bool,
    /// The estimator sees tension.
    pub is_taut: bool,
    /// It has been missed.
    pub is_gone: bool,
    /// What the line does against what its winch is asked.
    pub line: LineFault,
    /// One that can be spared.
    pub rotor_is_lost: bool,
    /// Beyond the fence.
    pub is_outside: bool,
    /// Motion capture gives a position, or none is needed.
    pub has_capture: bool,
    /// The ground end reports, or the length is fixed.
    pub tether_is_known: bool,
    /// Volts per cell.
    pub cell: Option<f32>,
    /// How long the ground station has been silent, µs; `None` if it never spoke, or a pilot flies by a radio.
    pub link_silence_us: Option<u64>,
    /// A radio or a joystick spoke lately.
    pub sticks_are_up: bool,
    /// There was a pilot's radio in this flight, and nobody has the sticks now.
    pub radio_is_lost: bool,
}

/// Times and thresholds from the parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Failsafes {
    link_delay_us: u64,
    link_action: FailsafeAction,
    slack_delay_us: u64,
    capture_delay_us: u64,
    cell_low: f32,
    cell_critical: f32,
    /// `None`: nothing, or a warning only.
    fence_action: Option<FailsafeAction>,
    /// `None`: what the mode does itself.
    radio_action: Option<FailsafeAction>,
}

/// One row of [`FAILSAFES`].
#[derive(Clone, Copy, Debug)]
pub struct Failsafe {
    /// What failed.
    pub failure: Failure,
    /// As programs read it.
    pub name: &'static str,
    /// What the operator reads; at most 50 bytes.
    pub text: &'static str,
    /// Whether it is present.
    pub is_present: fn(&Failsafes, &FailsafeFacts) -> bool,
    /// How long it must last, µs.
    pub delay: fn(&Failsafes) -> u64,
    /// Where it ends.
    pub action: fn(&Failsafes) -> FailsafeAction,
}

/// A failure that a mode raised forbids what its action forbids for at least so long, µs; by then the facts show it,
/// if it is still there.
const RAISED_US: u64 = 5_000_000;
/// Where a landing found no ground there is none a moment later.
const OVERDUE_US: u64 = 60_000_000;

/// Since when each failure is present, and what came of it. Bit n stands for row n of [`FAILSAFES`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FailsafeState {
    /// In the last step.
    present: u32,
    /// Of those that are.
    since: [Micros; FAILSAFES.len()],
    /// By a mode, until [`Self::raised_until`].
    raised: u32,
    raised_until: Micros,
    /// Has lasted its delay and is still there: forbids modes.
    in_force: u32,
    /// Ended the flight that was flown, until somebody asks for another mode.
    latched: u32,
}

impl FailsafeState {
    /// What the operator is told: in force, or the cause of what the vehicle does now.
    #[must_use]
    pub const fn active(&self) -> u32 {
        self.in_force | self.latched
    }

    /// What has lasted its delay and is still there.
    #[must_use]
    pub const fn in_force(&self) -> u32 {
        self.in_force
    }

    /// Somebody took over: what is not in force any more is history.
    pub fn release(&mut self) {
        self.latched = 0;
    }

    /// What is in force is why the vehicle comes down, whatever its own action.
    pub fn latch(&mut self) {
        self.latched |= self.in_force;
    }
}

impl Failure {
    /// Its bit.
    #[must_use]
    pub const fn mask(self) -> u32 {
        1 << self as u32
    }

    /// Its row.
    #[must_use]
    pub fn rule(self) -> Option<&'static Failsafe> {
        FAILSAFES.get(self as usize)
    }
}

impl Failsafes {
    /// From the parameters.
    #[must_use]
    #[inline(never)]
    pub fn new(p: &Params) -> Self {
        let micros = |seconds: f32| (seconds * 1e6) as u64;
        Self {
            link_delay_us: micros(p.link_loss_time),
            link_action: match p.link_loss_action as i32 {
                1 => FailsafeAction::Hold,
                3 => FailsafeAction::Descend,
                _ => FailsafeAction::Land,
            },
            slack_delay_us: micros(p.slack_time),
            capture_delay_us: micros(p.capture_loss_time),
            cell_low: p.battery_low,
            cell_critical: p.battery_critical,
            // PX4's numbers: 2 hold, 3 return and land, 4 terminate, 5 land in place.
            fence_action: match p.fence_action as i32 {
                2 => Some(FailsafeAction::Hold),
                3 => Some(FailsafeAction::Land),
                4 => Some(FailsafeAction::Terminate),
                5 => Some(FailsafeAction::Descend),
                _ => None,
            },
            radio_action: match p.radio_loss_action as i32 {
                1 => Some(FailsafeAction::Hold),
                2 => Some(FailsafeAction::Land),
                3 => Some(FailsafeAction::Descend),
                5 | 6 => Some(FailsafeAction::Terminate),
                _ => None,
            },
        }
    }

    /// Updates the timers; the most severe action due, and the row to announce if it is a new one.
    pub fn step(
        &self,
        state: &mut FailsafeState,
        facts: &FailsafeFacts,
        now: Micros,
    ) -> (Option<FailsafeAction>, Option<&'static Failsafe>) {
        if now >= state.raised_until {
            state.raised = 0;
        }
        let mut shown = 0;
        for (row, bit) in FAILSAFES.iter().zip(0_u32..) {
            if (row.is_present)(self, facts) {
                shown |= 1 << bit;
            }
        }
        let present = shown | state.raised;
        let begun = present & !state.present;
        state.present = present;
        state.in_force &= present;
        let mut worst: Option<FailsafeAction> = None;
        let mut fresh: Option<(FailsafeAction, &'static Failsafe)> = None;
        let mut left = present;
        while left != 0 {
            let bit = left.trailing_zeros();
            let mask = 1_u32 << bit;
            left &= !mask;
            let at = bit as usize;
            let (Some(row), Some(since)) = (FAILSAFES.get(at), state.since.get_mut(at)) else {
                break;
            };
            if begun & mask != 0 {
                *since = now;
            }
            if now.since(*since) < (row.delay)(self) && state.raised & mask == 0 {
                continue;
            }
            let action = (row.action)(self);
            worst = worst.max(Some(action));
            if (state.in_force | state.latched) & mask == 0
                && fresh.is_none_or(|(known, _)| action > known)
            {
                fresh = Some((action, row));
            }
            state.in_force |= mask;
            if shown & mask != 0 && action > FailsafeAction::Hold {
                state.latched |= mask;
            }
        }
        (worst, fresh.map(|(_, row)| row))
    }

    /// A mode can't go on. What follows, as for every other failure.
    pub fn raise(
        &self,
        state: &mut FailsafeState,
        failure: Failure,
        now: Micros,
    ) -> FailsafeAction {
        let action = failure.rule().map_or(FailsafeAction::Descend, |row| (row.action)(self));
        state.raised |= failure.mask();
        let lasts = if failure == Failure::LandingOverdue { OVERDUE_US } else { RAISED_US };
        state.raised_until = Micros(now.0.saturating_add(lasts));
        state.in_force |= failure.mask();
        if action > FailsafeAction::Hold {
            state.latched |= failure.mask();
        }
        action
    }

    /// The most severe action of some failures, bit n for row n.
    #[must_use]
    pub fn severest(&self, failures: u32) -> Option<FailsafeAction> {
        FAILSAFES
            .iter()
            .filter(|row| failures & row.failure.mask() != 0)
            .map(|row| (row.action)(self))
            .max()
    }
}

#[cfg(test)]
mod tests;
