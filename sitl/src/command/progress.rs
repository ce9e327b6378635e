//! How far is a campaign, and how long will it take? A bar on a terminal, a line now and then elsewhere.

use indicatif::{HumanDuration, ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::time::{Duration, Instant};

/// Between two lines where there is no terminal.
const PAUSE: Duration = Duration::from_secs(30);

/// Counts flights.
#[derive(Debug)]
pub struct Progress {
    bar: ProgressBar,
    failed: u64,
    is_terminal: bool,
    told: Instant,
}

impl Progress {
    /// Of so many flights.
    pub fn new(flights: u64) -> Self {
        let is_terminal = std::io::stderr().is_terminal();
        let bar = if is_terminal { ProgressBar::new(flights) } else { ProgressBar::hidden() };
        bar.set_length(flights);
        if let Ok(style) = ProgressStyle::with_template("{bar:40} {pos}/{len}, {msg}{eta} left") {
            bar.set_style(style);
        }
        Self { bar, failed: 0, is_terminal, told: Instant::now() }
    }

    /// One more has ended.
    pub fn count(&mut self, has_passed: bool) {
        if !has_passed {
            self.failed += 1;
            self.bar.set_message(format!("{} failed, ", self.failed));
        }
        self.bar.inc(1);
        if !self.is_terminal && self.told.elapsed() >= PAUSE {
            self.told = Instant::now();
            eprintln!(
                "{} of {} flown, {} failed, {} left",
                self.bar.position(),
                self.bar.length().unwrap_or_default(),
                self.failed,
                HumanDuration(self.bar.eta())
            );
        }
    }

    /// All have ended.
    pub fn close(&self) {
        self.bar.finish_and_clear();
    }
}
