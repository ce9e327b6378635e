//! What can be broken, when it is, and what that cuts off.

mod kinds;

pub use kinds::{FAULTS, FaultKind, FaultRule};

use super::check::within;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Body axis that a fault of the inertial sensor concerns.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Axis {
    /// Nose.
    X,
    /// Right.
    Y,
    /// Down.
    Z,
}

/// `[[fault]]`.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct FaultSection {
    /// What.
    pub kind: FaultKind,
    /// s since power-up, which is a tenth of a second before the first step; with a trigger, s after it.
    #[serde(default)]
    pub at: f64,
    /// s; to the end when absent.
    #[serde(default)]
    pub duration: Option<f64>,
    /// From what changes nothing to the whole value, s.
    #[serde(default)]
    pub ramp: f64,
    /// For the kinds that have one.
    #[serde(default)]
    pub value: f64,
    /// Of the kinds of gyro and accelerometer, the one axis; all three when absent.
    #[serde(default)]
    pub axis: Option<Axis>,
    /// Of the kinds of rotors, the one motor, from 1; all when absent.
    #[serde(default)]
    pub motor: Option<usize>,
    /// Trigger: the mission comes to this step, from 1.
    #[serde(default)]
    pub on_step: Option<usize>,
    /// Trigger: the vehicle passes this height over the ground, upwards or downwards, m.
    #[serde(default)]
    pub on_height: Option<f64>,
    /// Trigger: so much line is out, m.
    #[serde(default)]
    pub on_length: Option<f64>,
    /// Trigger: the line pulls this much at the vehicle, N.
    #[serde(default)]
    pub on_tension: Option<f64>,
}

/// Keys of a fault beside its kind: name, example, meaning.
pub const FAULT_KEYS: &[(&str, &str, &str)] = &[
    ("value", "2.0", "How much, in the kind's unit."),
    (
        "at",
        "45.0",
        "s since power-up, a tenth of a second before the first step; with a trigger, s after it.",
    ),
    ("duration", "5.0", "s; absent: to the end."),
    ("ramp", "1.0", "From what changes nothing to the whole value, s: a long one is a drift."),
    ("axis", "\"z\"", "Of gyro and accelerometer, one body axis; absent: all three."),
    ("motor", "1", "Of the rotors, one motor, from 1; absent: all."),
    ("on_step", "3", "Trigger: the mission comes to this step, from 1."),
    ("on_height", "2.0", "Trigger: the vehicle passes this height over the ground, m."),
    ("on_length", "6.0", "Trigger: so much line is out, m."),
    ("on_tension", "8.0", "Trigger: the line pulls this much at the vehicle, N."),
];

impl FaultSection {
    /// From `at` s on, to the end.
    #[must_use]
    pub fn new(kind: FaultKind, value: f64, at: f64) -> Self {
        Self {
            kind,
            at,
            value,
            duration: None,
            ramp: 0.0,
            axis: None,
            motor: None,
            on_step: None,
            on_height: None,
            on_length: None,
            on_tension: None,
        }
    }

    /// Every number within its range; `path` names the section.
    pub(super) fn check(&self, path: &str) -> Result<(), String> {
        let rule = self.kind.rule();
        within(&format!("{path}.at"), self.at, 0.0, 1e7)?;
        within(&format!("{path}.duration"), self.duration.unwrap_or(0.0), 0.0, 1e7)?;
        within(&format!("{path}.ramp"), self.ramp, 0.0, 1e7)?;
        within(&format!("{path}.value"), self.value, rule.range.0, rule.range.1)?;
        within(&format!("{path}.motor"), self.motor.unwrap_or(1) as f64, 1.0, 8.0)?;
        within(&format!("{path}.on_step"), self.on_step.unwrap_or(1) as f64, 1.0, 1e4)?;
        within(&format!("{path}.on_height"), self.on_height.unwrap_or(0.0), 0.0, 500.0)?;
        within(&format!("{path}.on_length"), self.on_length.unwrap_or(0.0), 0.0, 500.0)?;
        within(&format!("{path}.on_tension"), self.on_tension.unwrap_or(0.0), 0.0, 1e4)
    }

