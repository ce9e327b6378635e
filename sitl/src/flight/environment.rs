//! Everything but the firmware: the physical world, the vehicle's devices, and whoever stands beside it.

use super::capture::MotionCapture;
use crate::plant::{Disturbance, DisturbanceKind, Plant, Push, generator};
use crate::scenario::{FaultKind, Faults, Scenario};
use crate::sensor::SensorSuite;
use std::f64::consts::PI;
use tautline_firmware::param::Params;
use tautline_firmware::sense::Mounting;
use tautline_firmware::supervisor::Mode;
use tautline_firmware::time::Micros;
use tautline_hal_shim::fake::{FakeClock, FakeEsc};
use tautline_hal_shim::motors::MOTORS;

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
    capture: Option<MotionCapture>,
    mounting: Mounting,
    /// Until a hand lets go of the rod after the change of mode, s; and when that was.
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
        let mut plant = Plant::new(scenario.plant_with_wind(wind_from), distance, heading, seed);
        if scenario.push.kind != DisturbanceKind::None {
            plant.push = Some(Push::new(Disturbance::new(scenario.push.kind, seed)));
        }
        let sees = scenario.capture.rate > 0.0;
        Self {
            plant,
            sensors: SensorSuite::new(&scenario.sensors, clock.clone(), seed),
            faults: Faults::new(&scenario.fault),
            capture: sees.then(|| MotionCapture::new(scenario.capture.clone(), seed)),
            mounting: Mounting::from_parameter(params.board_rotation),
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

    /// Whether a fault is present now.
    #[must_use]
    pub fn suffers(&self, kind: FaultKind) -> bool {
        self.faults.is_present(kind, self.clock.now_us() as f64 * 1e-6)
    }

    /// One millisecond of physics, with what the motors and the winch are told.
    pub fn advance(&mut self, escs: &[FakeEsc; MOTORS], winch: f64) {
        let throttle = std::array::from_fn(|i| escs.get(i).map_or(0.0, FakeEsc::throttle));
        self.plant.model_mut().tether.is_broken = self.suffers(FaultKind::TetherBroken);
        let time = self.clock.now_us() as f64 * 1e-6;
        if let Some(charge) = self.faults.value(FaultKind::BatteryAt, time) {
            self.plant.battery.charge = self.plant.battery.charge.min(charge.clamp(0.0, 1.0));
        }
        self.plant.step(&throttle, winch);
        self.clock.advance_to(self.clock.now_us() + STEP_US);
    }

    /// What the motion capture says, frame by frame.
    pub fn look(&mut self, tell: &mut dyn FnMut(&[u8])) {
        if let Some(capture) = &mut self.capture {
            capture.step(self.clock.now_us(), &self.plant, &self.faults, tell);
        }
    }

    /// The devices see this millisecond, for a reader environment.
    pub fn expose(&mut self) {
        self.sensors.expose(&self.plant, &self.faults, self.mounting);
    }

    /// The drivers read it.
    pub fn read(&mut self) -> tautline_firmware::sense::RawSensors {
        self.sensors.read(&self.plant, &self.faults, self.mounting)
    }

    /// Whoever holds the rod lets go when the vehicle balances it.
    pub fn let_go(&mut self, mode: Mode) {
        if mode != Mode::Pendulum {
            self.balancing_since = None;
            return;
        }
        let now = self.time();
        let since = *self.balancing_since.get_or_insert(now);
        let lets_go = (since + self.reaction..since + self.reaction + 1.5e-3).contains(&now);
        if let Some(rod) = self.plant.rod.as_mut().filter(|_| lets_go) {
            rod.release();
        }
    }
}
