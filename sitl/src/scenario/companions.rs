//! Sensors with a computer of their own, by one word: what a flow sensor and a satellite receiver are, in the keys of
//! `[capture]`.

use super::CaptureSection;
use super::key::KeyValue;
use serde::{Deserialize, Serialize};

/// `[sensors] gnss`.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Gnss {
    /// There is none.
    #[default]
    None,
    /// Metres off, and wandering.
    Plain,
    /// Corrected by a base station: centimetres.
    Rtk,
}

impl KeyValue for Gnss {
    fn check(&self, _: &str, _: Option<(f64, f64)>) -> Result<(), String> {
        Ok(())
    }
}

impl Gnss {
    /// What the receiver shows; `None`: there is none.
    #[must_use]
    pub fn receiver(self) -> Option<CaptureSection> {
        let (rate, position_noise) = match self {
            Self::None => return None,
            Self::Plain => (5.0, 0.4),
            Self::Rtk => (10.0, 0.02),
        };
        let delay = Self::DELAY;
        Some(CaptureSection { rate, position_noise, delay, jitter: 0.01, ..Default::default() })
    }

    /// Until a place arrives, s.
    pub const DELAY: f64 = 0.1;

    /// Standard deviation that an operator sets for it, m: errors that last a minute count as often as they are told.
    #[must_use]
    pub fn deviation(self) -> f64 {
        if self == Self::Plain { 5.0 } else { 0.03 }
    }
}

impl CaptureSection {
    /// An optical flow sensor with a rangefinder: speed over the ground, 0.1 m/s of noise and 3 % of scale.
    #[must_use]
    pub fn flow() -> Self {
        Self {
            rate: 50.0,
            position: false,
            velocity_noise: 0.1,
            velocity_scale: 0.03,
            ..Self::default()
        }
    }
}