    fn has_trigger(&self) -> bool {
        let levels = [self.on_height, self.on_length, self.on_tension];
        self.on_step.is_some() || levels.iter().any(Option::is_some)
    }

    /// Whether its trigger has come, between two looks.
    fn is_triggered(&self, before: &FaultFacts, now: &FaultFacts) -> bool {
        let crosses = |level: f64, a: f64, b: f64| (a < level) != (b < level);
        self.on_step.is_some_and(|step| now.step >= step)
            || self.on_height.is_some_and(|level| crosses(level, before.height, now.height))
            || self.on_length.is_some_and(|level| now.length >= level)
            || self.on_tension.is_some_and(|level| now.tension >= level)
    }
}

/// What triggers look at.
#[derive(Clone, Copy, Debug, Default)]
pub struct FaultFacts {
    /// Step of the mission, from 1.
    pub step: usize,
    /// Over the ground, m.
    pub height: f64,
    /// Of the line, m.
    pub length: f64,
    /// At the vehicle, N.
    pub tension: f64,
}

/// Who sends a MAVLink frame to the vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// Ground station or pilot, by the radio link.
    Ground,
    /// A device that is no part of that link: motion capture, winch.
    Companion,
}

/// One fault and when it begins, s, once that is known.
#[derive(Clone, Debug)]
struct Armed {
    fault: FaultSection,
    since: Option<f64>,
}

impl Armed {
    /// Its value now, if it is active.
    fn value(&self, time: f64) -> Option<f64> {
        let since = self.since.filter(|&since| time >= since)?;
        let age = time - since;
        if self.fault.duration.is_some_and(|duration| age >= duration) {
            return None;
        }
        let neutral = self.fault.kind.rule().neutral;
        let share = if age < self.fault.ramp { age / self.fault.ramp } else { 1.0 };
        Some(neutral + (self.fault.value - neutral) * share)
    }
}

/// All faults of a scenario and of whoever adds some at run time.
#[derive(Clone, Debug, Default)]
pub struct Faults {
    list: Vec<Armed>,
    facts: FaultFacts,
}

impl Faults {
    /// From the scenario.
    #[must_use]
    pub fn new(list: &[FaultSection]) -> Self {
        let mut faults = Self::default();
        for fault in list {
            faults.add(fault.clone());
        }
        faults
    }

    /// One more.
    pub fn add(&mut self, fault: FaultSection) {
        let since = (!fault.has_trigger()).then_some(fault.at);
        self.list.push(Armed { fault, since });
    }

    /// Ends every fault of a kind.
    pub fn clear(&mut self, kind: FaultKind) {
        self.list.retain(|armed| armed.fault.kind != kind);
    }

    /// The mission has come to a step, from 1.
    pub fn reach_step(&mut self, step: usize) {
        self.facts.step = step;
    }

    /// Looks whether triggers have come; `facts.step` is left as the mission said.
    pub fn look(&mut self, facts: FaultFacts, time: f64) {
        let now = FaultFacts { step: self.facts.step, ..facts };
        let before = std::mem::replace(&mut self.facts, now);
        for armed in self.list.iter_mut().filter(|armed| armed.since.is_none()) {
            if armed.fault.is_triggered(&before, &now) {
                armed.since = Some(time + armed.fault.at);
            }
        }
    }

