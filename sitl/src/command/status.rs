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
}

impl StatusLine {
    /// For standard output.
    pub fn new() -> Self {
        Self {
            is_terminal: std::io::stdout().is_terminal(),
            shown_at: None,
            shown_time: 0.0,
            is_open: false,
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
            let _ = write!(std::io::stdout(), "\r{line}\x1b[K");
            let _ = std::io::stdout().flush();
            self.is_open = true;
        } else {
            say!("{line}");
        }
    }

    /// A message of its own line.
    pub fn print(&mut self, message: &str) {
        self.close();
        say!("{message}");
    }

    /// Leaves the live line.
    pub fn close(&mut self) {
        if self.is_open {
            say!("");
            self.is_open = false;
        }
    }
}

fn text(world: &World, out: &StepOutput, factor: f64) -> String {
    let armed = if out.is_armed { "armed" } else { "disarmed" };
    let tether = out.estimate.tether.map_or_else(
        || "tether unknown".to_owned(),
        |t| {
            format!(
                "elev {:5.1} deg  azim {:6.1} deg  length {:5.2} m  tension {:4.1} N",
                t.elevation.to_degrees(),
                t.azimuth.to_degrees(),
                t.length,
                t.tension
            )
        },
    );
    let battery = out.sensors.battery.map_or_else(
        || "battery ?".to_owned(),
        |b| format!("battery {:4.1} V {:3.0} %", b.voltage, b.remaining * 100.0),
    );
    format!(
        "{:7.1} s  {:<11} {armed:<8}  {tether}  {battery}  x{factor:.1}",
        world.time(),
        out.mode.rule().name
    )
}
