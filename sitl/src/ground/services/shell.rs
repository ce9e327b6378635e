//! SERIAL_CONTROL: a shell that looks and touches nothing.

use super::{Answers, Host};
use mavlink::dialects::common::{SERIAL_CONTROL_DATA, SerialControlDev, SerialControlFlag};
use std::fmt::Write;
use tautline_firmware::mavlink::Frame;
use tautline_firmware::param::{ALIASES, META};
use tautline_firmware::supervisor::FAILSAFES;

/// Where the typed bytes stand, and how many there may be.
const COUNT: usize = 8;
const DATA: usize = 9;
const PIECE: usize = 70;
/// Longest line; what is longer begins anew.
const LINE: usize = 200;
const DEVICE: usize = 6;
/// `SERIAL_CONTROL_DEV_SHELL`.
const SHELL: u8 = 10;
const PROMPT: &str = "tautline> ";
const HELP: &str = "help      this list
status    mode, battery, estimate
params    all parameters, or those that begin so
tether    elevation, azimuth, length, tension
faults    failures of the vehicle, faults of the simulation
version   what runs here
perf      what the link has carried
";

/// What has been typed.
#[derive(Debug, Default)]
pub struct Shell {
    line: String,
}

impl Shell {
    /// Takes what was typed; answers each line.
    pub fn take(&mut self, frame: &Frame, host: &Host, answers: &mut Answers) {
        if frame.byte(DEVICE) != SHELL {
            return;
        }
        let count = usize::from(frame.byte(COUNT)).min(PIECE);
        let mut said = String::new();
        for at in 0..count {
            match frame.byte(DATA + at) {
                b'\n' | b'\r' => {
                    let line = std::mem::take(&mut self.line);
                    said += "\n";
                    said += &obey(line.trim(), host);
                    said += PROMPT;
                }
                byte if self.line.len() < LINE => {
                    self.line.push(char::from(byte));
                    said.push(char::from(byte));
                }
                _ => self.line.clear(),
            }
        }
        for piece in said.as_bytes().chunks(PIECE) {
            let mut data = [0; PIECE];
            data.iter_mut().zip(piece).for_each(|(to, from)| *to = *from);
            answers.send(&SERIAL_CONTROL_DATA {
                baudrate: 0,
                timeout: 0,
                device: SerialControlDev::SERIAL_CONTROL_DEV_SHELL,
                flags: SerialControlFlag::SERIAL_CONTROL_FLAG_REPLY,
                count: piece.len() as u8,
                data,
            });
        }
    }
}

fn obey(line: &str, host: &Host) -> String {
    let mut words = line.split_whitespace();
    match (words.next(), words.next()) {
        (None, _) => String::new(),
        (Some("help"), _) => HELP.into(),
        (Some("status"), _) => status(host),
        (Some("params"), prefix) => params(host, prefix.unwrap_or("")),
        (Some("tether"), _) => tether(host),
        (Some("faults"), _) => faults(host),
        (Some("version"), _) => {
            let (version, revision) = (env!("CARGO_PKG_VERSION"), env!("TAUTLINE_REVISION"));
            format!("Tautline {version} in the simulator, commit {revision}\n")
        }
        (Some("perf"), _) => format!("{:.3} s since power-up\n", host.out.now.0 as f64 * 1e-6),
        (Some(other), _) => format!("{other}: unknown; try help\n"),
    }
}

fn status(host: &Host) -> String {
    let (out, estimate) = (host.out, &host.out.estimate);
    let armed = if out.is_armed { "armed" } else { "disarmed" };
    let (roll, pitch, yaw) = estimate.attitude.euler();
    let [roll, pitch, yaw] = [roll, pitch, yaw].map(f32::to_degrees);
    let mut text = format!("{} {armed}, {:?}\n", out.mode.rule().name, out.ground);
    let _ = writeln!(text, "roll {roll:.1} pitch {pitch:.1} yaw {yaw:.1} deg");
    let _ = writeln!(text, "height {:.2} m, climb {:.2} m/s", estimate.height, estimate.climb);
    if let Some(position) = &estimate.position {
        let p = position.0;
        let _ = writeln!(text, "position {:.2} {:.2} {:.2} m NED", p.x, p.y, p.z);
    }
    if let Some(battery) = &out.sensors.battery {
        let share = battery.remaining * 100.0;
        let _ = writeln!(text, "battery {:.1} V {share:.0} %", battery.voltage);
    }
    text
}

fn params(host: &Host, prefix: &str) -> String {
    let ours = META.iter().zip(0..).map(|(meta, at)| (meta.name, host.params.get(at)));
    let theirs = ALIASES.iter().map(|alias| (alias.name, Some(alias.value(host.params))));
    let mut text = String::new();
    for (name, value) in ours.chain(theirs).filter(|(name, _)| name.starts_with(prefix)) {
        let _ = writeln!(text, "{name} {}", value.unwrap_or_default());
    }
    text
}

fn tether(host: &Host) -> String {
    match &host.out.estimate.tether {
        None => "tether unknown\n".into(),
        Some(t) => format!(
            "elevation {:.1} deg, azimuth {:.1} deg, length {:.2} m, tension {:.1} N, {}\n",
            t.elevation.to_degrees(),
            t.azimuth.to_degrees(),
            t.length,
            t.tension,
            if t.is_taut { "taut" } else { "slack" }
        ),
    }
}

fn faults(host: &Host) -> String {
    let mut text = String::new();
    for row in FAILSAFES.iter().filter(|row| host.out.failures & row.failure.mask() != 0) {
        let _ = writeln!(text, "failure: {}", row.text);
    }
    for name in host.faults {
        let _ = writeln!(text, "simulated fault: {name}");
    }
    if text.is_empty() { "none\n".into() } else { text }
}
