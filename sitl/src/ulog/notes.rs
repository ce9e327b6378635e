//! What was wrong with a log, for the reader's eyes.

use super::Fault;

/// What was noted on the way; bounded, however bad the file.
#[derive(Clone, Debug, Default)]
pub struct Notes {
    faults: Vec<Fault>,
    first: Option<usize>,
    places: usize,
    lost: usize,
    pub(super) cut_at: Option<usize>,
}

impl Notes {
    const MOST: usize = 8;

    pub(super) fn fault(&mut self, fault: Fault) {
        if self.faults.len() < Self::MOST && !self.faults.contains(&fault) {
            self.faults.push(fault);
        }
    }

    pub(super) fn damage(&mut self, from: usize, to: usize) {
        self.first.get_or_insert(from);
        self.places += 1;
        self.lost += to - from;
    }

    /// One line each: nothing for a log that is whole.
    #[must_use]
    pub fn lines(&self) -> Vec<String> {
        let mut lines: Vec<String> = self.faults.iter().map(ToString::to_string).collect();
        if let Some(first) = self.first {
            let more = match self.places - 1 {
                0 => String::new(),
                more => format!(" there and in {more} more places"),
            };
            lines.push(format!("byte {first}: damaged; {} bytes left out{more}", self.lost));
        }
        if let Some(at) = self.cut_at {
            lines.push(format!("byte {at}: the log ends inside a message"));
        }
        lines
    }
}
