//! One millisecond at a time: plant → sensors → drivers → the firmware's step → ESCs.

use crate::inject::Faults;
use crate::pendulum::{Disturbance, DisturbanceKind};
use crate::plant::{Plant, Push, generator};
use crate::scenario::{FaultKind, Scenario, ScenarioError};
use crate::sensor::{MotionCapture, SensorSuite};
use std::f64::consts::PI;
use tautline_firmware::link::Link;
use tautline_firmware::param::Params;
use tautline_firmware::sense::{Mounting, RawSensors};
use tautline_firmware::supervisor::Mode;
use tautline_firmware::time::Micros;
use tautline_firmware::vehicle::{StepInput, StepOutput, Vehicle};
use tautline_hal_shim::fake::{FakeClock, FakeEsc};
use tautline_hal_shim::motors::{MotorOutputs, Protocol};

/// Simulation step, µs.
pub const STEP_US: u64 = 1_000;

/// Everything: the physical world, the vehicle's devices and its firmware.
#[derive(Debug)]
pub struct World {
    clock: FakeClock,
    /// Physical truth.
    pub plant: Plant,
    sensors: SensorSuite,
    capture: Option<MotionCapture>,
    /// Until a hand lets go of the rod after the change of mode, s; and when that was.
    reaction: f64,
    balancing_since: Option<f64>,
    motors: MotorOutputs<FakeEsc>,
    /// The firmware.
    pub vehicle: Vehicle,
    /// Its MAVLink connection.
    pub link: Link,
    /// Faults.
    pub faults: Faults,
    started_us: u64,
}

impl World {
    /// Powers everything up. `params` come from the scenario, the command line or a file.
    ///
    /// # Errors
    /// What a driver's set-up says.
    pub fn new(scenario: &Scenario, params: Params, seed: u64) -> Result<Self, ScenarioError> {
        let clock = FakeClock::default();
        let mut rng = generator(seed, 3);
        let wind_from = crate::plant::uniform(&mut rng) * PI;
        let (distance, heading) = scenario.start();
        let sensors =
            SensorSuite::power_up(&scenario.sensors, clock.clone(), seed).map_err(ScenarioError)?;
        let protocol =
            if params.output_protocol > 0.5 { Protocol::OneShot125 } else { Protocol::Pwm400 };
        let escs = std::array::from_fn(|_| FakeEsc::new(clock.clone(), protocol));
        let motors = match MotorOutputs::try_new(escs, protocol) {
            Ok(motors) => motors,
            Err(never) => match never {},
        };
        let vehicle = Vehicle::new(params, sensors.scale());
        // The drivers' set-up took simulated time; steps count from the next whole millisecond.
        let started_us = clock.now_us().next_multiple_of(STEP_US);
        clock.advance_to(started_us);
        let mut plant = Plant::new(scenario.plant_with_wind(wind_from), distance, heading, seed);
        if scenario.push.kind != DisturbanceKind::None {
            plant.push = Some(Push::new(Disturbance::new(scenario.push.kind, seed)));
        }
        let sees = scenario.capture.rate > 0.0;
        Ok(Self {
            plant,
            capture: sees.then(|| MotionCapture::new(scenario.capture.clone(), seed)),
            reaction: scenario.rod.reaction,
            balancing_since: None,
            sensors,
            motors,
            vehicle,
            link: Link::new(),
            faults: Faults::new(&scenario.fault),
            clock,
            started_us,
        })
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

    /// Hands the link a datagram, unless the link is cut.
    pub fn receive(&mut self, datagram: &[u8], send: &mut dyn FnMut(&[u8])) {
        let now = self.now();
        if !self.faults.is_present(FaultKind::LinkLost, now.0 as f64 * 1e-6) {
            self.link.receive_datagram(now, datagram, self.vehicle.params(), send);
        }
    }

    /// One millisecond.
    pub fn step(&mut self, send: &mut dyn FnMut(&[u8])) -> StepOutput {
        let winch = self.vehicle.winch_tension();
        let throttle = std::array::from_fn(|i| {
            self.motors.channels_mut().get(i).map_or(0.0, FakeEsc::throttle)
        });
        self.break_things();
        self.plant.step(&throttle, f64::from(winch));
        self.clock.advance_to(self.clock.now_us() + STEP_US);

        self.look(send);
        let mounting = Mounting::from_parameter(self.vehicle.params().board_rotation);
        let sensors = RawSensors {
            capture: self.link.take_capture(),
            rod: self.link.take_rod(),
            ..self.sensors.read(&self.plant, &self.faults, mounting)
        };
        let input = StepInput {
            now: self.now(),
            sensors,
            heartbeat_at: self.link.heartbeat_at(),
            sticks: self.link.sticks(),
            request: self.link.next_request(),
        };
        let out = self.vehicle.step(&input);
        match self.motors.write(&out.actuation.throttle) {
            Ok(()) => {}
            Err(never) => match never {},
        }
        self.link.transmit(&out, self.vehicle.params(), send);
        self.let_go(out.mode);
        out
    }

    /// What the motion capture says arrives by the link.
    fn look(&mut self, send: &mut dyn FnMut(&[u8])) {
        let (now, params) = (self.now(), self.vehicle.params());
        if let Some(capture) = &mut self.capture {
            let link = &mut self.link;
            capture.step(now.0, &self.plant, &self.faults, &mut |frame| {
                link.receive_datagram(now, frame, params, send);
            });
        }
    }

    /// Whoever holds the rod lets go when the vehicle balances it.
    fn let_go(&mut self, mode: Mode) {
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

    fn break_things(&mut self) {
        let time = self.now().0 as f64 * 1e-6;
        self.plant.model_mut().tether.is_broken =
            self.faults.is_present(FaultKind::TetherBroken, time);
        if let Some(charge) = self.faults.value(FaultKind::BatteryAt, time) {
            self.plant.battery.charge = self.plant.battery.charge.min(charge.clamp(0.0, 1.0));
        }
    }
}
