//! One millisecond at a time: plant → sensors → drivers → the firmware's step → ESCs.

use super::tape::Begin;
use super::{Autopilot, Environment};
use crate::ground::{Host, Injection, Links, Uplink};
use crate::scenario::{Arithmetic, Scenario, ScenarioError, Source};
use tautline_firmware::mavlink::{Connection, is_to_reboot};
use tautline_firmware::param::Params;
use tautline_firmware::signal::{MAX_ROTORS, PerRotor, Sticks};
use tautline_firmware::time::{Micros, Sample};
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
    scalar: Arithmetic,
    /// Its MAVLink connection with the simulator's own operator.
    pub connection: Connection,
    /// Those with everybody outside.
    pub links: Links,
    injection: Injection,
    uplink: Uplink,
    /// Somebody listens to the vehicle's telemetry.
    pub is_heard: bool,
    /// Somebody reads [`Self::input`].
    pub is_watched: bool,
    /// Instead of what the firmware wants, while the motors may turn: throttle of each rotor, 0..1.
    pub throttle: Option<PerRotor<f32>>,
    /// What went into the last step, while somebody reads it.
    pub input: StepInput,
    has_restarted: bool,
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
            scalar: scenario.scalar,
            connection: own_connection(),
            links: Links::new(),
            injection: Injection::new(params.system_id as u8),
            uplink: Uplink::new(seed),
            is_heard: true,
            is_watched: false,
            throttle: None,
            input: StepInput::default(),
            has_restarted: false,
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

    /// Hands the vehicle a datagram of the simulator's own operator, unless the link is cut.
    pub fn receive(&mut self, datagram: &[u8], send: &mut dyn FnMut(&[u8])) {
        if self.passes(OWN, datagram) {
            self.hear_own(datagram, send);
        }
    }

    /// Whether a datagram arrives at once.
    fn passes(&mut self, link: u8, datagram: &[u8]) -> bool {
        let time = self.environment.now().0 as f64 * 1e-6;
        self.uplink.passes(&self.environment.faults, time, link, datagram)
    }

    /// The simulator's own operator holds every key.
    fn hear_own(&mut self, datagram: &[u8], send: &mut dyn FnMut(&[u8])) {
        let (now, params) = (self.environment.now(), self.vehicle.params());
        let connection = &mut self.connection;
        self.environment.deliver(Source::Ground, datagram, &mut |datagram| {
            connection.receive_datagram(now, datagram, params, send);
        });
        self.reach_simulator(datagram, None, send);
    }

    /// A datagram of somebody outside; what is not for the firmware is for the simulator.
    fn hear_peer(&mut self, link: u8, datagram: &[u8]) {
        let faults = self.environment.active_faults();
        let (files, now) = (self.links.files.clone(), self.environment.now());
        let (params, out) = (self.vehicle.params(), self.vehicle.output());
        let host = Host { files: &files, params, out, faults: &faults };
        let mut signing = self.links.signing.take();
        let mut is_admitted = false;
        // Whoever is gone since it was sent has nobody to answer.
        if let Some(peer) = self.links.peer(link) {
            self.environment.deliver(Source::Ground, datagram, &mut |datagram| {
                is_admitted = peer.receive((now, datagram), params, &mut signing);
                if is_admitted {
                    peer.serve(datagram, &host);
                }
            });
        }
        self.links.signing = signing;
        if is_admitted {
            let mut answers = Vec::new();
            let commander = self.vehicle.output().commander;
            self.reach_simulator(datagram, commander, &mut |frame| answers.push(frame.to_vec()));
            if let Some(peer) = self.links.peer(link) {
                answers.iter().for_each(|frame| peer.write(frame));
            }
        }
    }

    /// Failures to inject, and the winch.
    fn reach_simulator(
        &mut self,
        datagram: &[u8],
        commander: Option<u8>,
        send: &mut dyn FnMut(&[u8]),
    ) {
        let time = self.environment.now().0 as f64 * 1e-6;
        let Environment { winch, plant, faults, .. } = &mut self.environment;
        self.injection.take(datagram, time, faults, commander, send);
        winch.take(datagram, plant, commander, send);
    }

    /// What everybody outside has sent.
    fn hear(&mut self, send: &mut dyn FnMut(&[u8])) {
        let time = self.environment.now().0 as f64 * 1e-6;
        while let Some((link, datagram)) = self.uplink.arrived(time) {
            if link == OWN {
                self.hear_own(&datagram, send);
            } else {
                self.hear_peer(link, &datagram);
            }
        }
        let waiting: Vec<_> = self
            .links
            .iter_mut()
            .filter_map(|peer| peer.read().map(|datagram| (peer.link, datagram)))
            .collect();
        for (link, datagram) in waiting {
            if self.passes(link, &datagram) {
                self.hear_peer(link, &datagram);
            }
        }
    }

    /// What all connections have for the next step. A request a step: each in its turn.
    fn collect(&mut self) -> StepInput {
        let mut sensors = self.connection.take_sensors();
        let mut heartbeat_at = self.connection.heartbeat_at();
        let mut sticks = self.connection.sticks();
        let mut request = self.connection.next_request();
        for peer in self.links.iter_mut() {
            let connection = &mut peer.connection;
            sensors.merge(connection.take_sensors());
            heartbeat_at = heartbeat_at.max(connection.heartbeat_at());
            let is_newer = |s: &Sample<Sticks>| sticks.is_none_or(|last| last.at < s.at);
            if let Some(newer) = connection.sticks().filter(is_newer) {
                sticks = Some(newer);
            }
            request = request.or_else(|| connection.next_request());
        }
        self.links.take_turns();
        StepInput { now: self.environment.now(), sensors, heartbeat_at, sticks, request }
    }

    /// How the firmware starts now, or has started in the last step.
    #[must_use]
    pub fn begin(&self) -> Begin {
        Begin::new(self.scalar, self.environment.sensors.scale(), self.vehicle.params())
    }

    /// Whether it did so at the end of the last step.
    #[must_use]
    pub fn has_restarted(&self) -> bool {
        self.has_restarted
    }

    /// The firmware starts anew with the parameters that it has, at rest.
    fn reboot(&mut self) {
        let params = *self.vehicle.params();
        self.vehicle = Autopilot::new(self.scalar, params, self.environment.sensors.scale());
        self.connection = own_connection();
        self.links.renew();
    }

    /// One millisecond.
    pub fn step(&mut self, send: &mut dyn FnMut(&[u8])) -> &StepOutput {
        self.hear(send);
        let winch = f64::from(self.vehicle.winch_tension());
        self.environment.advance(self.motors.channels_mut(), winch);
        let (now, params) = (self.environment.now(), self.vehicle.params());
        let connection = &mut self.connection;
        self.environment
            .publish_capture(&mut |frame| connection.receive_datagram(now, frame, params, send));
        let mut input = self.collect();
        // The simulated winch has its own wire: nobody else tells the vehicle its length.
        input.sensors.tether = None;
        input.sensors.line.station_tension = None;
        input.sensors.merge(self.environment.read());
        let out = self.vehicle.step(&input);
        if self.is_watched {
            self.input = input;
        }
        self.environment.release_rod(out.mode);
        if let Some(pilot) = &mut self.environment.sensors.pilot {
            pilot.tell(out);
        }
        let throttle = self.throttle.as_ref().filter(|_| out.is_armed);
        match self.motors.write(throttle.unwrap_or(&out.actuation.throttle)) {
            Ok(()) => {}
            Err(never) => match never {},
        }
        self.vehicle.maintain();
        let (out, params) = (self.vehicle.output(), self.vehicle.params());
        if self.is_heard {
            self.connection.transmit(out, params, send);
        }
        if self.links.count() > 0 {
            self.speak();
        }
        self.has_restarted = is_to_reboot(self.vehicle.output());
        if self.has_restarted {
            self.reboot();
        }
        self.vehicle.output()
    }

    /// What vehicle, winch and services have for everybody outside.
    fn speak(&mut self) {
        let (out, params) = (self.vehicle.output(), self.vehicle.params());
        let (files, now_us) = (self.links.files.clone(), self.environment.now().0);
        let host = Host { files: &files, params, out, faults: &[] };
        let Environment { winch, plant, .. } = &mut self.environment;
        winch.tell(now_us, plant, &mut |frame| {
            self.links.iter_mut().for_each(|peer| peer.write(frame));
        });
        let mut signing = self.links.signing.take();
        for peer in self.links.iter_mut() {
            peer.transmit(out, params, &mut signing);
            peer.transfer(&host);
        }
        self.links.signing = signing;
    }
}

/// The simulator's own operator and companions: link 0.
const OWN: u8 = 0;

fn own_connection() -> Connection {
    let mut connection = Connection::of_link(OWN);
    connection.leave_services(0);
    connection
}
