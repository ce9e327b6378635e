//! The flight on disk: the firmware's own ULog, and the truth beside it.

use super::autopilot::Autopilot;
use super::beside::SimpleBeside;
use super::recorder_inputs::InputTopics;
use super::shadow::{Shadow, ShadowEstimators};
use super::tape::{Begin, Tape};
use crate::plant::Plant;
use nalgebra::UnitQuaternion;
use std::io::{self, Write};
use tautline_firmware::log::topics::{
    EstimatorPosition, TetherTruth, VehicleAngularVelocity, VehicleAttitude, VehicleLocalPosition,
    WindTruth,
};
use tautline_firmware::log::{FlightLog, MEDIUM, Topic, TopicMeta};
use tautline_firmware::param::Params;
use tautline_firmware::time::Micros;
use tautline_firmware::vehicle::StepInput;

/// Shadow estimators are written every so many steps.
const SHADOW_PERIOD: u64 = 20;

const ATTITUDE: &str = "vehicle_attitude_groundtruth";
const RATE: &str = "vehicle_angular_velocity_groundtruth";
const POSITION: &str = "vehicle_local_position_groundtruth";
const TETHER: &str = "tether_state_groundtruth";
const WIND: &str = "wind_groundtruth";

/// The truth.
pub const TRUTH: &[TopicMeta] = &[
    TopicMeta::new::<VehicleAttitude>(ATTITUDE),
    TopicMeta::new::<VehicleAngularVelocity>(RATE),
    TopicMeta::new::<VehicleLocalPosition>(POSITION),
    TopicMeta::new::<TetherTruth>(TETHER),
    TopicMeta::new::<WindTruth>(WIND),
];

/// What a flight is flown again by.
#[derive(Clone, Debug)]
pub struct Origin {
    /// The scenario with every key, TOML.
    pub scenario: String,
    /// Of all that is random.
    pub seed: u64,
    /// How the firmware starts, if its inputs are to be recorded.
    pub begin: Option<Begin>,
}

/// Writes a log; the first write error ends it and is returned by [`Self::finish`].
#[derive(Debug)]
pub struct Recorder<W: Write> {
    log: FlightLog,
    attitude: Topic,
    rate: Topic,
    position: Topic,
    tether: Topic,
    wind: Topic,
    inputs: InputTopics,
    tape: Option<Tape>,
    now: u64,
    shadows: Vec<(Shadow, Topic)>,
    estimators: ShadowEstimators,
    simple: Option<SimpleBeside>,
    out: W,
    steps: u64,
    error: Option<io::Error>,
    is_told: bool,
}

fn put<W: Write>(out: &mut W, error: &mut Option<io::Error>, bytes: &[u8]) {
    if error.is_none()
        && let Err(e) = out.write_all(bytes)
    {
        *error = Some(e);
    }
}

impl<W: Write> Recorder<W> {
    /// Header, definitions, parameters.
    pub fn start(
        mut out: W,
        now: Micros,
        origin: &Origin,
        params: &Params,
        shadows: &[Shadow],
    ) -> Self {
        let mut error = None;
        let mut sink = |bytes: &[u8]| put(&mut out, &mut error, bytes);
        let mut log = FlightLog::start(
            now,
            params,
            |ulog, sink| {
                ulog.info("ver_hw", "SITL", sink);
                ulog.info("ver_sw_git", env!("TAUTLINE_REVISION"), sink);
                ulog.info_number("sitl_seed", origin.seed, sink);
                ulog.long_info("sitl_scenario", &origin.scenario, sink);
                for topic in TRUTH {
                    ulog.define_fields(topic.name, topic.fields, sink);
                }
                InputTopics::define(ulog, sink);
                if origin.begin.is_some() {
                    Tape::define(ulog, sink);
                }
                for shadow in shadows {
                    ulog.define::<EstimatorPosition>(shadow.topic(), sink);
                }
            },
            &mut sink,
        );
        let attitude = log.ulog.subscribe(ATTITUDE, &mut sink);
        let rate = log.ulog.subscribe(RATE, &mut sink);
        let position = log.ulog.subscribe(POSITION, &mut sink);
        let tether = log.ulog.subscribe(TETHER, &mut sink);
        let wind = log.ulog.subscribe(WIND, &mut sink);
        let inputs = InputTopics::subscribe(&mut log.ulog, params, &mut sink);
        let tape = origin.begin.clone().map(|begin| {
            let mut tape = Tape::subscribe(&mut log.ulog, &mut sink);
            tape.begin(begin);
            tape
        });
        let wants_simple = shadows.contains(&Shadow::Simple);
        let simple = origin.begin.as_ref().filter(|_| wants_simple).and_then(SimpleBeside::new);
        let subscribe = |&shadow: &Shadow| (shadow, log.ulog.subscribe(shadow.topic(), &mut sink));
        let shadows = shadows.iter().map(subscribe).collect();
        let estimators = ShadowEstimators::new(params);
        Self {
            log,
            attitude,
            rate,
            position,
            tether,
            wind,
            inputs,
            tape,
            now: now.0,
            shadows,
            estimators,
            simple,
            out,
            steps: 0,
            error,
            is_told: false,
        }
    }

