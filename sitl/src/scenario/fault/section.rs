//! `[[fault]]`: one fault as the file has it.

use super::FaultKind;
use crate::scenario::Step;
use crate::scenario::check::within;
use serde::{Deserialize, Serialize};

/// Axis that a fault concerns: of the body, or of the world for a force.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Axis {
    /// Nose, or North.
    X,
    /// Right, or East.
    Y,
    /// Down.
    Z,
}

/// `when`: what a fault waits for.
#[derive(Clone, Debug, Default, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct When {
    /// The mission comes to its first step of this name.
    pub step: Option<String>,
    /// The vehicle passes this height over the ground, upwards or downwards, m.
    pub height_above: Option<f64>,
    /// So much line is out, m.
    pub length_above: Option<f64>,
    /// The line pulls this much at the vehicle, N.
    pub tension_above: Option<f64>,
    /// And then so long, s.
    pub after: f64,
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
    /// A trigger.
    #[serde(default)]
    pub when: Option<When>,
    /// s; to the end when absent.
    #[serde(default)]
    pub duration: Option<f64>,
    /// From what changes nothing to the whole value, s.
    #[serde(default)]
    pub ramp: f64,
    /// For the kinds that have one.
    #[serde(default)]
    pub value: f64,
    /// Of the kinds of gyro and accelerometer, the one axis, all three when absent; of a force or the centre of mass, which.
    #[serde(default)]
    pub axis: Option<Axis>,
    /// Of the kinds of rotors, the one, from 1; all when absent.
    #[serde(default, alias = "motor")]
    pub rotor: Option<usize>,
    /// Of the kinds that come from somewhere: from where, rad from North.
    #[serde(default)]
    pub from: f64,
    /// Of what rocks, s.
    #[serde(default = "period")]
    pub period: f64,
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

/// Of a small vessel, s.
fn period() -> f64 {
    8.0
}

/// Of a drift that names no ramp, s.
const DRIFT_RAMP: f64 = 60.0;

/// Keys of a fault beside its kind: name, example, meaning.
pub const FAULT_KEYS: &[(&str, &str, &str)] = &[
    ("value", "2.0", "How much, in the kind's unit."),
    (
        "at",
        "45.0",
        "s since power-up, a tenth of a second before the first step; with a trigger, s after it.",
    ),
    (
        "when",
        "{ step = \"hold\", after = 10.0 }",
        "Trigger: the mission comes to its first step of this name, or `height_above`, `length_above` (m) or `tension_above` (N) is passed; `after` s more.",
    ),
    ("duration", "5.0", "s; absent: to the end."),
    ("ramp", "1.0", "From what changes nothing to the whole value, s: a long one is a drift."),
    (
        "axis",
        "\"z\"",
        "Of gyro and accelerometer, one body axis, absent: all three; of `force` (x North, y East, z down) and `centre_of_mass`, which.",
    ),
    ("rotor", "1", "Of the rotors, one, from 1; absent: all. `motor` is the same."),
    ("from", "1.57", "Of what comes from somewhere, rad from North."),
    ("period", "8.0", "Of what rocks, s."),
    ("on_step", "3", "Trigger: the mission comes to this step, from 1."),
    ("on_height", "2.0", "Trigger, as `height_above`, m."),
    ("on_length", "6.0", "Trigger, as `length_above`, m."),
    ("on_tension", "8.0", "Trigger, as `tension_above`, N."),
];

impl FaultSection {
    /// From `at` s on, to the end.
    #[must_use]
    pub fn new(kind: FaultKind, value: f64, at: f64) -> Self {
        Self {
            kind,
            at,
            when: None,
            value,
            duration: None,
            ramp: 0.0,
            axis: None,
            rotor: None,
            from: 0.0,
            period: period(),
            on_step: None,
            on_height: None,
            on_length: None,
            on_tension: None,
        }
    }

