//! What an operator should read, with MAVLink's severities.

/// How urgent, as MAVLink counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Severity {
    /// Immediate danger.
    Critical = 2,
    /// Something failed.
    Error = 3,
    /// Something may fail.
    Warning = 4,
    /// Worth knowing.
    Info = 6,
}

/// One message; the text is at most 50 bytes, as one STATUSTEXT carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event {
    /// How urgent.
    pub severity: Severity,
    /// For the operator.
    pub text: &'static str,
}

impl Event {
    /// An event of severity [`Severity::Info`].
    #[must_use]
    pub const fn info(text: &'static str) -> Self {
        Self { severity: Severity::Info, text }
    }
    /// An event of severity [`Severity::Warning`].
    #[must_use]
    pub const fn warning(text: &'static str) -> Self {
        Self { severity: Severity::Warning, text }
    }
    /// An event of severity [`Severity::Critical`].
    #[must_use]
    pub const fn critical(text: &'static str) -> Self {
        Self { severity: Severity::Critical, text }
    }
}

/// Events of one step. When full, later ones are dropped and counted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EventQueue {
    slots: [Option<Event>; 6],
    /// Events that found no room.
    pub dropped: u8,
}

impl EventQueue {
    /// Adds one.
    pub fn push(&mut self, event: Event) {
        match self.slots.iter_mut().find(|slot| slot.is_none()) {
            Some(slot) => *slot = Some(event),
            None => self.dropped = self.dropped.saturating_add(1),
        }
    }
    /// Nothing happened, nothing was dropped.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.slots.first().is_none_or(Option::is_none)
    }
    /// In the order of arrival.
    pub fn iter(&self) -> impl Iterator<Item = &Event> {
        self.slots.iter().flatten()
    }
}
