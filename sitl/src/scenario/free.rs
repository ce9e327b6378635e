//! Sections for free flight: motion capture, a rod on top, a push.

use crate::plant::DisturbanceKind;
use serde::{Deserialize, Serialize};

/// `[capture]`.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct CaptureSection {
    /// Samples per second; zero: no motion capture.
    pub rate: f64,
    /// Until a sample arrives, s.
    pub delay: f64,
    /// Further up to this much, s.
    pub jitter: f64,
    /// Share of samples that never arrive.
    pub dropped: f64,
    /// m.
    pub position_noise: f64,
    /// rad.
    pub attitude_noise: f64,
    /// Of the rod's direction, each axis, rad.
    pub rod_noise: f64,
}

impl Default for CaptureSection {
    fn default() -> Self {
        Self {
            rate: 0.0,
            delay: 0.02,
            jitter: 0.002,
            dropped: 0.01,
            position_noise: 1e-3,
            attitude_noise: 2e-3,
            rod_noise: 2e-3,
        }
    }
}

/// `[rod]`: a load balanced on top. Somebody holds it until the mission's step `pendulum`.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct RodSection {
    /// kg; zero: no rod.
    pub load_mass: f64,
    /// m.
    pub length: f64,
    /// How far the hand leans it, rad.
    pub tilt: f64,
    /// Towards where, rad from North.
    pub azimuth: f64,
    /// From the change of mode until the hand lets go, s.
    pub reaction: f64,
}

impl Default for RodSection {
    fn default() -> Self {
        Self { load_mass: 0.0, length: 0.7, tilt: 0.05, azimuth: 0.8, reaction: 0.2 }
    }
}

/// `[push]`: a force on the vehicle.
#[derive(Clone, Debug, Default, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct PushSection {
    /// none, constant or stochastic.
    pub kind: DisturbanceKind,
}
