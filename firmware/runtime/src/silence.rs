//! For how long a part has failed: whoever owns it sets it up again after a long silence.

/// A part that fails for so long wants setting up, ms.
const LONG_MS: u16 = 500;

/// Counted in the part's own readings.
#[derive(Debug, Default)]
pub(crate) struct Silence(u16);

impl Silence {
    /// It was read for the last so many milliseconds, well or not.
    pub fn note(&mut self, passed_ms: u64, is_good: bool) {
        self.0 = if is_good { 0 } else { self.0.saturating_add(passed_ms as u16) };
    }

    /// It will not come back by itself.
    pub fn give_up(&mut self) {
        self.0 = LONG_MS;
    }

    /// It wants setting up.
    pub fn is_long(&self) -> bool {
        self.0 >= LONG_MS
    }

    /// It is set up now: whether that worked shows in what it says.
    pub fn begin_anew(&mut self) {
        self.0 = 0;
    }
}
