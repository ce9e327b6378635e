//! Motion capture: cameras that track the vehicle and its rod, and a computer that publishes the poses by
//! MAVLink: ODOMETRY, and DEBUG_VECT named `rod`. Late, noisy, and now and then not at all. A flow sensor's and a satellite
//! receiver's computers publish what they know in the same way.

use super::mavlink_sender::MavlinkSender;
use super::recorder::quaternion;
use crate::plant::{Generator, Plant, RodPhase, V3, generator, normal, uniform};
use crate::scenario::{CaptureSection, FaultKind, Faults, Gnss, Scenario};
use mavlink::dialects::common::{DEBUG_VECT_DATA, MavFrame, ODOMETRY_DATA};
use mavlink::types::CharArray;
use nalgebra::UnitQuaternion;
use std::collections::VecDeque;

/// Ids of the computers: components for visual odometry.
const COMPONENT: u8 = 197;
const FLOW: u8 = 198;
const RECEIVER: u8 = 199;
/// A plain receiver's place wanders by so much, m, within so long, s, beside its noise; upwards by half as much again.
const WANDER: (f64, f64) = (1.2, 60.0);
const UPWARDS: f64 = 1.5;

/// What a receiver's place is off, and does not average out soon.
#[derive(Clone, Copy, Debug)]
struct Wander {
    sd: f64,
    keep: f64,
    now: V3,
}

impl Wander {
    fn new((sd, time): (f64, f64), rate: f64) -> Self {
        Self { sd, keep: (-1.0 / (rate * time)).exp(), now: V3::zeros() }
    }

    fn step(&mut self, rng: &mut Generator) -> V3 {
        let kick = self.sd * (1.0 - self.keep * self.keep).sqrt();
        let noise = V3::new(normal(rng), normal(rng), UPWARDS * normal(rng));
        self.now = self.now * self.keep + noise * kick;
        self.now
    }
}

/// The cameras and what is in transit.
#[derive(Debug)]
pub struct MotionCapture {
    model: CaptureSection,
    knows_attitude: bool,
    wander: Option<Wander>,
    rng: Generator,
    sender: MavlinkSender,
    /// When it arrives, µs, and its bytes.
    in_transit: VecDeque<(u64, Vec<u8>)>,
    next_us: u64,
}

impl MotionCapture {
    /// All that the scenario has, as companions of the vehicle `system`; nothing measured yet.
    #[must_use]
    pub fn all(scenario: &Scenario, system: u8, seed: u64) -> Vec<Self> {
        let mut all = Vec::new();
        if scenario.capture.rate > 0.0 {
            all.push(Self::new(scenario.capture.clone(), (system, COMPONENT), generator(seed, 5)));
        }
        if scenario.sensors.flow {
            let flow = Self::new(CaptureSection::flow(), (system, FLOW), generator(seed, 12));
            all.push(Self { knows_attitude: false, ..flow });
        }
        if let Some(model) = scenario.sensors.gnss.receiver() {
            let wander =
                (scenario.sensors.gnss == Gnss::Plain).then(|| Wander::new(WANDER, model.rate));
            let receiver = Self::new(model, (system, RECEIVER), generator(seed, 13));
            all.push(Self { knows_attitude: false, wander, ..receiver });
        }
        all
    }

    fn new(model: CaptureSection, (system, component): (u8, u8), rng: Generator) -> Self {
        Self {
            model,
            knows_attitude: true,
            wander: None,
            rng,
            sender: MavlinkSender::new(u32::from(system), component),
            in_transit: VecDeque::new(),
            next_us: 0,
        }
    }

    /// Samples the world; `deliver` is called with every frame that arrives now.
    pub fn step(
        &mut self,
        now_us: u64,
        plant: &Plant,
        faults: &Faults,
        deliver: &mut dyn FnMut(&[u8]),
    ) {
        let time = now_us as f64 * 1e-6;
        let is_lost = faults.is_active(FaultKind::CaptureLost, time);
        if now_us >= self.next_us {
            self.next_us = now_us + (1e6 / self.model.rate).round() as u64;
            let is_dropped = 0.5 * (uniform(&mut self.rng) + 1.0) < self.model.dropped;
            let frames = self.frames(now_us, plant, !faults.is_active(FaultKind::RodUnseen, time));
            let jitter = self.model.jitter * uniform(&mut self.rng).abs();
            let due = now_us + ((self.model.delay + jitter) * 1e6) as u64;
            if !is_lost && !is_dropped {
                self.in_transit.extend(frames.into_iter().map(|frame| (due, frame)));
            }
        }
        // In order: a datagram that overtakes another would be older than what is known.
        while self.in_transit.front().is_some_and(|(due, _)| *due <= now_us) {
            if let Some((_, frame)) = self.in_transit.pop_front() {
                deliver(&frame);
            }
        }
    }

    fn with_noise(&mut self, v: V3, by: f64) -> [f32; 3] {
        v.map(|x| (x + by * normal(&mut self.rng)) as f32).into()
    }

    fn frames(&mut self, now_us: u64, plant: &Plant, is_rod_visible: bool) -> Vec<Vec<u8>> {
        let body = &plant.body;
        let off = self.wander.as_mut().map_or(V3::zeros(), |wander| wander.step(&mut self.rng));
        let place = self.with_noise(body.position + off, self.model.position_noise);
        let [x, y, z] = if self.model.position { place } else { [f32::NAN; 3] };
        let own = body.attitude.inverse() * body.velocity * (1.0 + self.model.velocity_scale);
        let noise = self.model.velocity_noise;
        let [vx, vy, vz] = if noise > 0.0 { self.with_noise(own, noise) } else { [f32::NAN; 3] };
        let turn = V3::from_fn(|_, _| self.model.attitude_noise * normal(&mut self.rng));
        let attitude = body.attitude * UnitQuaternion::from_scaled_axis(turn);
        let pose = ODOMETRY_DATA {
            time_usec: now_us,
            x,
            y,
            z,
            q: if self.knows_attitude {
                quaternion(&attitude).map(|x| x as f32)
            } else {
                [f32::NAN; 4]
            },
            vx,
            vy,
            vz,
            frame_id: MavFrame::MAV_FRAME_LOCAL_NED,
            child_frame_id: MavFrame::MAV_FRAME_BODY_FRD,
            ..ODOMETRY_DATA::default()
        };
        let mut frames = vec![self.sender.frame(&pose)];
        let rod = plant.rod.as_ref().filter(|rod| is_rod_visible && rod.phase != RodPhase::Fallen);
        if let Some(direction) = rod.map(|rod| rod.direction) {
            let [x, y, z] = self.with_noise(direction, self.model.rod_noise);
            let name = CharArray::from("rod");
            let vector = DEBUG_VECT_DATA { time_usec: now_us, x, y, z, name };
            frames.push(self.sender.frame(&vector));
        }
        frames
    }
}
