//! Simulator and firmware in a browser. Messages are those of the page's WebSocket: `tautline_sitl::view`.

use std::io::Sink;
use tautline_firmware::mavlink::Parser;
use tautline_sitl::flight::Flight;
use tautline_sitl::scenario::Scenario;
use tautline_sitl::view::{Ask, Asked, Message, Panel, Pilot, Snapshot, answers};
use wasm_bindgen::prelude::wasm_bindgen;

/// Simulated, between two heartbeats of whoever sits at the page, ms.
const HEARTBEAT_MS: u32 = 500;

/// A flight, its world and its firmware.
#[wasm_bindgen]
pub struct Simulation {
    scenario: Scenario,
    flight: Flight<Sink>,
    pilot: Pilot,
    parser: Parser,
    since_heartbeat_ms: u32,
    notes: Vec<String>,
}

#[wasm_bindgen]
impl Simulation {
    /// Powers everything up: a scenario file's text, empty for the default vehicle on its winch.
    ///
    /// # Errors
    /// One line that names what is wrong with the scenario.
    #[wasm_bindgen(constructor)]
    pub fn new(scenario_toml: &str, seed: u32) -> Result<Simulation, String> {
        let scenario = Scenario::parse(scenario_toml, "scenario").map_err(|e| e.0)?;
        let params = scenario.params().map_err(|e| e.0)?;
        let mut flight = Flight::unrecorded(&scenario, params, u64::from(seed)).map_err(|e| e.0)?;
        // Its answers are listened to.
        flight.world.is_heard = true;
        let pilot = Pilot::new(0, params.system_id as u8);
        Ok(Self {
            scenario,
            flight,
            pilot,
            parser: Parser::new(),
            since_heartbeat_ms: HEARTBEAT_MS,
            notes: Vec::new(),
        })
    }

    /// So many simulated milliseconds, at most ten minutes a call.
    pub fn step(&mut self, ms: u32) {
        for _ in 0..ms.min(600_000) {
            if self.since_heartbeat_ms >= HEARTBEAT_MS {
                self.since_heartbeat_ms = 0;
                let heartbeat = self.pilot.heartbeat();
                self.flight.world.receive(&heartbeat, &mut |_| {});
            }
            self.since_heartbeat_ms += 1;
            let notes = &mut self.notes;
            let parser = &mut self.parser;
            self.flight.step(&mut |frame| answers(parser, frame, |text| notes.push(text)));
        }
    }

    /// What the page needs to know once: a message of type `panel`.
    #[must_use]
    pub fn panel(&self) -> String {
        let panel = Panel::of(&self.scenario, &self.flight.world, self.pilot.system());
        Message::Panel(panel).json()
    }

    /// This instant: a message of type `snapshot`.
    #[must_use]
    pub fn snapshot(&self) -> String {
        Message::Snapshot(Box::new(Snapshot::of(&self.flight))).json()
    }

    /// Asks for something, by a message with a field `do`; what there is to say to it comes by [`Self::note`].
    pub fn send(&mut self, command_json: &str) {
        let world = &mut self.flight.world;
        let commander = world.vehicle.output().commander;
        match Ask::parse(command_json) {
            Ok(ask) => match ask.act(&mut self.pilot, &mut world.environment, commander) {
                Asked::Frame(frame) => world.receive(&frame, &mut |_| {}),
                Asked::Note(text) => self.notes.push(text),
            },
            Err(why) => self.notes.push(why),
        }
    }

    /// The oldest line that nobody has read: a message of type `note`.
    pub fn note(&mut self) -> Option<String> {
        if self.notes.is_empty() {
            return None;
        }
        Some(Message::note(self.notes.remove(0)).json())
    }

    /// Simulated, since the first step, s.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.flight.world.time()
    }
}
