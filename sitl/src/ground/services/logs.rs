//! LOG_REQUEST_*: a list of the flight logs, and their bytes.

use super::Answers;
use super::files::{Files, Open};
use mavlink::dialects::common::{LOG_DATA_DATA, LOG_ENTRY_DATA};
use tautline_firmware::mavlink::Frame;

/// Bytes in one message.
const PIECE: u32 = 90;
/// Messages in a millisecond: a tenth of a megabyte a second.
const AT_ONCE: usize = 10;

/// A download under way.
#[derive(Debug, Default)]
pub struct LogDownload {
    /// Number of the log, next byte, and how many more.
    wanted: Option<(u16, u32, u32)>,
    open: Option<(u16, Open)>,
}

impl LogDownload {
    /// LOG_REQUEST_LIST: all that are asked for; none of none if there is none.
    pub fn list(&mut self, frame: &Frame, files: &Files, answers: &mut Answers) {
        let logs = files.logs();
        let num_logs = u16::try_from(logs.len()).unwrap_or(u16::MAX);
        let last_log_num = num_logs.saturating_sub(1);
        let (first, last) = (frame.word(0), frame.word(2));
        if logs.is_empty() {
            answers.send(&LOG_ENTRY_DATA::default());
        }
        for (log, id) in logs.iter().zip(0_u16..).filter(|(_, id)| (first..=last).contains(id)) {
            let (time_utc, size) = (log.time, log.size);
            answers.send(&LOG_ENTRY_DATA { time_utc, size, id, num_logs, last_log_num });
        }
    }

    /// LOG_REQUEST_DATA.
    pub fn begin(&mut self, frame: &Frame) {
        let word = |at: usize| frame.int(at) as u32;
        self.wanted = Some((frame.word(8), word(0), word(4)));
    }

    /// LOG_REQUEST_END.
    pub fn end(&mut self) {
        *self = Self::default();
    }

    /// Some of it.
    pub fn step(&mut self, files: &Files, answers: &mut Answers) {
        for _ in 0..AT_ONCE {
            let Some((id, ofs, left)) = self.wanted.take() else { return };
            if self.open.as_ref().is_none_or(|(number, _)| *number != id) {
                self.open = files.open_log(usize::from(id)).map(|open| (id, open));
            }
            let mut data = [0; PIECE as usize];
            let room = data.get_mut(..left.min(PIECE) as usize).unwrap_or(&mut []);
            let open = self.open.as_mut().map(|(_, open)| open);
            // A log that is not there has no bytes.
            let count = open.and_then(|open| open.read(ofs, room).ok()).unwrap_or(0) as u32;
            answers.send(&LOG_DATA_DATA { ofs, id, count: count as u8, data });
            let left = left.saturating_sub(count);
            // Less than was asked for is the end.
            self.wanted = (count == PIECE && left > 0).then_some((id, ofs + count, left));
        }
    }
}
