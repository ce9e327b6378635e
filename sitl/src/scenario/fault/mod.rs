//! What can be broken, when it is, and what that cuts off.

mod kinds;
mod section;

pub use kinds::{FAULTS, FaultKind, FaultRule};
pub use section::{Axis, FAULT_KEYS, FaultFacts, FaultSection, When};

use super::Step;
use nalgebra::Vector3;
use std::f64::consts::TAU;

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
    /// Its value now and for how long it has been there, s, if it is active.
    fn value(&self, time: f64) -> Option<(f64, f64)> {
        let since = self.since.filter(|&since| time >= since)?;
        let age = time - since;
        if self.fault.duration.is_some_and(|duration| age >= duration) {
            return None;
        }
        let neutral = self.fault.kind.rule().neutral;
        let share = if age < self.fault.ramp { age / self.fault.ramp } else { 1.0 };
        Some((neutral + (self.fault.value - neutral) * share, age))
    }
}

/// All faults of a scenario and of whoever adds some at run time.
#[derive(Clone, Debug, Default)]
pub struct Faults {
    list: Vec<Armed>,
    facts: FaultFacts,
}

impl Faults {
    /// Of a scenario that flies this mission.
    #[must_use]
    pub fn new(list: &[FaultSection], mission: &[Step]) -> Self {
        let mut faults = Self::default();
        for fault in list {
            faults.add(fault.clone().resolved(mission));
        }
        faults
    }

    /// One more.
    pub fn add(&mut self, fault: FaultSection) {
        let fault = fault.resolved(&[]);
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

    fn aged(&self, kind: FaultKind, time: f64) -> impl Iterator<Item = (&FaultSection, f64, f64)> {
        self.list.iter().filter(move |armed| armed.fault.kind == kind).filter_map(move |armed| {
            let (value, age) = armed.value(time)?;
            Some((&armed.fault, value, age))
        })
    }

    fn active(&self, kind: FaultKind, time: f64) -> impl Iterator<Item = (&FaultSection, f64)> {
        self.aged(kind, time).map(|(fault, value, _)| (fault, value))
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

    /// Level, away from where it comes from, NED.
    #[must_use]
    pub fn away(&self, kind: FaultKind, time: f64) -> Vector3<f64> {
        self.active(kind, time)
            .map(|(fault, value)| Vector3::new(fault.from.cos(), fault.from.sin(), 0.0) * -value)
            .sum()
    }

    /// Of what swings with this amplitude: where it is, and its rate per second.
    #[must_use]
    pub fn swinging(&self, kind: FaultKind, time: f64) -> (f64, f64) {
        let states = self.aged(kind, time).map(|(fault, value, age)| {
            let rate = TAU / fault.period;
            let (sin, cos) = (rate * age).sin_cos();
            (value * sin, value * rate * cos)
        });
        states.fold((0.0, 0.0), |(x, v), (dx, dv)| (x + dx, v + dv))
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
            .find(|(fault, _)| fault.rotor.is_none_or(|one| one == motor + 1))
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
            rotor: Some(2),
            ..FaultSection::new(FaultKind::MotorThrust, 0.5, 10.0)
        };
        let faults = Faults::new(&[fault], &[]);
        let at = |time| faults.on_motor(FaultKind::MotorThrust, time, 1);
        assert_eq!(
            [at(9.9), at(10.0), at(11.0), at(13.0), at(15.0)],
            [None, Some(1.0), Some(0.75), Some(0.5), None]
        );
        assert_eq!(faults.on_motor(FaultKind::MotorThrust, 13.0, 0), None, "another motor");
    }

    #[test]
    fn a_trigger_starts_the_clock_of_its_fault_once() {
        let fault = FaultSection {
            on_height: Some(3.0),
            ..FaultSection::new(FaultKind::RangefinderLost, 0.0, 1.0)
        };
        let mut faults = Faults::new(&[fault], &[]);
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
        let faults = Faults::new(&[one(None), one(Some(Axis::Z))], &[]);
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

    #[test]
    fn a_step_is_waited_for_by_its_name_and_must_be_one_of_the_mission() {
        let wait = |step: &str| {
            let text = format!(
                "[[fault]]\nkind = \"motor_thrust\"\nrotor = 2\nvalue = 0.5\nwhen = {{ step = {step:?}, after = 2.0 }}
                 [[mission]]\ndo = \"arm\"\n[[mission]]\ndo = \"hold\"\nseconds = 9.0"
            );
            crate::scenario::Scenario::parse(&text, "s")
        };
        let scenario = wait("hold").unwrap();
        let mut faults = Faults::new(&scenario.fault, &scenario.mission);
        faults.look(FaultFacts::default(), 4.0);
        faults.reach_step(2);
        faults.look(FaultFacts::default(), 5.0);
        let at = |time| faults.on_motor(FaultKind::MotorThrust, time, 1);
        assert_eq!([at(6.9), at(7.0)], [None, Some(0.5)]);
        let error = wait("land").unwrap_err().0;
        assert_eq!(error, "s: fault[0].when.step = \"land\": the mission has no such step");
        let two = "[[fault]]\nkind = \"snag\"\nwhen = { height_above = 1.0, length_above = 2.0 }";
        assert!(crate::scenario::Scenario::parse(two, "s").unwrap_err().0.contains("wants one of"));
    }

    #[test]
    fn what_comes_from_somewhere_goes_away_from_it_and_what_swings_begins_at_rest() {
        let gust = FaultSection { from: TAU / 4.0, ..FaultSection::new(FaultKind::Gust, 3.0, 0.0) };
        let rock = FaultSection { period: 4.0, ..FaultSection::new(FaultKind::DeckRock, 0.1, 1.0) };
        let faults = Faults::new(&[gust, rock], &[]);
        assert!((faults.away(FaultKind::Gust, 1.0) - Vector3::new(0.0, -3.0, 0.0)).norm() < 1e-12);
        let (angle, rate) = faults.swinging(FaultKind::DeckRock, 1.0);
        assert!(angle.abs() < 1e-12 && (rate - 0.1 * TAU / 4.0).abs() < 1e-12);
        assert!((faults.swinging(FaultKind::DeckRock, 2.0).0 - 0.1).abs() < 1e-12);
    }
}
