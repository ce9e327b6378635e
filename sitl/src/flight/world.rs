//! One millisecond at a time: plant → sensors → drivers → the firmware's step → ESCs.

use super::{Autopilot, Environment};
use crate::ground::{Host, Injection, Links, Uplink};
use crate::scenario::{Arithmetic, Scenario, ScenarioError, Source};
use tautline_firmware::mavlink::Connection;
use tautline_firmware::param::Params;
use tautline_firmware::signal::{MAX_ROTORS, Outcome, Reply, Sticks};
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
        let answers = self.receive_by(OWN, datagram);
        answers.iter().for_each(|frame| send(frame));
    }

    /// By one link. A failure that it injects is for the simulator. What is answered at once.
    fn receive_by(&mut self, link: u8, datagram: &[u8]) -> Vec<Vec<u8>> {
        let mut answers = Vec::new();
        let time = self.environment.now().0 as f64 * 1e-6;
        let faults = &mut self.environment.faults;
        self.injection.take(datagram, time, faults, &mut |frame| answers.push(frame.to_vec()));
        let Environment { winch, plant, .. } = &mut self.environment;
        winch.take(datagram, plant, &mut |frame| answers.push(frame.to_vec()));
        let faults = &self.environment.faults;
        if self.uplink.passes(faults, time, link, datagram) {
            self.hand_on(link, datagram, &mut |frame| answers.push(frame.to_vec()));
        }
        answers
    }

    fn hand_on(&mut self, link: u8, datagram: &[u8], send: &mut dyn FnMut(&[u8])) {
        let (now, params) = (self.environment.now(), self.vehicle.params());
        let faults = self.environment.active_faults();
        let (files, out) = (self.links.files.clone(), self.vehicle.output());
        let host = Host { files: &files, params, out, faults: &faults };
        let mut peer = self.links.peer(link);
        let own = &mut self.connection;
        self.environment.deliver(Source::Ground, datagram, &mut |datagram| match &mut peer {
            Some(peer) => {
                peer.serve(datagram, &host);
                peer.connection.receive_datagram(now, datagram, params, send);
            }
            None if link == OWN => own.receive_datagram(now, datagram, params, send),
            // Gone since it was sent.
            None => {}
        });
    }

    /// What everybody outside has sent.
    fn hear(&mut self) {
        let waiting: Vec<_> = self
            .links
            .iter_mut()
            .filter_map(|peer| peer.read().map(|datagram| (peer.link, datagram)))
            .collect();
        for (link, datagram) in waiting {
            let answers = self.receive_by(link, &datagram);
            if let Some(peer) = self.links.peer(link) {
                answers.iter().for_each(|frame| peer.write(frame));
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

    /// The firmware starts anew with the parameters that it has, at rest.
    fn reboot(&mut self) {
        let params = *self.vehicle.params();
        self.vehicle = Autopilot::new(self.scalar, params, self.environment.sensors.scale());
        self.connection = own_connection();
        self.links.renew();
    }

    /// One millisecond.
    pub fn step(&mut self, send: &mut dyn FnMut(&[u8])) -> &StepOutput {
        let time = self.environment.now().0 as f64 * 1e-6;
        while let Some((link, datagram)) = self.uplink.arrived(time) {
            let mut answers = Vec::new();
            self.hand_on(link, &datagram, &mut |frame| answers.push(frame.to_vec()));
            match self.links.peer(link) {
                Some(peer) => answers.iter().for_each(|frame| peer.write(frame)),
                None => answers.iter().for_each(|frame| send(frame)),
            }
        }
        self.hear();
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
        self.environment.release_rod(out.mode);
        match self.motors.write(&out.actuation.throttle) {
            Ok(()) => {}
            Err(never) => match never {},
        }
        self.vehicle.maintain();
        let (out, params) = (self.vehicle.output(), self.vehicle.params());
        if self.is_heard {
            self.connection.transmit(out, params, send);
        }
        let files = self.links.files.clone();
        let host = Host { files: &files, params, out, faults: &[] };
        let Environment { winch, plant, .. } = &mut self.environment;
        if self.links.count() > 0 {
            winch.tell(now.0, plant, &mut |frame| {
                self.links.iter_mut().for_each(|peer| peer.write(frame));
            });
        }
        for peer in self.links.iter_mut() {
            peer.transmit(out, params);
            peer.transfer(&host);
        }
        if reboots(out) {
            self.reboot();
        }
        self.vehicle.output()
    }
}

/// The simulator's own operator and companions: link 0.
const OWN: u8 = 0;

fn own_connection() -> Connection {
    let mut connection = Connection::of_link(OWN);
    connection.leave_services(0);
    connection
}

/// The vehicle has agreed to start anew.
fn reboots(out: &StepOutput) -> bool {
    const REBOOT: u16 = 246;
    let is_accepted = |reply: &Reply| reply.outcome == Outcome::Accepted;
    out.reply.is_some_and(|reply| reply.ticket.command == REBOOT && is_accepted(&reply))
}
