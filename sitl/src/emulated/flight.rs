//! A scenario flown by an image under QEMU, in lockstep.

use super::devices::Devices;
use super::pipe::{Pipe, decode};
use super::qemu::{Qemu, Telemetry};
use crate::flight::{Environment, MavlinkSender, MissionRunner, Progress};
use crate::plant::V3;
use crate::scenario::{FaultKind, Scenario, Source};
use mavlink::dialects::common::{HEARTBEAT_DATA, MavType, STATUSTEXT_DATA, WINCH_STATUS_DATA};
use mavlink::{MavlinkVersion, MessageData};
use std::io::{self, Write};
use std::path::Path;
use std::time::{Duration, Instant};
use tautline_firmware::mavlink::{NewKey, Parser};
use tautline_firmware::param::Params;
use tautline_firmware::supervisor::{MODES, Mode};
use tautline_runtime::inner_loop::protocol;
use tautline_runtime::status::Status;
use tautline_runtime::wire::{Counts, Injury, Reply, Request};

/// After the mission the world goes on for this long, s.
const EPILOGUE: f64 = 2.0;
/// Bytes that go into the console port in a millisecond.
const CONSOLE: usize = 300;
/// System id of the winch.
const WINCH: u8 = 169;
/// Of the ground station.
const GROUND: u32 = 255;
const HEARTBEAT_MS: u64 = 500;

/// How to fly.
#[derive(Clone, Debug)]
pub struct Plan<'a> {
    /// The image.
    pub image: &'a Path,
    /// For FIFOs and the log.
    pub folder: &'a Path,
    /// What is simulated, with its mission.
    pub scenario: &'a Scenario,
    /// In the board's flash at power-up.
    pub params: Params,
    /// There too.
    pub key: Option<NewKey>,
    /// Of everything random.
    pub seed: u64,
    /// Simulated seconds at most.
    pub limit: f64,
    /// What to inject, and when, s.
    pub injury: Option<(f64, Injury)>,
    /// Where USART1 goes; a real client wants real time.
    pub telemetry: Telemetry,
}

/// What came of it.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Mission's end.
    pub progress: Progress,
    /// True position at the end, NED from the anchor, m.
    pub position: V3,
    /// Greatest height, m.
    pub top: f64,
    /// Simulated s, from the first step.
    pub time: f64,
    /// Root mean square of the position estimate's error in the air, m.
    pub estimate_rms: Option<f64>,
    /// Instructions, stack, lost outputs.
    pub counts: Counts,
    /// STATUSTEXT messages on the console port, with times, s.
    pub texts: Vec<(f64, String)>,
    /// From the injury to the first stop pulses, s.
    pub stopped_after: Option<f64>,
    /// Over every byte between board and host.
    pub digest: u64,
    /// The board's flight log.
    pub log: Vec<u8>,
    /// Wall time, s.
    pub took: f64,
    /// Parameters in the flash at the end.
    pub stored: Params,
}

struct Host<'a> {
    plan: &'a Plan<'a>,
    devices: Devices,
    mission: MissionRunner,
    winch: MavlinkSender,
    ground: MavlinkSender,
    parser: Parser,
    console: Vec<u8>,
    status: Status,
    steps: u64,
    has_begun: bool,
    injured_at: Option<f64>,
    ended_at: Option<f64>,
    squares: (f64, u64),
    began: Instant,
    out: Outcome,
}

/// Flies the plan.
///
/// # Errors
/// When QEMU, its image or a file fails; a mission that fails is an [`Outcome`].
pub fn fly(plan: &Plan) -> io::Result<Outcome> {
    let is_real_time = plan.telemetry != Telemetry::None;
    let (qemu, mut pipe) = Qemu::start(plan.image, plan.folder, plan.telemetry, !is_real_time)?;
    let mut host = Host::new(plan)?;
    loop {
        let message = pipe.receive()?;
        let request = decode(&message)?;
        if host.devices.serve(&request, &mut pipe)? {
            if matches!(request, Request::Motors(_)) {
                host.watch_motors();
            }
            continue;
        }
        match request {
            Request::Console(bytes) => host.receive_console(bytes),
            Request::Log(bytes) => host.out.log.extend_from_slice(bytes),
            Request::Status(status) => host.update(&status),
            Request::Counts(counts) => host.out.counts = counts,
            Request::Advance if host.is_over() => {
                pipe.reply(&Reply::End)?;
                break;
            }
            Request::Advance => {
                if is_real_time {
                    host.wait();
                }
                host.advance(&mut pipe)?;
            }
            _ => {}
        }
    }
    // The last counts.
    while let Ok(message) = pipe.receive() {
        if let Request::Counts(counts) = decode(&message)? {
            host.out.counts = counts;
        }
    }
    let digest = pipe.digest();
    drop(pipe);
    let folder = qemu.folder().to_owned();
    qemu.finish()?;
    let outcome = host.finish(digest)?;
    std::fs::File::create(folder.join("flight.ulg"))?.write_all(&outcome.log)?;
    Ok(outcome)
}

