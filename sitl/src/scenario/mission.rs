//! `[[mission]]`: the steps that the built-in mission runner flies.

use serde::{Deserialize, Serialize};

/// What a taut-link mode controls beside the elevation.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum TautControl {
    /// Link force.
    Force,
    /// Pitch.
    Attitude,
}

/// `[[mission]]`: one step of the built-in mission runner.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub enum Step {
    /// Wait until the vehicle reports that it can be armed, then arm.
    Arm,
    /// Take off to this altitude, m, and wait for the hold.
    Takeoff {
        /// m over the anchor.
        altitude: f64,
    },
    /// Stay, and measure.
    Hold {
        /// s.
        seconds: f64,
    },
    /// Go to another place and wait until there; absent coordinates stay.
    Move {
        /// rad.
        #[serde(default)]
        elevation: Option<f64>,
        /// rad.
        #[serde(default)]
        azimuth: Option<f64>,
        /// m.
        #[serde(default)]
        length: Option<f64>,
        /// N.
        #[serde(default)]
        tension: Option<f64>,
    },
    /// Change to a taut-link mode and wait until it flies.
    Taut {
        /// What it controls.
        control: TautControl,
    },
    /// A smooth step in a taut-link mode; wait until it is flown.
    TautMove {
        /// From, to, rad.
        elevation: [f64; 2],
        /// Link force, N, or pitch, rad: from, to.
        second: [f64; 2],
        /// Which of the two.
        control: TautControl,
        /// s.
        duration: f64,
    },
    /// Change to Tether Angle and wait until it flies.
    TetherAngle,
    /// Change to Pendulum and wait until it flies; whoever holds the rod lets go.
    Pendulum,
    /// A hand takes the rod; the next step follows at once.
    CatchRod,
    /// Whoever holds the tether begins to walk; the next step follows at once.
    WalkAnchor {
        /// North and East, m.
        way: [f64; 2],
        /// m/s.
        speed: f64,
        /// Up to that speed and down again, s.
        ramp: f64,
    },
    /// Take the sticks: throttle down, mode Altitude. The mission keeps them from here on.
    Altitude,
    /// In Altitude: climb to a height and shake thrust, roll and pitch there.
    Excite {
        /// m over the ground.
        altitude: f64,
        /// s, the climb included.
        seconds: f64,
    },
    /// Back to Tether Hold.
    TetherHold,
    /// Land and wait until disarmed.
    Land,
    /// No ground station: wait until the pilot of `[[radio]]` has armed, flown and disarmed.
    Radio {
        /// s.
        timeout: f64,
    },
    /// Wait until disarmed, whatever the reason.
    AwaitDisarmed {
        /// s.
        timeout: f64,
    },
}

impl Step {
    /// As the file spells it.
    #[must_use]
    pub fn name(&self) -> String {
        let written = serde_json::to_value(self).unwrap_or_default();
        written.get("do").and_then(|name| name.as_str()).unwrap_or("step").to_owned()
    }

    /// Whether a step is spelled so.
    pub(super) fn is_name(name: &str) -> bool {
        let first = format!("do = {name:?}");
        STEPS.iter().any(|(text, _)| text.lines().next() == Some(first.as_str()))
    }
}

/// What is flown where the scenario does not say: take off to 5 m, hold a minute, move 20° round, land.
#[must_use]
pub fn standard_mission() -> Vec<Step> {
    let azimuth = Some(20_f64.to_radians());
    vec![
        Step::Arm,
        Step::Takeoff { altitude: 5.0 },
        Step::Hold { seconds: 60.0 },
        Step::Move { elevation: None, azimuth, length: None, tension: None },
        Step::Hold { seconds: 10.0 },
        Step::Land,
    ]
}

/// An example of every step, and what it does.
pub(super) const STEPS: &[(&str, &str)] = &[
    ("do = \"arm\"", "Wait until the vehicle can be armed, then arm."),
    (
        "do = \"takeoff\"\naltitude = 5.0",
        "Take off to this altitude over the anchor, m, and wait for the hold.",
    ),
    ("do = \"hold\"\nseconds = 40.0", "Stay, and measure."),
    (
        "do = \"move\"\nelevation = 0.8\nazimuth = 0.3\nlength = 10.0\ntension = 6.5",
        "Go to another place of the line, rad, m, N; what is absent stays.",
    ),
    ("do = \"taut\"\ncontrol = \"force\"", "Change to a mode of the taut link: force or attitude."),
    (
        "do = \"taut_move\"\nelevation = [0.8, 1.0]\nsecond = [6.0, 8.0]\ncontrol = \"force\"\nduration = 5.0",
        "A smooth step there: elevation, rad, and link force, N, or pitch, rad, from and to.",
    ),
    ("do = \"tether_angle\"", "Change to Tether Angle."),
    ("do = \"pendulum\"", "Change to Pendulum; whoever holds the rod lets go."),
    ("do = \"catch_rod\"", "A hand takes the rod."),
    (
        "do = \"walk_anchor\"\nway = [2.0, 0.0]\nspeed = 0.5\nramp = 1.0",
        "Whoever holds the line walks: North and East, m, m/s, s.",
    ),
    ("do = \"altitude\"", "Take the sticks, mode Altitude."),
    (
        "do = \"excite\"\naltitude = 5.0\nseconds = 30.0",
        "Climb there and shake thrust, roll and pitch.",
    ),
    ("do = \"tether_hold\"", "Back to Tether Hold."),
    ("do = \"land\"", "Land and wait until disarmed."),
    (
        "do = \"radio\"\ntimeout = 120.0",
        "No ground station: wait until the pilot of `[[radio]]` has armed, flown and disarmed, s.",
    ),
    ("do = \"await_disarmed\"\ntimeout = 60.0", "Wait until disarmed, whatever the reason, s."),
];
