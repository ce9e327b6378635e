//! The live status line; plain lines, and fewer, when nobody watches a terminal.

use crate::flight::World;
use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};
use tautline_firmware::vehicle::StepOutput;

const LIVE: Duration = Duration::from_millis(200);
const PLAIN: Duration = Duration::from_secs(10);

/// Prints at most so often.
#[derive(Debug)]
pub struct StatusLine {
    is_terminal: bool,
    shown_at: Option<Instant>,
    shown_time: f64,
    is_open: bool,
    told: String,
    repeats: u32,
}

impl StatusLine {
    /// For standard output.
    pub fn new() -> Self {
        Self {
            is_terminal: std::io::stdout().is_terminal(),
            shown_at: None,
            shown_time: 0.0,
            is_open: false,
            told: String::new(),
            repeats: 0,
        }
    }

    /// Shows the status if it is time to.
    pub fn show(&mut self, world: &World, out: &StepOutput) {
        let period = if self.is_terminal { LIVE } else { PLAIN };
        let now = Instant::now();
        let Some(last) = self.shown_at else {
            self.shown_at = Some(now);
            return;
        };
        let elapsed = now - last;
        if elapsed < period {
            return;
        }
        let factor = (world.time() - self.shown_time) / elapsed.as_secs_f64();
        (self.shown_at, self.shown_time) = (Some(now), world.time());
        let line = text(world, out, factor);
        if self.is_terminal {
            let line = clipped(&line, columns());
            let _ = write!(std::io::stdout(), "\r{line}\x1b[K");
            let _ = std::io::stdout().flush();
            self.is_open = true;
        } else {
            say!("{line}");
        }
    }

    /// What the vehicle says; over and over is once, and how often.
    pub fn tell(&mut self, time: f64, text: &str) {
        if text == self.told {
            self.repeats += 1;
            return;
        }
        self.settle();
        text.clone_into(&mut self.told);
        self.print(&format!("{time:7.1} s  {text}"));
    }

    fn settle(&mut self) {
        let times = std::mem::take(&mut self.repeats);
        if times > 0 {
            self.print(&format!("           {} ({times} times more)", self.told));
        }
    }

    /// A message of its own line.
    pub fn print(&mut self, message: &str) {
        self.close();
        say!("{message}");
    }

    /// The end.
    pub fn finish(&mut self) {
        self.settle();
        self.close();
    }

    /// Leaves the live line.
    fn close(&mut self) {
        if self.is_open {
            say!("");
            self.is_open = false;
        }
    }
}

/// Of the terminal; what any has where it does not say.
fn columns() -> usize {
    terminal_size::terminal_size().map_or(80, |(width, _)| width.0.into())
}

/// A line that is too long scrolls the terminal.
fn clipped(line: &str, columns: usize) -> &str {
    let end = line.char_indices().nth(columns.saturating_sub(1)).map_or(line.len(), |(at, _)| at);
    line.get(..end).unwrap_or(line)
}

fn text(world: &World, out: &StepOutput, factor: f64) -> String {
    let armed = if out.is_armed { "armed" } else { "disarmed" };
    let tether = out.estimate.tether.map_or_else(
        || "tether unknown".to_owned(),
        |t| {
            format!(
                "elev {:3.0} azim {:4.0} deg {:5.2} m {:4.1} N",
                t.elevation.to_degrees(),
                t.azimuth.to_degrees(),
                t.length,
                t.tension
            )
        },
    );
    let battery = out.sensors.battery.map_or_else(
        || "battery ?".to_owned(),
        |b| format!("{:4.1} V {:3.0} %", b.voltage, b.remaining * 100.0),
    );
    format!(
        "{:7.1} s  {:<11} {armed:<8} {tether} {battery} x{factor:.1}",
        world.time(),
        out.mode.rule().name
    )
}

#[cfg(test)]
mod tests {
    use super::clipped;

    #[test]
    fn a_line_stays_within_its_terminal() {
        assert_eq!(clipped("0123456789", 20), "0123456789");
        assert_eq!(clipped("0123456789", 6), "01234");
        assert_eq!(clipped("\u{b5}\u{b5}\u{b5}\u{b5}", 3), "\u{b5}\u{b5}");
        assert_eq!(clipped("", 0), "");
    }
}
