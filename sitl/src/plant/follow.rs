//! The plant follows another simulator's physics; what that leaves out stays the plant's own.

use super::{DT, Plant, SUBSTEPS, TICK, V3};
use nalgebra::UnitQuaternion;

/// Where a vehicle really is.
#[derive(Clone, Copy, Debug)]
pub struct Truth {
    /// Centre of mass, NED, m.
    pub position: V3,
    /// NED, m/s.
    pub velocity: V3,
    /// Body to world.
    pub attitude: UnitQuaternion<f64>,
}

/// A millisecond of other physics.
#[derive(Clone, Copy, Debug)]
pub struct Follow {
    /// Body axes, m/s².
    pub specific_force: V3,
    /// Body axes, rad/s.
    pub rate: V3,
    /// `None`: it stays where it was.
    pub truth: Option<Truth>,
    /// Length, m, and tension, N, of the line.
    pub line: Option<(f64, f64)>,
    /// Voltage, V, and current, A; `None`: this plant's battery gives what its rotors would need.
    pub battery: Option<(f64, f64)>,
}

impl Plant {
    /// One millisecond along the other's path. Rotors turn and the battery empties as in [`Plant::step`], for logs,
    /// faults and the voltage that the vehicle measures.
    pub fn follow(&mut self, throttle: &[f64], other: &Follow) {
        let voltage = self.battery.voltage();
        let share = self.model.rotor.share(DT);
        for (rotor, &u) in self.rotors.iter_mut().zip(throttle) {
            rotor.command(&self.model.rotor, u, voltage);
            for _ in 0..SUBSTEPS {
                rotor.step(&self.model.rotor, share);
            }
        }
        self.specific_force = other.specific_force;
        self.body.rate = other.rate;
        if let Some(truth) = other.truth {
            self.body.position = truth.position;
            self.body.velocity = truth.velocity;
            self.body.attitude = truth.attitude;
            // For its touch-down; its force is the other's business.
            let rotation = self.body.rotation();
            let _ = self.ground.step(&self.model.ground, &self.body, &rotation, &self.anchor);
        }
        let along = self.end().try_normalize(1e-3).unwrap_or_default();
        self.tether.follow(along, other.line);
        match other.battery {
            Some((voltage, current)) => self.battery.show(voltage, current),
            None => {
                let rotors: f64 = self.rotors.iter().map(|r| r.power(&self.model.rotor)).sum();
                let power = rotors + self.model.battery.base_power;
                self.battery.step(&self.model.battery, power, TICK);
            }
        }
        self.ticks += 1;
    }
}
