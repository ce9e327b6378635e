//! What can be broken, when it is, and what that cuts off.

use serde::{Deserialize, Serialize};

/// What can be broken.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum FaultKind {
    /// Inertial registers keep their last values.
    ImuFrozen,
    /// No inertial data-ready.
    ImuSilent,
    /// The inertial sensor no longer drives its bus.
    ImuDead,
    /// Rangefinder silent.
    RangefinderLost,
    /// Barometer silent.
    BarometerLost,
    /// Both altimeters silent.
    AltimeterLost,
    /// The line is cut, at `value` (0..1) of its length from the station; a straight one is gone whole.
    TetherBroken,
    /// The line is caught on something, at `value` (0..1) of its length from the station.
    Snag,
    /// The winch no longer reports its length.
    WinchSilent,
    /// The battery is at `value` (0..1) of its charge.
    BatteryAt,
    /// Nothing from the ground station or the pilot arrives; see [`Faults::cuts`].
    LinkLost,
    /// The gyro reads `value` rad/s too much on every axis.
    GyroBias,
    /// The rangefinder shows `value` m too much.
    RangeOffset,
    /// The barometer shows a height of `value` m too much.
    BarometerOffset,
    /// The encoder of the winch shows `value` m too much.
    LengthOffset,
    /// The station's encoder shows an azimuth of `value` rad too much.
    FairleadOffset,
    /// A field of `value` µT along the right arm comes on top of the earth's.
    CompassDisturbed,
    /// A force of `value` N from the South.
    PushNorth,
    /// A force of `value` N from the West.
    PushEast,
    /// A force of `value` N from above.
    PushDown,
    /// Every rotor gives `value` of its thrust.
    ThrustShare,
    /// No motion capture.
    CaptureLost,
    /// Motion capture tracks the vehicle, not the rod.
    RodUnseen,
}

/// `[[fault]]`.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct FaultSection {
    /// What.
    pub kind: FaultKind,
    /// s since power-up, which is a tenth of a second before the first step.
    pub at: f64,
    /// s; to the end when absent.
    #[serde(default)]
    pub duration: Option<f64>,
    /// For the kinds that have one.
    #[serde(default)]
    pub value: f64,
}

/// Who sends a MAVLink frame to the vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// Ground station or pilot, by the radio link.
    Ground,
    /// A device that is no part of that link: motion capture, winch.
    Companion,
}

/// All faults of a scenario and of whoever adds some at run time.
#[derive(Clone, Debug, Default)]
pub struct Faults {
    list: Vec<FaultSection>,
}

impl Faults {
    /// From the scenario.
    #[must_use]
    pub fn new(list: &[FaultSection]) -> Self {
        Self { list: list.to_vec() }
    }

    /// One more.
    pub fn add(&mut self, fault: FaultSection) {
        self.list.push(fault);
    }

    /// Its value, if the fault is active at `time`, s.
    #[must_use]
    pub fn value(&self, kind: FaultKind, time: f64) -> Option<f64> {
        self.list
            .iter()
            .find(|f| f.kind == kind && time >= f.at && f.duration.is_none_or(|d| time < f.at + d))
            .map(|f| f.value)
    }

    /// Whether the fault is active at `time`, s.
    #[must_use]
    pub fn is_active(&self, kind: FaultKind, time: f64) -> bool {
        self.value(kind, time).is_some()
    }

    /// Whether frames from `source` are lost on their way to the vehicle at `time`, s.
    ///
    /// The one place that decides: a lost link is a lost radio, and what is wired to the vehicle or
    /// has a radio of its own goes on. The way down is never cut: nothing in a flight depends on it.
    #[must_use]
    pub fn cuts(&self, source: Source, time: f64) -> bool {
        match source {
            Source::Ground => self.is_active(FaultKind::LinkLost, time),
            // `CaptureLost` and `WinchSilent` stop these devices themselves.
            Source::Companion => false,
        }
    }
}
