//! Physics of another simulator: PX4's simulator interface or ArduPilot's JSON backend (docs/physics.md).
//!
//! The firmware, its drivers and their register-level parts stay; the plant only follows. Lockstep: a millisecond of
//! the firmware waits for a frame that reaches it, and the other simulator waits for the answer.

mod address;
mod json;
mod px4;

pub use address::Address;

use super::MavlinkSender;
use crate::plant::{Follow, Plant, Truth, V3};
use crate::sensor::Measured;
use json::Json;
use px4::Px4;
use std::time::{Duration, Instant};
use tautline_firmware::signal::MAX_ROTORS;

/// So long in real time a simulator may say nothing, or stand still.
const SILENCE: Duration = Duration::from_secs(5);
/// So long it may take to start.
const START: Duration = Duration::from_secs(30);
/// Longest time between two frames, µs: nothing flies on what is older.
const LONGEST_GAP_US: u64 = 500_000;
/// Between two reports of the winch, as the plant's own winch sends them, µs.
const WINCH_US: u64 = 20_000;
/// Nothing on a tether measures more of anything, in SI units.
const LARGEST: f64 = 1e4;
/// Channel of the winch's tension, in both interfaces.
const WINCH_CHANNEL: usize = 15;

/// What the vehicle asks of the world.
#[derive(Clone, Copy, Debug)]
pub struct Command {
    /// 0 to 1, in the order of the motor outputs.
    pub throttle: [f64; MAX_ROTORS],
    /// Tension that the winch shall hold, N.
    pub winch: f64,
}

/// What the winch reports.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Winch {
    /// Line paid out, m.
    length: f64,
    /// N.
    tension: f64,
}

/// What another simulator measures at one instant.
#[derive(Clone, Copy, Debug, Default)]
struct Frame {
    /// Simulated, from wherever it counts, µs.
    time_us: u64,
    /// Specific force, body axes, m/s².
    accel: V3,
    /// Body axes, rad/s.
    gyro: V3,
    /// By air pressure, m; `None`: the truth's.
    height: Option<f64>,
    /// Of the rangefinder to the ground, m.
    range: Option<f64>,
    /// A report that came with this frame.
    winch: Option<Winch>,
    /// Voltage, V, and current, A; `None`: the plant's own battery.
    battery: Option<(f64, f64)>,
    /// Where it really is.
    truth: Option<Truth>,
}

fn is_possible(x: f64) -> bool {
    x.abs() < LARGEST
}

impl Frame {
    /// # Errors
    /// The first field that no vehicle has.
    fn check(&self) -> Result<(), String> {
        let check = |name: &str, values: &[f64]| match values.iter().find(|x| !is_possible(**x)) {
            Some(bad) => Err(format!("{name} is {bad}")),
            None => Ok(()),
        };
        check("specific force", self.accel.as_slice())?;
        check("angular rate", self.gyro.as_slice())?;
        check("height by pressure", self.height.as_slice())?;
        check("range", self.range.as_slice())?;
        if let Some(winch) = self.winch {
            check("winch length or tension", &[winch.length, winch.tension])?;
        }
        if let Some((voltage, current)) = self.battery {
            check("battery voltage or current", &[voltage, current])?;
        }
        if let Some(truth) = &self.truth {
            check("position", truth.position.as_slice())?;
            check("velocity", truth.velocity.as_slice())?;
            check("attitude", truth.attitude.as_vector().as_slice())?;
        }
        Ok(())
    }
}

#[derive(Debug)]
enum Source {
    Px4(Box<Px4>),
    Json(Box<Json>),
}

impl Source {
    /// Answers the last frame and waits for the next.
    fn exchange(&mut self, command: &Command) -> Result<Frame, String> {
        match self {
            Self::Px4(px4) => px4.exchange(command),
            Self::Json(json) => json.exchange(command),
        }
    }
}

/// Physics of another simulator, and how far it has come.
#[derive(Debug)]
pub struct Physics {
    source: Source,
    address: Address,
    frame: Frame,
    /// Their time and ours at the first frame, µs.
    began: Option<(u64, u64)>,
    winch_due_us: u64,
    failure: Option<String>,
}

impl Physics {
    /// Connects; the first frame is awaited in the first millisecond. `plant` is where the flight starts.
    ///
    /// # Errors
    /// One line when nobody is there.
    pub fn connect(address: &Address, system: u8, plant: &Plant) -> Result<Self, String> {
        let (start, sender) = (plant.body.position, MavlinkSender::new(u32::from(system), 1));
        let source = match address {
            Address::Px4(at) => Px4::connect(at, sender, start).map(|x| Source::Px4(Box::new(x))),
            Address::Json(at) => Json::connect(at).map(|x| Source::Json(Box::new(x))),
        };
        let source = source.map_err(|e| format!("physics {address}: {e}"))?;
        Ok(Self::new(source, address.clone()))
    }

    fn new(source: Source, address: Address) -> Self {
        Self {
            source,
            address,
            frame: Frame::default(),
            began: None,
            winch_due_us: 0,
            failure: None,
        }
    }

    /// What ended it, in one line.
    #[must_use]
    pub fn failure(&self) -> Option<&str> {
        self.failure.as_deref()
    }

    /// Whether the simulator knows where the vehicle really is.
    #[must_use]
    pub fn has_truth(&self) -> bool {
        self.frame.truth.is_some()
    }

    /// The millisecond that ends at `due_us`: what the sensors show then. After a failure the last frame holds.
    pub fn step(&mut self, due_us: u64, command: &Command, plant: &mut Plant) -> Measured {
        if self.failure.is_none()
            && let Err(why) = self.reach(due_us, command)
        {
            self.failure = Some(format!("physics {}: {why}", self.address));
        }
        let frame = &mut self.frame;
        let mut winch = None;
        if due_us >= self.winch_due_us {
            winch = frame.winch.take();
        }
        if winch.is_some() {
            self.winch_due_us = due_us + WINCH_US;
        }
        plant.follow(
            &command.throttle,
            &Follow {
                specific_force: frame.accel,
                rate: frame.gyro,
                truth: frame.truth,
                line: winch.map(|winch| (winch.length, winch.tension)),
                battery: frame.battery,
            },
        );
        Measured { height: frame.height, range: frame.range, winch_reports: winch.is_some() }
    }

    /// Exchanges frames until one is no older than `due_us`.
    fn reach(&mut self, due_us: u64, command: &Command) -> Result<(), String> {
        let asked = Instant::now();
        loop {
            if let Some((theirs, ours)) = self.began
                && ours + (self.frame.time_us - theirs) >= due_us
            {
                return Ok(());
            }
            let mut frame = self.source.exchange(command)?;
            frame.check()?;
            let before = self.frame.time_us;
            if self.began.is_some() {
                if frame.time_us < before {
                    let (from, to) = (before as f64 * 1e-6, frame.time_us as f64 * 1e-6);
                    return Err(format!(
                        "time went back from {from:.3} s to {to:.3} s: a reset needs a new flight"
                    ));
                }
                let gap = frame.time_us - before;
                if gap > LONGEST_GAP_US {
                    return Err(format!("time jumped by {:.3} s", gap as f64 * 1e-6));
                }
                if gap == 0 && asked.elapsed() > SILENCE {
                    return Err(format!("time stands still for {} s", SILENCE.as_secs()));
                }
            }
            self.began.get_or_insert((frame.time_us, due_us));
            // A report waits until it is shown.
            frame.winch = frame.winch.or(self.frame.winch);
            self.frame = frame;
        }
    }
}

#[cfg(test)]
mod tests;
