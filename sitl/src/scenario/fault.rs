//! Which faults are active now?

use super::{FaultKind, FaultSection};

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
}
