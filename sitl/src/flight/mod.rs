//! A whole flight of a scenario, as fast as the machine can: for campaigns, tests and `--headless`.

mod autopilot;
mod capture;
mod environment;
mod mavlink_sender;
mod mission;
mod recorder;
mod shadow_estimators;
mod udp;
mod world;

pub use autopilot::Autopilot;
pub use environment::Environment;
pub use mavlink_sender::MavlinkSender;
pub use mission::{MissionRunner, Progress};
pub use recorder::Recorder;
pub use udp::Udp;
pub use world::World;

use crate::metrics::Metrics;
use crate::scenario::{Scenario, ScenarioError};
use std::io::Write;
use tautline_firmware::param::Params;
use tautline_firmware::signal::Event;
use tautline_firmware::vehicle::StepOutput;
use tautline_runtime::status::Status;

/// After the mission the world goes on for this long, so that the log shows it at rest, s.
const EPILOGUE: f64 = 2.0;

/// World, mission, log and measurements, advanced together.
#[derive(Debug)]
pub struct Flight<W: Write> {
    /// The world.
    pub world: World,
    /// Its mission.
    pub mission: MissionRunner,
    /// Its log.
    pub recorder: Recorder<W>,
    /// Against the truth.
    pub metrics: Metrics,
    /// Events reported to the operator, with their times, s.
    pub events: Vec<(f64, Event)>,
    ended_at: Option<f64>,
}

impl<W: Write> Flight<W> {
    /// Ready for the first step.
    ///
    /// # Errors
    /// From the scenario or a driver's set-up.
    pub fn new(
        scenario: &Scenario,
        params: Params,
        seed: u64,
        log: W,
    ) -> Result<Self, ScenarioError> {
        let world = World::new(scenario, params, seed)?;
        let recorder = Recorder::start(log, world.now(), &params);
        let mission = MissionRunner::new(&scenario.mission, params.system_id as u8);
        Ok(Self {
            world,
            mission,
            recorder,
            metrics: Metrics::default(),
            events: Vec::new(),
            ended_at: None,
        })
    }

    /// One millisecond. `send` is called with the vehicle's MAVLink frames.
    pub fn step(&mut self, send: &mut dyn FnMut(&[u8])) -> StepOutput {
        let out = self.world.step(send);
        let time = self.world.time();
        let world = &mut self.world;
        self.mission.step(&Status::of(&out), time, &mut |frame| world.receive(frame, send));
        self.mission.act_by_hand(&mut self.world.environment.plant);
        self.metrics.step(&out, &self.world.environment.plant, self.mission.is_holding());
        self.recorder.write(&out, &self.world.environment.plant);
        self.events.extend(out.events.iter().map(|event| (time, *event)));
        out
    }

    /// Flies the mission to its end, or for `limit` s.
    pub fn fly(&mut self, limit: f64) {
        while self.world.time() < limit && !self.is_over() {
            self.step(&mut |_| {});
        }
    }

    /// The mission has ended and its epilogue too.
    pub fn is_over(&mut self) -> bool {
        if *self.mission.progress() == Progress::Flying {
            return false;
        }
        let time = self.world.time();
        time > *self.ended_at.get_or_insert(time) + EPILOGUE
    }
}
