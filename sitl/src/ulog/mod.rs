//! Reading ULog, our own and others', whole or damaged.
//!
//! A [`Log`] lends what stands in the bytes, message by message. Nothing declared in a file is believed before
//! it is checked against the file's length, and what is damaged is left out and noted, not refused: the rest
//! of a flight is worth reading. Format: <https://docs.px4.io/main/en/dev_log/ulog_file_format.html>.

mod body;
mod format;
mod json;
mod layout;
mod log;
mod notes;
mod scalar;
mod table;
#[cfg(test)]
mod tests;

pub use body::{Message, Text, Value};
pub use log::Log;
pub use notes::Notes;
pub use scalar::Scalar;
pub use table::{Column, Table, tables};

use layout::Layout;
use std::rc::Rc;

/// What is wrong with a file, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Offset in the file.
    pub at: usize,
    /// What was expected or found there.
    pub what: String,
}

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "byte {}: {}", self.at, self.what)
    }
}

/// One sample of a topic.
#[derive(Clone, Debug)]
pub struct Data<'a> {
    /// Topic.
    pub topic: &'a str,
    /// Which of several of the same topic.
    pub instance: u8,
    bytes: &'a [u8],
    layout: Rc<Layout<'a>>,
}

impl Data<'_> {
    /// A number by its path, as `x`, `control[2]` or `pose.x`; `None` if the topic has no such.
    #[must_use]
    pub fn number(&self, path: &str) -> Option<f64> {
        let (at, scalar) = self.layout.find(path)?;
        scalar.number(self.bytes.get(at..)?)
    }

    /// All elements of an array of numbers.
    #[must_use]
    pub fn numbers(&self, name: &str) -> Option<Vec<f64>> {
        let (at, scalar, count) = self.layout.array(name)?;
        (0..count).map(|i| scalar.number(self.bytes.get(at + i * scalar.size()..)?)).collect()
    }

    /// s.
    #[must_use]
    pub fn time(&self) -> Option<f64> {
        Some(self.number("timestamp")? * 1e-6)
    }
}