    /// One step, what went into it, and the truth at its end, where somebody knows it.
    pub fn write(&mut self, input: &StepInput, flown: &Autopilot, truth: Option<&Plant>) {
        let out = flown.output();
        let (file, error) = (&mut self.out, &mut self.error);
        let mut sink = |bytes: &[u8]| put(file, error, bytes);
        let truth = truth.filter(|_| self.log.is_due(MEDIUM));
        self.inputs.write(&mut self.log, input, out, &mut sink);
        self.log.write(out, &mut sink);
        self.now = out.now.0;
        if let Some(tape) = &mut self.tape {
            tape.step(input, out, &mut self.log.ulog, &mut sink);
        }
        if let Some(plant) = truth {
            let at = out.now.0;
            self.log.ulog.write(self.attitude, &true_attitude(at, plant), &mut sink);
            self.log.ulog.write(self.rate, &true_rate(at, plant), &mut sink);
            self.log.ulog.write(self.position, &true_position(at, plant), &mut sink);
            self.log.ulog.write(self.tether, &true_tether(at, plant), &mut sink);
            self.log.ulog.write(self.wind, &true_wind(at, plant), &mut sink);
        }
        if !self.shadows.is_empty() {
            self.estimators
                .step(out, |shadow| self.shadows.iter().any(|(asked, _)| *asked == shadow));
            if let Some(simple) = &mut self.simple {
                simple.step(input, flown);
            }
            if self.steps.is_multiple_of(SHADOW_PERIOD) {
                for (shadow, topic) in &self.shadows {
                    let record = match (shadow, &self.simple) {
                        (Shadow::Simple, Some(simple)) => simple.record(),
                        _ => self.estimators.record(*shadow, out.now.0),
                    };
                    if let Some(record) = record {
                        self.log.ulog.write(*topic, &record, &mut sink);
                    }
                }
            }
        }
        self.steps += 1;
    }

    /// The firmware starts anew.
    pub fn restart(&mut self, begin: Begin) {
        if self.simple.is_some() {
            self.simple = SimpleBeside::new(&begin);
        }
        if let Some(tape) = &mut self.tape {
            tape.begin(begin);
        }
    }

    /// What ended the log early, told once.
    pub fn trouble(&mut self) -> Option<String> {
        let error = self.error.as_ref().filter(|_| !self.is_told)?;
        self.is_told = true;
        Some(error.to_string())
    }

    /// Flushes.
    ///
    /// # Errors
    /// The first error of any write.
    pub fn finish(mut self) -> io::Result<W> {
        let (file, error) = (&mut self.out, &mut self.error);
        if let Some(tape) = &mut self.tape {
            let mut sink = |bytes: &[u8]| put(file, error, bytes);
            tape.finish(self.now, &mut self.log.ulog, &mut sink);
        }
        if let Some(error) = self.error.take() {
            return Err(error);
        }
        self.out.flush()?;
        Ok(self.out)
    }
}

/// `[w, x, y, z]`.
#[must_use]
pub fn quaternion(q: &UnitQuaternion<f64>) -> [f64; 4] {
    let sign = if q.w < 0.0 { -1.0 } else { 1.0 };
    [q.w * sign, q.i * sign, q.j * sign, q.k * sign]
}

fn true_attitude(timestamp: u64, plant: &Plant) -> VehicleAttitude {
    VehicleAttitude { timestamp, q: quaternion(&plant.body.attitude).map(|x| x as f32) }
}

fn true_rate(timestamp: u64, plant: &Plant) -> VehicleAngularVelocity {
    VehicleAngularVelocity { timestamp, xyz: plant.body.rate.map(|x| x as f32).into() }
}

fn true_position(timestamp: u64, plant: &Plant) -> VehicleLocalPosition {
    let (p, v) = (&plant.from_anchor(), &plant.body.velocity);
    let (_, _, heading) = plant.body.attitude.euler_angles();
    VehicleLocalPosition {
        timestamp,
        x: p.x as f32,
        y: p.y as f32,
        z: p.z as f32,
        vx: v.x as f32,
        vy: v.y as f32,
        vz: v.z as f32,
        heading: heading as f32,
        eph: 0.0,
        epv: 0.0,
        dist_bottom: -p.z as f32,
        xy_valid: true,
        z_valid: true,
        v_xy_valid: true,
        v_z_valid: true,
        dist_bottom_valid: true,
    }
}

fn true_wind(timestamp: u64, plant: &Plant) -> WindTruth {
    let [north, east, down] = plant.wind.velocity.map(|x| x as f32).into();
    WindTruth { timestamp, windspeed_north: north, windspeed_east: east, windspeed_down: down }
}

fn true_tether(timestamp: u64, plant: &Plant) -> TetherTruth {
    let (p, tether) = (&plant.from_anchor(), &plant.tether);
    let pull = tether.pull().map(|x| x as f32);
    TetherTruth {
        timestamp,
        elevation: (-p.z).atan2(p.x.hypot(p.y)) as f32,
        azimuth: p.y.atan2(p.x) as f32,
        length: p.norm() as f32,
        tension: tether.tension() as f32,
        taut: tether.tension() > 0.0,
        tension_station: tether.station_tension() as f32,
        pull_x: pull.x,
        pull_y: pull.y,
        pull_z: pull.z,
        line: tether.length() as f32,
        twist: tether.twist as f32,
    }
}