    /// Nothing is or will be broken.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    fn active(&self, kind: FaultKind, time: f64) -> impl Iterator<Item = (&FaultSection, f64)> {
        self.list
            .iter()
            .filter(move |armed| armed.fault.kind == kind)
            .filter_map(move |armed| Some((&armed.fault, armed.value(time)?)))
    }

    /// Its value, if the fault is active at `time`, s.
    #[must_use]
    pub fn value(&self, kind: FaultKind, time: f64) -> Option<f64> {
        self.active(kind, time).next().map(|(_, value)| value)
    }

    /// What it adds, zero when it is not active.
    #[must_use]
    pub fn added(&self, kind: FaultKind, time: f64) -> f64 {
        self.active(kind, time).map(|(_, value)| value).sum()
    }

    /// What it adds to each body axis.
    #[must_use]
    pub fn on_axes(&self, kind: FaultKind, time: f64) -> Vector3<f64> {
        self.active(kind, time)
            .map(|(fault, value)| match fault.axis {
                None => Vector3::repeat(value),
                Some(Axis::X) => Vector3::x() * value,
                Some(Axis::Y) => Vector3::y() * value,
                Some(Axis::Z) => Vector3::z() * value,
            })
            .sum()
    }

    /// Whether each body axis is concerned.
    #[must_use]
    pub fn axes(&self, kind: FaultKind, time: f64) -> [bool; 3] {
        [Axis::X, Axis::Y, Axis::Z].map(|axis| {
            self.active(kind, time).any(|(fault, _)| fault.axis.is_none_or(|one| one == axis))
        })
    }

    /// Its value for a motor, from 0.
    #[must_use]
    pub fn on_motor(&self, kind: FaultKind, time: f64, motor: usize) -> Option<f64> {
        self.active(kind, time)
            .find(|(fault, _)| fault.motor.is_none_or(|one| one == motor + 1))
            .map(|(_, value)| value)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_comes_up_over_its_ramp_from_what_changes_nothing_and_ends() {
        let fault = FaultSection {
            ramp: 2.0,
            duration: Some(5.0),
            motor: Some(2),
            ..FaultSection::new(FaultKind::ThrustShare, 0.5, 10.0)
        };
        let faults = Faults::new(&[fault]);
        let at = |time| faults.on_motor(FaultKind::ThrustShare, time, 1);
        assert_eq!(
            [at(9.9), at(10.0), at(11.0), at(13.0), at(15.0)],
            [None, Some(1.0), Some(0.75), Some(0.5), None]
        );
        assert_eq!(faults.on_motor(FaultKind::ThrustShare, 13.0, 0), None, "another motor");
    }

    #[test]
    fn a_trigger_starts_the_clock_of_its_fault_once() {
        let fault = FaultSection {
            on_height: Some(3.0),
            ..FaultSection::new(FaultKind::RangefinderLost, 0.0, 1.0)
        };
        let mut faults = Faults::new(&[fault]);
        let look = |faults: &mut Faults, height, time| {
            faults.look(FaultFacts { height, ..FaultFacts::default() }, time);
            faults.is_active(FaultKind::RangefinderLost, time)
        };
        assert!(!look(&mut faults, 2.0, 5.0));
        assert!(!look(&mut faults, 3.1, 6.0), "a second after it");
        assert!(look(&mut faults, 2.0, 7.0));
        assert!(look(&mut faults, 3.1, 9.0), "once is enough");
    }

    #[test]
    fn axes_add_up() {
        let one = |axis| FaultSection { axis, ..FaultSection::new(FaultKind::AccelBias, 1.0, 0.0) };
        let faults = Faults::new(&[one(None), one(Some(Axis::Z))]);
        assert_eq!(faults.on_axes(FaultKind::AccelBias, 1.0), Vector3::new(1.0, 1.0, 2.0));
        assert_eq!(faults.axes(FaultKind::AccelBias, 1.0), [true; 3]);
    }

    #[test]
    fn the_file_spells_every_kind_as_the_table_does() {
        for rule in FAULTS {
            let text = format!("kind = {:?}", rule.name);
            let fault: FaultSection = toml::from_str(&text).unwrap();
            assert_eq!(fault.kind, rule.kind);
            assert_eq!(fault.kind.rule().name, rule.name);
        }
    }
}
