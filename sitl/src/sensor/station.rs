//! What the ground station measures of its line: length, tension, direction.

use crate::plant::{Generator, Plant, V3, normal, uniform};
use crate::scenario::{SensorSection, StationSection};
use tautline_firmware::signal::{RawFairlead, RawTether};

/// Encoders and load cell, with this station's errors.
#[derive(Clone, Debug)]
pub struct StationSensors {
    section: StationSection,
    /// Of the length shown over the length paid out.
    slip: f64,
    azimuth: Arm,
    elevation: Arm,
}

/// An encoder's arm that the line drags along once its friction is overcome.
#[derive(Clone, Copy, Debug)]
struct Arm {
    offset: f64,
    /// Where it stands, rad.
    at: Option<f64>,
}

impl Arm {
    fn follow(&mut self, line: f64, hysteresis: f64) -> f64 {
        let at = self.at.map_or(line, |at| {
            // The short way round.
            let ahead = (line - at).sin().atan2((line - at).cos());
            at + ahead - ahead.clamp(-hysteresis, hysteresis)
        });
        self.at = Some(at);
        at + self.offset
    }
}

impl StationSensors {
    pub fn new(section: &StationSection, rng: &mut Generator) -> Self {
        let arm =
            |rng: &mut Generator| Arm { offset: uniform(rng) * section.angle_offset, at: None };
        Self {
            slip: uniform(rng) * section.length_slip,
            azimuth: arm(rng),
            elevation: arm(rng),
            section: section.clone(),
        }
    }

    /// Length paid out, as the encoder shows it, with `extra` m from a fault.
    pub fn length(
        &self,
        plant: &Plant,
        extra: f64,
        noise: &SensorSection,
        rng: &mut Generator,
    ) -> RawTether {
        let out = plant.tether.length() * (1.0 + self.slip) + extra;
        let shown = out + noise.length_noise * normal(rng);
        let step = self.section.length_resolution.max(1e-3);
        let shown = (shown.max(0.0) / step).round() * step;
        RawTether { length_mm: (shown * 1000.0).round() as i32 }
    }

    /// Of the load cell, N.
    pub fn tension(&self, plant: &Plant, rng: &mut Generator) -> f32 {
        (plant.tether.station_tension() + self.section.tension_noise * normal(rng)) as f32
    }

    /// Of the encoders; `None`: no line leaves.
    pub fn direction(&mut self, plant: &Plant) -> Option<RawFairlead> {
        let leaves: V3 = plant.tether.leaves();
        if leaves.norm() < 0.5 {
            return None;
        }
        let hysteresis = self.section.angle_hysteresis;
        let level = leaves.x.hypot(leaves.y);
        Some(RawFairlead {
            azimuth: self.azimuth.follow(leaves.y.atan2(leaves.x), hysteresis) as f32,
            elevation: self.elevation.follow((-leaves.z).atan2(level), hysteresis) as f32,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arm_follows_within_its_friction_the_short_way_round() {
        let mut arm = Arm { offset: 0.02, at: None };
        assert!((arm.follow(1.0, 0.05) - 1.02).abs() < 1e-12);
        // Less than the friction: it stays. More: it trails by that.
        assert!((arm.follow(1.04, 0.05) - 1.02).abs() < 1e-12);
        assert!((arm.follow(1.2, 0.05) - 1.17).abs() < 1e-12);
        let mut arm = Arm { offset: 0.0, at: Some(3.1) };
        assert!((arm.follow(-3.1, 0.0) - (std::f64::consts::TAU - 3.1)).abs() < 1e-9);
    }
}
