//! `[[radio]]`: what a pilot does with a radio, and how it arrives.

use super::check::within;
use super::key::KeyValue;
use serde::{Deserialize, Serialize};
use tautline_firmware::sense::MODE_SLOTS;
use tautline_hal_shim::fake::Protocol;
use tautline_hal_shim::radio::CHANNELS;

/// `[sensors] radio`.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum RadioKind {
    /// There is none.
    #[default]
    None,
    /// ExpressLRS and Crossfire.
    Crsf,
    /// One way, without a link quality.
    Sbus,
}

impl KeyValue for RadioKind {
    fn check(&self, _: &str, _: Option<(f64, f64)>) -> Result<(), String> {
        Ok(())
    }
}

impl RadioKind {
    /// What the receiver speaks; `None`: there is none.
    #[must_use]
    pub const fn protocol(self) -> Option<Protocol> {
        match self {
            Self::None => None,
            Self::Crsf => Some(Protocol::Crsf),
            Self::Sbus => Some(Protocol::Sbus),
        }
    }
}

/// `[[radio]]`: what the pilot's hands change at a time. What a row leaves out stays.
#[derive(Clone, Debug, Default, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct RadioSection {
    /// s since power-up.
    pub at: f64,
    /// -1 to 1, right positive.
    pub roll: Option<f64>,
    /// -1 to 1, forward positive.
    pub pitch: Option<f64>,
    /// -1 to 1, clockwise positive.
    pub yaw: Option<f64>,
    /// 0 to 1.
    pub throttle: Option<f64>,
    /// Position of the mode switch, from 1.
    pub mode: Option<u64>,
    /// The arm switch.
    pub arm: Option<bool>,
    /// The kill switch.
    pub kill: Option<bool>,
}

/// Keys of a row: name, example, meaning.
pub const RADIO_KEYS: &[(&str, &str, &str)] = &[
    ("at", "12.0", "s since power-up; rows come in the order of their times."),
    ("roll", "0.0", "-1 to 1, right positive; channel 1."),
    ("pitch", "0.3", "-1 to 1, forward positive; channel 2."),
    ("throttle", "0.5", "0 to 1; channel 3."),
    ("yaw", "0.0", "-1 to 1, clockwise positive; channel 4."),
    ("mode", "4", "Position of the mode switch, 1 to 6; channel 5."),
    ("arm", "true", "The arm switch; channel 6."),
    ("kill", "false", "The kill switch; channel 7."),
];

/// Middle and half range of a channel, µs.
const MIDDLE: f64 = 1_500.0;
const HALF: f64 = 500.0;

impl RadioSection {
    /// Every number within its range; `path` names the row.
    pub(super) fn check(&self, path: &str, after: f64) -> Result<(), String> {
        within(&format!("{path}.at"), self.at, 0.0, 1e6)?;
        if self.at < after {
            return Err(format!("{path}.at = {} is before {after}", self.at));
        }
        let sticks = [("roll", self.roll), ("pitch", self.pitch), ("yaw", self.yaw)];
        let throttle = [("throttle", self.throttle)];
        for (low, named) in [(-1.0, &sticks[..]), (0.0, &throttle[..])] {
            for (key, value) in named {
                value.map_or(Ok(()), |value| within(&format!("{path}.{key}"), value, low, 1.0))?;
            }
        }
        let most = MODE_SLOTS as f64;
        self.mode.map_or(Ok(()), |slot| within(&format!("{path}.mode"), slot as f64, 1.0, most))
    }

    /// What the pilot's transmitter sends at a time, µs: sticks in their middle, throttle down and switches off until a
    /// row says otherwise.
    #[must_use]
    pub fn channels(rows: &[Self], time: f64) -> [f64; CHANNELS] {
        let mut channels = [MIDDLE; CHANNELS];
        let [roll, pitch, throttle, yaw, mode, arm, kill, ..] = &mut channels;
        for switch in [&mut *throttle, &mut *mode, &mut *arm, &mut *kill] {
            *switch = MIDDLE - HALF;
        }
        let set = |channel: &mut f64, value: Option<f64>| {
            *channel = value.map_or(*channel, |value| MIDDLE + HALF * value);
        };
        let way = |share: f64| 2.0 * share - 1.0;
        for row in rows.iter().take_while(|row| row.at <= time) {
            set(roll, row.roll);
            set(pitch, row.pitch);
            set(yaw, row.yaw);
            set(throttle, row.throttle.map(way));
            set(mode, row.mode.map(|slot| way((slot as f64 - 1.0) / (MODE_SLOTS as f64 - 1.0))));
            set(arm, row.arm.map(|is_on| way(f64::from(is_on))));
            set(kill, row.kill.map(|is_on| way(f64::from(is_on))));
        }
        channels
    }
}
