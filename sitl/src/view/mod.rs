//! A flight as a page shows it, and as somebody flies it there: docs/view.md.
//!
//! The same messages go over the page's WebSocket and into the flight that a browser computes itself.

mod ask;
#[cfg(feature = "cli")]
mod http;
#[cfg(feature = "cli")]
mod live;
mod panel;
mod pilot;
#[cfg(feature = "cli")]
mod server;
mod snapshot;
mod trial;

pub use ask::{Ask, Asked};
#[cfg(feature = "cli")]
pub use live::View;
pub use panel::Panel;
pub use pilot::{Pilot, answers};
pub use snapshot::{Snapshot, Text, last_texts};
pub use trial::{TRIALS, Trial};

use serde::Serialize;

/// What a page receives; JSON with a field `type`.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Message {
    /// Once, before anything else.
    Panel(Panel),
    /// 30 times a second.
    Snapshot(Box<Snapshot>),
    /// A line for whoever asked.
    Note {
        /// One line.
        text: String,
    },
}

impl Message {
    /// As it is sent.
    #[must_use]
    pub fn json(&self) -> String {
        // Every key is a string, so nothing in it can be refused.
        serde_json::to_string(self).unwrap_or_default()
    }

    /// A note.
    #[must_use]
    pub fn note(text: impl Into<String>) -> Self {
        Self::Note { text: text.into() }
    }
}

#[cfg(feature = "cli")]
#[cfg(test)]
mod tests;
