//! A whole flight of a scenario, as fast as the machine can: for campaigns, tests and `--headless`.

mod autopilot;
mod beside;
mod breakage;
mod capture;
mod environment;
mod fingerprint;
mod hand;
mod mavlink_sender;
mod mission;
mod physics;
mod readings;
mod recorder;
mod recorder_inputs;
mod shadow;
pub mod tape;
#[cfg(feature = "cli")]
mod topics;
mod verdict;
mod world;

pub use autopilot::Autopilot;
pub use environment::Environment;
pub use hand::Hand;
pub use mavlink_sender::MavlinkSender;
pub use mission::{MissionRunner, Progress};
pub use physics::{Address, Physics};
pub use readings::{Gathered, Readings};
pub use recorder::{Origin, Recorder, quaternion};
pub use shadow::{Shadow, ShadowEstimators};
#[cfg(feature = "cli")]
pub use topics::topics_page;
pub use verdict::FlightVerdict;
pub use world::World;

use crate::metrics::Metrics;
use crate::scenario::{Scenario, ScenarioError};
use hand::HandState;
use std::io::{self, Sink, Write};
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
    /// Its log, if anybody wants one.
    recorder: Option<Recorder<W>>,
    /// Against the truth.
    pub metrics: Metrics,
    /// Events reported to the operator, with their times, s.
    pub events: Vec<(f64, Event)>,
    ended_at: Option<f64>,
    hand: Option<HandState>,
}

impl Flight<Sink> {
    /// Ready for the first step, without log and telemetry: for those who want the figures.
    ///
    /// # Errors
    /// From the scenario or a driver's set-up.
    pub fn unrecorded(
        scenario: &Scenario,
        params: Params,
        seed: u64,
    ) -> Result<Self, ScenarioError> {
        let mut flight = Self::start(scenario, params, seed)?;
        flight.world.is_heard = false;
        Ok(flight)
    }
}

impl<W: Write> Flight<W> {
    /// Ready for the first step, with a log of the vehicle's own topics and the truth.
    ///
    /// # Errors
    /// From the scenario or a driver's set-up.
    pub fn new(
        scenario: &Scenario,
        params: Params,
        seed: u64,
        log: W,
    ) -> Result<Self, ScenarioError> {
        Self::beside(scenario, params, seed, log, &[])
    }

    /// The same with shadow estimators in the log.
    ///
    /// # Errors
    /// From the scenario or a driver's set-up.
    pub fn beside(
        scenario: &Scenario,
        params: Params,
        seed: u64,
        log: W,
        shadows: &[Shadow],
    ) -> Result<Self, ScenarioError> {
        let mut flight = Self::start(scenario, params, seed)?;
        flight.world.is_watched = true;
        let origin = Origin {
            scenario: toml::to_string(scenario).map_err(|e| ScenarioError(e.to_string()))?,
            seed,
            begin: Some(flight.world.begin()),
        };
        let now = flight.world.now();
        flight.recorder = Some(Recorder::start(log, now, &origin, &params, shadows));
        Ok(flight)
    }

    /// The same without a log.
    ///
    /// # Errors
    /// From the scenario or a driver's set-up.
    pub fn start(scenario: &Scenario, params: Params, seed: u64) -> Result<Self, ScenarioError> {
        Ok(Self {
            world: World::new(scenario, params, seed)?,
            mission: MissionRunner::new(&scenario.mission, params.system_id as u8),
            recorder: None,
            metrics: Metrics::default(),
            events: Vec::new(),
            ended_at: None,
            hand: None,
        })
    }

    /// One millisecond. `send` is called with the vehicle's MAVLink frames.
    pub fn step(&mut self, send: &mut dyn FnMut(&[u8])) -> &StepOutput {
        let out = self.world.step(send);
        let status = Status::of(out);
        let time = self.world.time();
        let world = &mut self.world;
        self.mission.step(&status, time, &mut |frame| world.receive(frame, send));
        self.world.environment.faults.reach_step(self.mission.step_number());
        self.mission.act_by_hand(&mut self.world.environment.plant);
        let (out, plant) = (self.world.vehicle.output(), &self.world.environment.plant);
        let has_truth = self.world.environment.has_truth();
        if has_truth {
            // Whoever flies by hand is judged by what was asked of the firmware before.
            let judged = self.hand.map(|hand| StepOutput { reference: hand.reference, ..*out });
            let judged = judged.as_ref().unwrap_or(out);
            self.metrics.step(judged, plant, self.mission.is_holding());
        }
        if let Some(recorder) = &mut self.recorder {
            recorder.write(&self.world.input, &self.world.vehicle, has_truth.then_some(plant));
            if self.world.has_restarted() {
                recorder.restart(self.world.begin());
            }
        }
        self.events.extend(out.events.iter().map(|event| (time, *event)));
        out
    }

    /// What the last step said.
    #[must_use]
    pub fn output(&self) -> &StepOutput {
        self.world.vehicle.output()
    }

    /// What ended the log early, a full disk say; told once.
    pub fn log_trouble(&mut self) -> Option<String> {
        self.recorder.as_mut()?.trouble()
    }

    /// Ends the log; `None` if there is none.
    ///
    /// # Errors
    /// The first error of any write.
    pub fn finish_log(&mut self) -> io::Result<Option<W>> {
        self.recorder.take().map(Recorder::finish).transpose()
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