impl<'a> Host<'a> {
    fn new(plan: &'a Plan<'a>) -> io::Result<Self> {
        let environment = Environment::new(plan.scenario, &plan.params, plan.seed);
        let devices =
            Devices::new(environment, &plan.params, plan.key.as_ref(), protocol(&plan.params))?;
        let mission = MissionRunner::new(&plan.scenario.mission, plan.params.system_id as u8);
        let out = Outcome {
            progress: mission.progress().clone(),
            position: V3::zeros(),
            top: 0.0,
            time: 0.0,
            estimate_rms: None,
            counts: Counts::default(),
            texts: Vec::new(),
            stopped_after: None,
            digest: 0,
            log: Vec::new(),
            took: 0.0,
            stored: plan.params,
        };
        Ok(Self {
            plan,
            devices,
            mission,
            winch: MavlinkSender::new(plan.params.system_id as u32, WINCH),
            ground: MavlinkSender::new(GROUND, 1),
            parser: Parser::new(),
            console: Vec::new(),
            status: Status::default(),
            steps: 0,
            has_begun: false,
            injured_at: None,
            ended_at: None,
            squares: (0.0, 0),
            began: Instant::now(),
            out,
        })
    }

    fn time(&self) -> f64 {
        self.devices.environment.time()
    }

    fn is_over(&mut self) -> bool {
        if !self.has_begun {
            return false;
        }
        let time = self.time();
        if time >= self.plan.limit {
            return true;
        }
        // Without a mission somebody at the telemetry port flies, for as long as they like.
        let is_flown_by_others = self.plan.scenario.mission.is_empty();
        if is_flown_by_others || *self.mission.progress() == Progress::Flying {
            return false;
        }
        time > *self.ended_at.get_or_insert(time) + EPILOGUE
    }

    /// Until the wall clock has caught up.
    fn wait(&self) {
        let due = Duration::from_secs_f64(self.steps as f64 * 1e-3);
        if let Some(ahead) = due.checked_sub(self.began.elapsed()) {
            std::thread::sleep(ahead);
        }
    }

    /// One millisecond of world, with what the companions send in it.
    fn step_world(&mut self) {
        if !self.has_begun {
            self.has_begun = true;
            self.devices.environment.begin();
        }
        self.steps += 1;
        let Devices { environment, escs, .. } = &mut self.devices;
        environment.advance(escs, f64::from(self.status.winch_tension));
        environment.expose();
        let console = &mut self.console;
        environment.publish_capture(&mut |frame| console.extend_from_slice(frame));
        if let Some(length) = environment.sensors.winch() {
            let status = WINCH_STATUS_DATA {
                line_length: length.length_mm as f32 * 1e-3,
                ..WINCH_STATUS_DATA::default()
            };
            let frame = self.winch.frame(&status);
            environment.deliver(Source::Companion, &frame, &mut |frame| {
                console.extend_from_slice(frame);
            });
        }
    }

    /// One millisecond of world, then the board's turn.
    fn advance(&mut self, pipe: &mut Pipe) -> io::Result<()> {
        self.step_world();
        let environment = &self.devices.environment;
        let is_ready = !environment.is_active(FaultKind::ImuSilent);
        let time = environment.time();
        let due = self.plan.injury.filter(|(at, _)| self.injured_at.is_none() && time >= *at);
        if due.is_some() {
            self.injured_at = Some(time);
        }
        let take = self.console.len().min(CONSOLE);
        let console: Vec<u8> = self.console.drain(..take).collect();
        pipe.reply(&Reply::Tick {
            now_us: self.devices.environment.now().0,
            is_ready,
            console: &console,
            injury: due.map(|(_, injury)| injury),
        })
    }

    /// After new pulses.
    fn watch_motors(&mut self) {
        let Some(at) = self.injured_at.filter(|_| self.out.stopped_after.is_none()) else { return };
        let protocol = protocol(&self.plan.params);
        let stop = protocol.pulse_us(0.0) / protocol.period_us() * f32::from(u16::MAX);
        if self.devices.pulses.iter().all(|pulse| f32::from(*pulse) < stop + 1.0) {
            self.out.stopped_after = Some(self.time() - at);
        }
    }

