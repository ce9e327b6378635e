//! Motion capture: cameras that see the vehicle and the rod on it, and a computer that tells them by
//! MAVLink: ODOMETRY, and DEBUG_VECT named `rod`. Late, noisy, and now and then not at all.

use super::mavlink_sender::MavlinkSender;
use super::recorder::quaternion;
use crate::plant::{Generator, Plant, RodPhase, V3, generator, normal, uniform};
use crate::scenario::{CaptureSection, FaultKind, Faults};
use mavlink::dialects::common::{DEBUG_VECT_DATA, MavFrame, ODOMETRY_DATA};
use mavlink::types::CharArray;
use nalgebra::UnitQuaternion;
use std::collections::VecDeque;

/// Ids of the computer: a component for visual odometry.
const SYSTEM: u32 = 200;
const COMPONENT: u8 = 197;

/// The cameras and what is on its way.
#[derive(Debug)]
pub struct MotionCapture {
    model: CaptureSection,
    rng: Generator,
    sender: MavlinkSender,
    /// When it arrives, µs, and its bytes.
    way: VecDeque<(u64, Vec<u8>)>,
    next_us: u64,
}

impl MotionCapture {
    /// Nothing seen yet.
    #[must_use]
    pub fn new(model: CaptureSection, seed: u64) -> Self {
        Self {
            model,
            rng: generator(seed, 5),
            sender: MavlinkSender::new(SYSTEM, COMPONENT),
            way: VecDeque::new(),
            next_us: 0,
        }
    }

    /// Looks at the world; what arrives now goes to `deliver`.
    pub fn step(
        &mut self,
        now_us: u64,
        plant: &Plant,
        faults: &Faults,
        deliver: &mut dyn FnMut(&[u8]),
    ) {
        let time = now_us as f64 * 1e-6;
        let is_blind = faults.is_present(FaultKind::CaptureLost, time);
        if now_us >= self.next_us {
            self.next_us = now_us + (1e6 / self.model.rate).round() as u64;
            let is_dropped = 0.5 * (uniform(&mut self.rng) + 1.0) < self.model.dropped;
            let frames = self.look(now_us, plant, !faults.is_present(FaultKind::RodUnseen, time));
            let jitter = self.model.jitter * uniform(&mut self.rng).abs();
            let due = now_us + ((self.model.delay + jitter) * 1e6) as u64;
            if !is_blind && !is_dropped {
                self.way.extend(frames.into_iter().map(|frame| (due, frame)));
            }
        }
        // In order: a datagram that overtakes another would be older than what is known.
        while self.way.front().is_some_and(|(due, _)| *due <= now_us) {
            if let Some((_, frame)) = self.way.pop_front() {
                deliver(&frame);
            }
        }
    }

    fn shaken(&mut self, v: V3, by: f64) -> [f32; 3] {
        v.map(|x| (x + by * normal(&mut self.rng)) as f32).into()
    }

    fn look(&mut self, now_us: u64, plant: &Plant, sees_rod: bool) -> Vec<Vec<u8>> {
        let body = &plant.body;
        let [x, y, z] = self.shaken(body.position, self.model.position_noise);
        let turn = V3::from_fn(|_, _| self.model.attitude_noise * normal(&mut self.rng));
        let seen = body.attitude * UnitQuaternion::from_scaled_axis(turn);
        let pose = ODOMETRY_DATA {
            time_usec: now_us,
            x,
            y,
            z,
            q: quaternion(&seen).map(|x| x as f32),
            vx: f32::NAN,
            vy: f32::NAN,
            vz: f32::NAN,
            frame_id: MavFrame::MAV_FRAME_LOCAL_NED,
            child_frame_id: MavFrame::MAV_FRAME_BODY_FRD,
            ..ODOMETRY_DATA::default()
        };
        let mut frames = vec![self.sender.frame(&pose)];
        let rod = plant.rod.as_ref().filter(|rod| sees_rod && rod.phase != RodPhase::Fallen);
        if let Some(direction) = rod.map(|rod| rod.direction) {
            let [x, y, z] = self.shaken(direction, self.model.rod_noise);
            let name = CharArray::from("rod");
            let vector = DEBUG_VECT_DATA { time_usec: now_us, x, y, z, name };
            frames.push(self.sender.frame(&vector));
        }
        frames
    }
}
