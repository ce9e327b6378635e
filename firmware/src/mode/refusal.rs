//! Why something asked is not done, for the operator.

use crate::signal::{Action, Amount, Event, Outcome};
use crate::supervisor::Links;

/// How the request ends, and the reason.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Refusal {
    pub outcome: Outcome,
    pub reason: Event,
}

impl Refusal {
    /// With the number that would do.
    pub const fn but_for(mut self, value: f32, unit: &'static str) -> Self {
        self.reason.amount = Some(Amount { value, unit });
        self
    }
}

/// Not now.
pub(crate) const fn rejected(text: &'static str) -> Refusal {
    Refusal { outcome: Outcome::Rejected, reason: Event::warning(text) }
}

/// Never with these values.
pub(crate) const fn denied(text: &'static str) -> Refusal {
    Refusal { outcome: Outcome::Denied, reason: Event::warning(text) }
}

/// Of every mode on a taut link.
pub(crate) const NEEDS_FIXED_LENGTH: Refusal = denied("Mode refused: needs a link of fixed length");

/// Of the mode that flies without a tether.
pub(super) const NEEDS_FREE_FLIGHT: &str = "Mode refused: needs TET_KIND 4, free flight";

/// Of a mode that does not fly on what this vehicle hangs on.
pub(crate) const fn needs_link(on: Links) -> Refusal {
    match on {
        Links::Free => denied(NEEDS_FREE_FLIGHT),
        Links::Any | Links::FixedLength | Links::Cable => NEEDS_FIXED_LENGTH,
    }
}

/// This image has no such mode.
pub(crate) const NOT_BUILT: Refusal = denied("Mode refused: not in this image");

/// The mode does not know this command.
pub(super) fn not_here(action: &Action) -> Refusal {
    rejected(match action {
        Action::MoveTaut { .. } => "Move refused: not in a taut-link mode",
        _ => "Move refused: not in Tether Hold in the air",
    })
}

pub(super) fn check_heading(yaw: Option<f32>) -> Result<(), Refusal> {
    let is_bad = |yaw: f32| !yaw.is_finite() || yaw.abs() > 100.0;
    if yaw.is_some_and(is_bad) { Err(denied("Move refused: not a number")) } else { Ok(()) }
}
