//! What an operator should read, with MAVLink's severities.

use core::fmt;

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

/// A number that ends a message.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Amount {
    /// What would do, or what is so.
    pub value: f32,
    /// Its unit.
    pub unit: &'static str,
}

impl fmt::Display for Amount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // By tenths: the formatting of floats is 10 KB of an image.
        let tenths = libm::roundf(self.value * 10.0) as i32;
        let sign = if tenths < 0 { "-" } else { "" };
        let tenths = tenths.unsigned_abs();
        write!(f, "{sign}{}.{} {}", tenths / 10, tenths % 10, self.unit)
    }
}

/// Longest message, bytes: what one STATUSTEXT carries.
pub const TEXT_MAX: usize = 50;

/// One message of at most [`TEXT_MAX`] bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// How urgent.
    pub severity: Severity,
    /// For the operator.
    pub text: &'static str,
    /// After the text.
    pub amount: Option<Amount>,
}

impl fmt::Display for Event {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.text)?;
        match &self.amount {
            Some(amount) => write!(f, " {amount}"),
            None => Ok(()),
        }
    }
}

impl Event {
    /// An event of severity [`Severity::Info`].
    #[must_use]
    pub const fn info(text: &'static str) -> Self {
        Self { severity: Severity::Info, text, amount: None }
    }
    /// An event of severity [`Severity::Warning`].
    #[must_use]
    pub const fn warning(text: &'static str) -> Self {
        Self { severity: Severity::Warning, text, amount: None }
    }
    /// An event of severity [`Severity::Critical`].
    #[must_use]
    pub const fn critical(text: &'static str) -> Self {
        Self { severity: Severity::Critical, text, amount: None }
    }
    /// The whole message.
    #[must_use]
    pub fn message(&self) -> heapless::String<TEXT_MAX> {
        let mut cut = Cut::default();
        let _ = fmt::write(&mut cut, format_args!("{self}"));
        cut.0
    }
}

/// Takes what fits and leaves the rest: a cut message says more than none.
#[derive(Default)]
struct Cut(heapless::String<TEXT_MAX>);

impl fmt::Write for Cut {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for c in text.chars() {
            self.0.push(c).map_err(|_| fmt::Error)?;
        }
        Ok(())
    }
}

/// Events that one step may have.
pub const EVENTS_MAX: usize = 6;

/// Events of one step. When full, later ones are dropped and counted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EventQueue {
    slots: [Option<Event>; EVENTS_MAX],
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_that_is_too_long_is_cut_and_not_lost() {
        let long = Event::warning("0123456789 0123456789 0123456789 0123456789 012345\u{e9}789");
        assert_eq!(long.message(), "0123456789 0123456789 0123456789 0123456789 012345");
        // A letter of two bytes does not stand half.
        let straddles = Event::info("0123456789 0123456789 0123456789 0123456789 01234\u{e9}");
        assert_eq!(straddles.message().len(), 49);
        let amount = Some(Amount { value: -0.25, unit: "m" });
        assert_eq!(Event { amount, ..Event::info("Off by") }.message(), "Off by -0.3 m");
    }
}