    /// Every number within its range, and what the kind wants is there; `path` names the section.
    pub(in crate::scenario) fn check(&self, path: &str, mission: &[Step]) -> Result<(), String> {
        let rule = self.kind.rule();
        within(&format!("{path}.at"), self.at, 0.0, 1e7)?;
        within(&format!("{path}.duration"), self.duration.unwrap_or(0.0), 0.0, 1e7)?;
        within(&format!("{path}.ramp"), self.ramp, 0.0, 1e7)?;
        within(&format!("{path}.value"), self.value, rule.range.0, rule.range.1)?;
        within(&format!("{path}.rotor"), self.rotor.unwrap_or(1) as f64, 1.0, 8.0)?;
        within(&format!("{path}.from"), self.from, -6.3, 6.3)?;
        within(&format!("{path}.period"), self.period, 1.0, 600.0)?;
        within(&format!("{path}.on_step"), self.on_step.unwrap_or(1) as f64, 1.0, 1e4)?;
        within(&format!("{path}.on_height"), self.on_height.unwrap_or(0.0), 0.0, 500.0)?;
        within(&format!("{path}.on_length"), self.on_length.unwrap_or(0.0), 0.0, 500.0)?;
        within(&format!("{path}.on_tension"), self.on_tension.unwrap_or(0.0), 0.0, 1e4)?;
        let wants_axis = matches!(self.kind, FaultKind::Force | FaultKind::CentreOfMass);
        if wants_axis && self.axis.is_none() {
            return Err(format!("{path}.axis is missing: {} has one", rule.name));
        }
        if self.kind == FaultKind::CentreOfMass && self.axis == Some(Axis::Z) {
            return Err(format!("{path}.axis = \"z\": {} is x or y", rule.name));
        }
        self.when.as_ref().map_or(Ok(()), |when| when.check(&format!("{path}.when"), mission))
    }

    /// The same with its trigger as numbers.
    #[must_use]
    pub fn resolved(mut self, mission: &[Step]) -> Self {
        if self.kind == FaultKind::BarometerDrift && self.ramp <= 0.0 {
            self.ramp = DRIFT_RAMP;
        }
        let Some(when) = self.when.take() else { return self };
        if let Some(name) = &when.step {
            let first = mission.iter().position(|step| step.name() == *name);
            // A mission without that step never comes to it.
            self.on_step = Some(first.map_or(usize::MAX, |index| index + 1));
        }
        self.on_height = self.on_height.or(when.height_above);
        self.on_length = self.on_length.or(when.length_above);
        self.on_tension = self.on_tension.or(when.tension_above);
        self.at += when.after;
        self
    }

    pub(super) fn has_trigger(&self) -> bool {
        let levels = [self.on_height, self.on_length, self.on_tension];
        self.on_step.is_some() || levels.iter().any(Option::is_some)
    }

    /// Whether its trigger has come, between two looks.
    pub(super) fn is_triggered(&self, before: &FaultFacts, now: &FaultFacts) -> bool {
        let crosses = |level: f64, a: f64, b: f64| (a < level) != (b < level);
        self.on_step.is_some_and(|step| now.step >= step)
            || self.on_height.is_some_and(|level| crosses(level, before.height, now.height))
            || self.on_length.is_some_and(|level| now.length >= level)
            || self.on_tension.is_some_and(|level| now.tension >= level)
    }
}

impl When {
    fn check(&self, path: &str, mission: &[Step]) -> Result<(), String> {
        within(&format!("{path}.after"), self.after, 0.0, 1e7)?;
        within(&format!("{path}.height_above"), self.height_above.unwrap_or(0.0), 0.0, 500.0)?;
        within(&format!("{path}.length_above"), self.length_above.unwrap_or(0.0), 0.0, 500.0)?;
        within(&format!("{path}.tension_above"), self.tension_above.unwrap_or(0.0), 0.0, 1e4)?;
        let levels = [self.height_above, self.length_above, self.tension_above];
        let triggers = levels.iter().flatten().count() + usize::from(self.step.is_some());
        if triggers != 1 {
            return Err(format!(
                "{path} wants one of step, height_above, length_above and tension_above"
            ));
        }
        let Some(name) = &self.step else { return Ok(()) };
        // Whoever flies without a mission of the file's own may fly any step.
        let is_known = if mission.is_empty() {
            Step::is_name(name)
        } else {
            mission.iter().any(|step| step.name() == *name)
        };
        if is_known {
            return Ok(());
        }
        Err(format!("{path}.step = {name:?}: the mission has no such step"))
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
