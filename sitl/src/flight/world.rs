//! One millisecond at a time: plant → sensors → drivers → the firmware's step → ESCs.

use super::injection::Injection;
use super::uplink::Uplink;
use super::{Autopilot, Environment};
use crate::scenario::{Scenario, ScenarioError, Source};
use tautline_firmware::mavlink::Connection;
use tautline_firmware::param::Params;
use tautline_firmware::signal::MAX_ROTORS;
use tautline_firmware::time::Micros;
use tautline_firmware::vehicle::{StepInput, StepOutput};
use tautline_hal_shim::fake::FakeEsc;
use tautline_hal_shim::motors::MotorOutputs;
use tautline_runtime::inner_loop::protocol;

/// Everything: the physical world, the vehicle's devices and its firmware.
#[derive(Debug)]
pub struct World {
    /// All but the firmware.
    pub environment: Environment,
    motors: MotorOutputs<FakeEsc, MAX_ROTORS>,
    /// The firmware.
    pub vehicle: Autopilot,
    /// Its MAVLink connection.
    pub connection: Connection,
    injection: Injection,
    uplink: Uplink,
    /// Somebody listens to the vehicle's telemetry.
    pub is_heard: bool,
}

impl World {
    /// Powers everything up. `params` come from the scenario, the command line or a file.
    ///
    /// # Errors
    /// What a driver's set-up reports.
    pub fn new(scenario: &Scenario, params: Params, seed: u64) -> Result<Self, ScenarioError> {
        let mut environment = Environment::new(scenario, &params, seed);
        environment.sensors.set_up().map_err(ScenarioError)?;
        let protocol = protocol(&params);
        let escs = std::array::from_fn(|_| FakeEsc::new(environment.clock().clone(), protocol));
        let motors = match MotorOutputs::try_new(escs, protocol) {
            Ok(motors) => motors,
            Err(never) => match never {},
        };
        let vehicle = Autopilot::new(scenario.scalar, params, environment.sensors.scale());
        environment.begin();
        Ok(Self {
            environment,
            motors,
            vehicle,
            connection: Connection::new(),
            injection: Injection::new(params.system_id as u8),
            uplink: Uplink::new(seed),
            is_heard: true,
        })
    }

    /// µs since power-up.
    #[must_use]
    pub fn now(&self) -> Micros {
        self.environment.now()
    }

    /// Seconds since the first step.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.environment.time()
    }

    /// Hands the link a datagram of the ground station, unless the link is cut. One that injects a failure is for the
    /// simulator.
    pub fn receive(&mut self, datagram: &[u8], send: &mut dyn FnMut(&[u8])) {
        let time = self.environment.now().0 as f64 * 1e-6;
        let faults = &mut self.environment.faults;
        if self.injection.take(datagram, time, faults, send) {
            return;
        }
        if self.uplink.passes(faults, time, datagram) {
            self.hand_on(datagram, send);
        }
    }

    fn hand_on(&mut self, datagram: &[u8], send: &mut dyn FnMut(&[u8])) {
        let (now, params, connection) =
            (self.environment.now(), self.vehicle.params(), &mut self.connection);
        self.environment.deliver(Source::Ground, datagram, &mut |datagram| {
            connection.receive_datagram(now, datagram, params, send);
        });
    }

    /// One millisecond.
    pub fn step(&mut self, send: &mut dyn FnMut(&[u8])) -> &StepOutput {
        let time = self.environment.now().0 as f64 * 1e-6;
        while let Some(datagram) = self.uplink.arrived(time) {
            self.hand_on(&datagram, send);
        }
        let winch = f64::from(self.vehicle.winch_tension());
        self.environment.advance(self.motors.channels_mut(), winch);
        let (now, params) = (self.environment.now(), self.vehicle.params());
        let connection = &mut self.connection;
        self.environment
            .publish_capture(&mut |frame| connection.receive_datagram(now, frame, params, send));
        let mut sensors = self.connection.take_sensors();
        // The simulated winch has its own wire: nobody else tells the vehicle its length.
        sensors.tether = None;
        sensors.line.station_tension = None;
        sensors.merge(self.environment.read());
        let input = StepInput {
            now,
            sensors,
            heartbeat_at: self.connection.heartbeat_at(),
            sticks: self.connection.sticks(),
            request: self.connection.next_request(),
        };
        let out = self.vehicle.step(&input);
        self.environment.release_rod(out.mode);
        match self.motors.write(&out.actuation.throttle) {
            Ok(()) => {}
            Err(never) => match never {},
        }
        self.vehicle.maintain();
        let out = self.vehicle.output();
        if self.is_heard {
            self.connection.transmit(out, self.vehicle.params(), send);
        }
        out
    }
}
