//! Everything but the firmware: the physical world, the vehicle's devices, and its companions.

use super::breakage::Breakage;
use super::capture::MotionCapture;
use super::physics::{Command, Physics};
use crate::ground::Winch;
use crate::plant::{Disturbance, Plant, PlantModel, Push, generator};
use crate::scenario::{DisturbanceKind, FAULTS, FaultKind, Faults, Scenario, Source};
use crate::sensor::SensorSuite;
use std::f64::consts::PI;
use tautline_firmware::param::Params;
use tautline_firmware::sense::Mounting;
use tautline_firmware::signal::MAX_ROTORS;
use tautline_firmware::supervisor::Mode;
use tautline_firmware::time::Micros;
use tautline_hal_shim::fake::{FakeClock, FakeEsc};

/// Simulation step, µs.
pub const STEP_US: u64 = 1_000;

/// What the firmware flies in.
#[derive(Debug)]
pub struct Environment {
    clock: FakeClock,
    /// Physical truth.
    pub plant: Plant,
    /// The vehicle's devices.
    pub sensors: SensorSuite,
    /// Faults.
    pub faults: Faults,
    breakage: Breakage,
    /// The ground end's computer.
    pub winch: Winch,
    /// Motion capture, and what publishes as it does.
    captures: Vec<MotionCapture>,
    /// Another simulator's, instead of the plant's.
    pub physics: Option<Physics>,
    /// From the change of mode until the rod is released, s; and when that change was, s.
    reaction: f64,
    balancing_since: Option<f64>,
    started_us: u64,
}

impl Environment {
    /// Powers everything up; the devices are not set up yet.
    #[must_use]
    pub fn new(scenario: &Scenario, params: &Params, seed: u64) -> Self {
        let clock = FakeClock::default();
        let mut rng = generator(seed, 3);
        let wind_from = crate::plant::uniform(&mut rng) * PI;
        let (distance, heading) = scenario.start();
        let mut plant = Plant::new(PlantModel::new(scenario, wind_from), distance, heading, seed);
        if scenario.push.kind != DisturbanceKind::None {
            plant.push = Some(Push::new(Disturbance::new(scenario.push.kind, seed)));
        }
        let mounting = Mounting::from_parameter(params.board_rotation).unwrap_or(Mounting::ALIGNED);
        Self {
            breakage: Breakage::new(&plant),
            winch: Winch::new(params.system_id as u8),
            plant,
            sensors: SensorSuite::new(scenario, clock.clone(), mounting, seed),
            faults: Faults::new(&scenario.fault, &scenario.mission),
            captures: MotionCapture::all(scenario, params.system_id as u8, seed),
            physics: None,
            reaction: scenario.rod.reaction,
            balancing_since: None,
            started_us: 0,
            clock,
        }
    }

    /// Simulated time, for devices beside.
    #[must_use]
    pub fn clock(&self) -> &FakeClock {
        &self.clock
    }

    /// The firmware's set-up took simulated time; steps count from the next whole millisecond.
    pub fn begin(&mut self) {
        self.started_us = self.clock.now_us().next_multiple_of(STEP_US);
        self.clock.advance_to(self.started_us);
    }

    /// µs since power-up.
    #[must_use]
    pub fn now(&self) -> Micros {
        Micros(self.clock.now_us())
    }

    /// Seconds since the first step.
    #[must_use]
    pub fn time(&self) -> f64 {
        (self.clock.now_us() - self.started_us) as f64 * 1e-6
    }

    /// Whether a fault is active now.
    #[must_use]
    pub fn is_active(&self, kind: FaultKind) -> bool {
        self.faults.is_active(kind, self.clock.now_us() as f64 * 1e-6)
    }

    /// Names of the faults that are active now.
    #[must_use]
    pub fn active_faults(&self) -> Vec<&'static str> {
        let active = FAULTS.iter().filter(|rule| self.is_active(rule.kind));
        active.map(|rule| rule.name).collect()
    }

    /// Hands on a MAVLink frame to the vehicle, unless a fault cuts off its source.
    pub fn deliver(&self, source: Source, frame: &[u8], receive: &mut dyn FnMut(&[u8])) {
        if !self.faults.cuts(source, self.clock.now_us() as f64 * 1e-6) {
            receive(frame);
        }
    }

    /// One millisecond of physics, with the commands of the motors and the winch.
    pub fn advance(&mut self, escs: &[FakeEsc], mut winch: f64) {
        let mut throttle = [0.0; MAX_ROTORS];
        for (throttle, esc) in throttle.iter_mut().zip(escs) {
            *throttle = esc.throttle();
        }
        let time = self.clock.now_us() as f64 * 1e-6;
        self.breakage.apply(&mut self.faults, time, &mut self.plant, &mut throttle, &mut winch);
        let due_us = self.clock.now_us() + STEP_US;
        match &mut self.physics {
            None => {
                self.winch.drive(&mut self.plant, &mut winch);
                self.plant.step(&throttle, winch);
                self.winch.release(&mut self.plant);
            }
            Some(physics) => {
                let command = Command { throttle, winch };
                self.sensors.measured = Some(physics.step(due_us, &command, &mut self.plant));
            }
        }
        self.clock.advance_to(due_us);
    }

    /// Whether anybody knows where the vehicle really is.
    #[must_use]
    pub fn has_truth(&self) -> bool {
        self.physics.as_ref().is_none_or(Physics::has_truth)
    }

    /// Publishes the motion capture's frames that arrive now.
    pub fn publish_capture(&mut self, publish: &mut dyn FnMut(&[u8])) {
        let now_us = self.clock.now_us();
        for capture in &mut self.captures {
            let is_cut = self.faults.cuts(Source::Companion, now_us as f64 * 1e-6);
            capture.step(now_us, &self.plant, &self.faults, &mut |frame| {
                if !is_cut {
                    publish(frame);
                }
            });
        }
    }

    /// Exposes the devices to this millisecond, for a reader outside.
    pub fn expose(&mut self) {
        self.sensors.expose(&self.plant, &self.faults);
    }

    /// The drivers read it.
    pub fn read(&mut self) -> tautline_firmware::sense::RawSensors {
        self.sensors.read(&self.plant, &self.faults)
    }

    /// Releases the rod from the hand that holds it, some time after the mode has changed to balancing it.
    pub fn release_rod(&mut self, mode: Mode) {
        if mode != Mode::Pendulum {
            self.balancing_since = None;
            return;
        }
        let now = self.time();
        let since = *self.balancing_since.get_or_insert(now);
        let is_due = (since + self.reaction..since + self.reaction + 1.5e-3).contains(&now);
        if let Some(rod) = self.plant.rod.as_mut().filter(|_| is_due) {
            rod.release();
        }
    }
}
