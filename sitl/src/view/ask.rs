//! What somebody at the page asks for.

use super::Pilot;
use crate::flight::Environment;
use crate::scenario::{FAULTS, FaultKind, FaultSection};
use mavlink::dialects::common::MavCmd;
use serde::Deserialize;
use tautline_firmware::supervisor::MODES;

/// One request; JSON with a field `do`. Sticks are -1 to 1, the throttle 0 to 1; lengths in m, angles in rad.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub enum Ask {
    /// The page is there: a ground station's heartbeat.
    Beat,
    /// Start the motors.
    Arm,
    /// Stop them, on the ground.
    Disarm,
    /// Stop them, wherever it is.
    Terminate,
    /// Take off.
    Takeoff {
        /// Over the anchor, m.
        altitude_m: f32,
    },
    /// Change the mode.
    Mode {
        /// As the mode table has it.
        name: String,
    },
    /// Move in tether coordinates; what is left out stays.
    Move {
        /// rad.
        elevation_rad: Option<f32>,
        /// rad.
        azimuth_rad: Option<f32>,
        /// m.
        length_m: Option<f32>,
        /// N.
        tension_n: Option<f32>,
    },
    /// Where the sticks are.
    Sticks {
        /// Forward.
        pitch: f32,
        /// To the right.
        roll: f32,
        /// Up.
        throttle: f32,
        /// Nose to the right.
        yaw: f32,
    },
    /// Break something.
    Fault {
        /// As the scenario file spells it.
        kind: FaultKind,
        /// In the kind's unit.
        #[serde(default)]
        value: f64,
        /// One motor, from 1; all when absent.
        #[serde(default)]
        motor: Option<usize>,
    },
    /// Mend it, or everything.
    Clear {
        /// Absent: everything.
        #[serde(default)]
        kind: Option<FaultKind>,
    },
}

/// What becomes of a request.
#[derive(Clone, Debug, PartialEq)]
pub enum Asked {
    /// A MAVLink frame for the vehicle.
    Frame(Vec<u8>),
    /// Done in the simulator, or not: a line for whoever asked.
    Note(String),
}

impl Ask {
    /// From a page's message.
    ///
    /// # Errors
    /// One line that says what is wrong with it.
    pub fn parse(text: &str) -> Result<Self, String> {
        serde_json::from_str(text).map_err(|e| format!("not understood: {e}"))
    }

    /// Makes it a frame of the pilot's, or does it to the simulated world, if `commander` allows it.
    pub fn act(
        &self,
        pilot: &mut Pilot,
        environment: &mut Environment,
        commander: Option<u8>,
    ) -> Asked {
        let degrees = |x: Option<f32>| x.map_or(f32::NAN, f32::to_degrees);
        let plain = |x: Option<f32>| x.unwrap_or(f32::NAN);
        let (command, p) = match self {
            Self::Beat => return Asked::Frame(pilot.heartbeat()),
            Self::Sticks { pitch, roll, throttle, yaw } => {
                return Asked::Frame(pilot.sticks([*pitch, *roll, *throttle, *yaw]));
            }
            Self::Fault { .. } | Self::Clear { .. } => {
                let is_strange = commander.is_some_and(|known| known != pilot.system());
                return Asked::Note(if is_strange {
                    "Refused: another ground station has command".to_owned()
                } else {
                    self.break_or_mend(environment)
                });
            }
            Self::Mode { name } => {
                let Some(rule) = MODES.iter().find(|rule| rule.name == name) else {
                    return Asked::Note(format!("no mode {name}"));
                };
                return Asked::Frame(pilot.mode(rule.mode));
            }
            Self::Arm => {
                (MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
            }
            Self::Disarm => (MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, [0.0; 7]),
            Self::Terminate => {
                (MavCmd::MAV_CMD_DO_FLIGHTTERMINATION, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
            }
            Self::Takeoff { altitude_m } => {
                let nan = f32::NAN;
                (MavCmd::MAV_CMD_NAV_TAKEOFF, [0.0, 0.0, 0.0, nan, nan, nan, *altitude_m])
            }
            Self::Move { elevation_rad, azimuth_rad, length_m, tension_n } => {
                let (elevation, azimuth) = (degrees(*elevation_rad), degrees(*azimuth_rad));
                let (length, tension) = (plain(*length_m), plain(*tension_n));
                (MavCmd::MAV_CMD_USER_1, [elevation, azimuth, length, tension, 0.0, 0.0, 0.0])
            }
        };
        Asked::Frame(pilot.command(command, p))
    }

    fn break_or_mend(&self, environment: &mut Environment) -> String {
        let time = environment.now().0 as f64 * 1e-6;
        let faults = &mut environment.faults;
        match self {
            Self::Fault { kind, value, motor } => {
                let rule = kind.rule();
                if !(rule.range.0..=rule.range.1).contains(value) {
                    let (least, most) = rule.range;
                    return format!("fault {}: a value from {least} to {most}", rule.name);
                }
                if motor.is_some_and(|motor| !(1..=8).contains(&motor)) {
                    return format!("fault {}: a motor from 1 to 8", rule.name);
                }
                // Asked for again, it takes the place of the first; motors fail one by one.
                if motor.is_none() {
                    faults.clear(*kind);
                }
                faults
                    .add(FaultSection { rotor: *motor, ..FaultSection::new(*kind, *value, time) });
                format!("fault {}: on", rule.name)
            }
            Self::Clear { kind: Some(kind) } => {
                faults.clear(*kind);
                format!("fault {}: off", kind.rule().name)
            }
            _ => {
                FAULTS.iter().for_each(|rule| faults.clear(rule.kind));
                "all faults: off".to_owned()
            }
        }
    }
}