    /// A ground station keeps its link when its mission has failed or ended.
    fn keep_link(&mut self) {
        if *self.mission.progress() != Progress::Flying && self.steps.is_multiple_of(HEARTBEAT_MS) {
            let heartbeat =
                HEARTBEAT_DATA { mavtype: MavType::MAV_TYPE_GCS, ..HEARTBEAT_DATA::default() };
            let (frame, console) = (self.ground.frame(&heartbeat), &mut self.console);
            self.devices.environment.deliver(Source::Ground, &frame, &mut |frame| {
                console.extend_from_slice(frame);
            });
        }
    }

    /// Takes the status of the board's step: mission, figures, hands.
    fn update(&mut self, status: &Status) {
        self.status = *status;
        self.keep_link();
        let time = self.time();
        let plant = &self.devices.environment.plant;
        self.out.top = self.out.top.max(plant.body.height());
        if let Some(estimate) = status.position.filter(|_| status.is_in_air) {
            let off = V3::from(estimate.map(f64::from)) - plant.from_anchor();
            self.squares = (self.squares.0 + off.norm_squared(), self.squares.1 + 1);
        }
        let console = &mut self.console;
        let environment = &mut self.devices.environment;
        self.mission.step(status, time, &mut |frame| {
            environment.deliver(Source::Ground, frame, &mut |frame| {
                console.extend_from_slice(frame);
            });
        });
        self.mission.act_by_hand(&mut environment.plant);
        let mode = MODES.iter().find(|rule| rule.custom_mode == status.custom_mode);
        environment.release_rod(mode.map_or(Mode::TetherHold, |rule| rule.mode));
    }

    fn receive_console(&mut self, bytes: &[u8]) {
        let time = self.devices.environment.time();
        let texts = &mut self.out.texts;
        self.parser.push(bytes, |frame| {
            if frame.id == STATUSTEXT_DATA::ID
                && let Ok(text) = STATUSTEXT_DATA::deser(MavlinkVersion::V2, frame.payload)
                && let Ok(text) = text.text.to_str()
            {
                texts.push((time, text.to_owned()));
            }
        });
    }

    fn finish(mut self, digest: u64) -> io::Result<Outcome> {
        self.out.stored = self.devices.stored()?;
        self.out.progress = self.mission.progress().clone();
        self.out.position = self.devices.environment.plant.from_anchor();
        self.out.time = self.time();
        self.out.took = self.began.elapsed().as_secs_f64();
        self.out.digest = digest;
        let (sum, count) = self.squares;
        self.out.estimate_rms = (count > 0).then(|| (sum / count as f64).sqrt());
        Ok(self.out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flight::Flight;

    /// For so long, ms.
    const TIME: u64 = 1500;

    /// Whether the ground station and the motion capture get through to an emulated board.
    fn reach_the_board(scenario: &Scenario) -> [bool; 2] {
        let plan = Plan {
            image: Path::new(""),
            folder: Path::new(""),
            scenario,
            params: scenario.params().unwrap(),
            key: None,
            seed: 1,
            limit: 60.0,
            injury: None,
            telemetry: Telemetry::None,
        };
        let mut host = Host::new(&plan).unwrap();
        for _ in 0..TIME {
            host.step_world();
            host.update(&Status::default());
        }
        let mut parser = Parser::new();
        let mut senders = Vec::new();
        parser.push(&host.console, |frame| senders.push((frame.system, frame.component)));
        assert!(senders.contains(&(1, WINCH)), "{senders:?}");
        let has_ground = senders.iter().any(|(system, _)| u32::from(*system) == GROUND);
        [has_ground, senders.contains(&(1, 197))]
    }

    /// Whether they get through to the firmware in the simulator.
    fn reach_the_simulator(scenario: &Scenario) -> [bool; 2] {
        let params = scenario.params().unwrap();
        let mut flight = Flight::unrecorded(scenario, params, 1).unwrap();
        let mut is_captured = false;
        for _ in 0..TIME {
            is_captured |= flight.step(&mut |_| {}).sensors.capture.is_some();
        }
        [flight.world.connection.heartbeat_at().is_some(), is_captured]
    }

    #[test]
    fn a_fault_cuts_the_same_here_and_in_the_simulator() {
        let scenario = |fault: &str| {
            let text = format!("[capture]\nrate = 50.0\n{fault}[[mission]]\ndo = \"arm\"");
            Scenario::parse(&text, "s.toml").unwrap()
        };
        for (fault, reached) in [
            ("", [true, true]),
            ("[[fault]]\nkind = \"link_lost\"\nat = 0.0\n", [false, true]),
            ("[[fault]]\nkind = \"capture_lost\"\nat = 0.0\n", [true, false]),
        ] {
            let scenario = scenario(fault);
            assert_eq!(reach_the_board(&scenario), reached, "board, {fault}");
            assert_eq!(reach_the_simulator(&scenario), reached, "simulator, {fault}");
        }
    }
}
