//! The winch as a component of its own, 169: it says how it is and does what it is asked by DO_WINCH.
//!
//! Left alone it holds the tension that the vehicle asks for. A length or a rate has it turn at a speed, lock and hold
//! have it stand; when the length is out, or the rate is zero, the vehicle's tension is held again.

use crate::flight::MavlinkSender;
use crate::plant::Plant;
use mavlink::MessageData;
use mavlink::dialects::common::{
    COMMAND_ACK_DATA, COMMAND_INT_DATA, COMMAND_LONG_DATA, HEARTBEAT_DATA, MavAutopilot, MavCmd,
    MavModeFlag, MavResult, MavState, MavType, MavWinchStatusFlag, WINCH_STATUS_DATA,
};
use tautline_firmware::mavlink::{Frame, Parser};

/// `MAV_COMP_ID_WINCH`.
const COMPONENT: u8 = 169;
const DO_WINCH: u16 = 42600;
const REQUEST_MESSAGE: u16 = 512;
/// `WINCH_ACTIONS`.
const RELAX: u8 = 0;
const LENGTH: u8 = 1;
const RATE: u8 = 2;
const LOCK: u8 = 3;
const HOLD: u8 = 5;
const RETRACT: u8 = 6;
/// A length whose speed nobody names is paid out so fast, m/s.
const SPEED: f64 = 0.5;
/// Line that a retraction leaves out, m.
const SHORTEST: f64 = 0.5;
/// Standard gravity by which MAVLink's tension in kg is meant, m/s².
const KG_TO_N: f64 = 9.806_65;
/// Its step, and the low-pass of its speed, s.
const TICK: f64 = 1e-3;
const SPEED_TAU: f64 = 0.1;
/// Below this it stands, m/s.
const STANDING: f64 = 0.02;
/// Of a frame, before its payload, bytes.
const HEAD: usize = 10;
const HEARTBEAT_US: u64 = 1_000_000;
const STATUS_US: u64 = 500_000;

/// What it does.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Doing {
    /// The vehicle's tension.
    Tension,
    /// None at all.
    Relaxed,
    /// Stands.
    Locked,
    /// Turns, out positive, m/s, until so much is out, m.
    Turning { speed: f64, until: Option<f64> },
}

/// The winch's computer.
#[derive(Debug)]
pub struct Winch {
    system: u8,
    parser: Parser,
    sender: MavlinkSender,
    doing: Doing,
    /// Out, m.
    length: f64,
    /// Out positive, m/s.
    speed: f64,
    heartbeat_us: u64,
    status_us: u64,
}

impl Winch {
    /// Of the vehicle `system`.
    #[must_use]
    pub fn new(system: u8) -> Self {
        Self {
            system,
            parser: Parser::new(),
            sender: MavlinkSender::new(u32::from(system), COMPONENT),
            doing: Doing::Tension,
            length: 0.0,
            speed: 0.0,
            heartbeat_us: 0,
            status_us: 0,
        }
    }

    /// Does what a datagram asks of it, if the commander asks it or nobody commands, and answers.
    pub fn take(
        &mut self,
        datagram: &[u8],
        plant: &Plant,
        commander: Option<u8>,
        send: &mut dyn FnMut(&[u8]),
    ) {
        let Some(model) = &plant.model().tether.winch else { return };
        let (most, longest) = (model.speed_max, model.length_max);
        let mut answers = Vec::new();
        let (system, length, doing) = (self.system, self.length, &mut self.doing);
        self.parser.push(datagram, |frame| {
            let is_command = matches!(frame.id, COMMAND_LONG_DATA::ID | COMMAND_INT_DATA::ID);
            let is_for_us = [0, system].contains(&frame.byte(30)) && frame.byte(31) == COMPONENT;
            if !(is_command && is_for_us) {
                return;
            }
            let is_strange = commander.is_some_and(|known| known != frame.system);
            let result = match frame.word(28) {
                DO_WINCH if is_strange => MavResult::MAV_RESULT_TEMPORARILY_REJECTED,
                DO_WINCH => match wanted(frame, length, most, longest) {
                    Ok(wanted) => {
                        *doing = wanted;
                        MavResult::MAV_RESULT_ACCEPTED
                    }
                    Err(result) => result,
                },
                REQUEST_MESSAGE if frame.float(0) as u32 == WINCH_STATUS_DATA::ID => {
                    MavResult::MAV_RESULT_ACCEPTED
                }
                _ => MavResult::MAV_RESULT_UNSUPPORTED,
            };
            answers.push((frame.word(28), result, frame.system, frame.component));
        });
        for (command, result, system, component) in answers {
            send(&self.acknowledge(command, result, (system, component)));
        }
    }

    /// The number is put in by bytes: the crate's enum of commands does not know every one.
    fn acknowledge(&mut self, command: u16, result: MavResult, to: (u8, u8)) -> Vec<u8> {
        let payload = |at: usize| HEAD + at;
        let filler = COMMAND_ACK_DATA { command: MavCmd::MAV_CMD_DO_WINCH, result };
        let mut frame = self.sender.frame(&filler);
        frame.resize(payload(10), 0);
        let [low, high] = command.to_le_bytes();
        let bytes = [(0, low), (1, high), (2, result as u8), (8, to.0), (9, to.1)];
        for (at, byte) in bytes.map(|(at, byte)| (payload(at), byte)) {
            if let Some(slot) = frame.get_mut(at) {
                *slot = byte;
            }
        }
        if let Some(length) = frame.get_mut(1) {
            *length = 10;
        }
        let covered = frame.get(1..).unwrap_or(&[]);
        let crc = mavlink::calculate_crc(covered, COMMAND_ACK_DATA::EXTRA_CRC);
        frame.extend(crc.to_le_bytes());
        frame
    }

    /// What it has the drum do this millisecond: the tension asked for, N, and a speed that is forced.
    pub fn drive(&mut self, plant: &mut Plant, tension: &mut f64) {
        let length = plant.tether.length();
        self.speed += ((length - self.length) / TICK - self.speed) * (TICK / SPEED_TAU);
        self.length = length;
        if let Doing::Turning { speed, until: Some(until) } = self.doing {
            let is_there = if speed > 0.0 { self.length >= until } else { self.length <= until };
            if is_there {
                self.doing = Doing::Tension;
            }
        }
        let turns = match self.doing {
            Doing::Tension => return,
            Doing::Relaxed => {
                *tension = 0.0;
                return;
            }
            Doing::Locked => 0.0,
            Doing::Turning { speed, .. } => speed,
        };
        if let Some(model) = &mut plant.model_mut().tether.winch {
            // A fault has the last word.
            model.turns = model.turns.or(Some(turns));
        }
    }

    /// After the drum has turned: what was forced is over.
    pub fn release(&self, plant: &mut Plant) {
        if !matches!(self.doing, Doing::Tension | Doing::Relaxed)
            && let Some(model) = &mut plant.model_mut().tether.winch
        {
            model.turns = None;
        }
    }

    /// Heartbeat and status that are due.
    pub fn tell(&mut self, now_us: u64, plant: &Plant, send: &mut dyn FnMut(&[u8])) {
        if plant.model().tether.winch.is_none() {
            return;
        }
        if now_us >= self.heartbeat_us {
            self.heartbeat_us = now_us + HEARTBEAT_US;
            send(&self.sender.frame(&HEARTBEAT_DATA {
                mavtype: MavType::MAV_TYPE_WINCH,
                autopilot: MavAutopilot::MAV_AUTOPILOT_INVALID,
                // The crate's default is an armed one.
                base_mode: MavModeFlag::empty(),
                system_status: MavState::MAV_STATE_ACTIVE,
                mavlink_version: 3,
                ..HEARTBEAT_DATA::default()
            }));
        }
        if now_us >= self.status_us {
            self.status_us = now_us + STATUS_US;
            let status = self.status(now_us, plant);
            send(&self.sender.frame(&status));
        }
    }

    fn status(&self, now_us: u64, plant: &Plant) -> WINCH_STATUS_DATA {
        use MavWinchStatusFlag as F;
        let (length, speed) = (self.length, self.speed);
        let mut status = F::MAV_WINCH_STATUS_HEALTHY;
        status.set(F::MAV_WINCH_STATUS_MOVING, speed.abs() > STANDING);
        status.set(F::MAV_WINCH_STATUS_FULLY_RETRACTED, length <= SHORTEST);
        status.set(F::MAV_WINCH_STATUS_LOCKED, self.doing == Doing::Locked);
        status.set(F::MAV_WINCH_STATUS_CLUTCH_ENGAGED, self.doing != Doing::Relaxed);
        WINCH_STATUS_DATA {
            time_usec: now_us,
            line_length: length as f32,
            speed: speed as f32,
            tension: (plant.tether.tension() / KG_TO_N) as f32,
            voltage: f32::NAN,
            current: f32::NAN,
            status,
            temperature: i16::MAX,
        }
    }
}

/// What a DO_WINCH asks for: 2 is the action, 3 a length to pay out, m, 4 a speed, m/s, out positive.
fn wanted(frame: &Frame, length: f64, most: f64, longest: f64) -> Result<Doing, MavResult> {
    let [action, by, rate] = [4, 8, 12].map(|at| f64::from(frame.float(at)));
    let speed = if rate.is_finite() { rate } else { 0.0 };
    let fast = if speed.abs() > 0.0 { speed.abs() } else { SPEED };
    if !(0.0..=255.0).contains(&action) || action.fract().abs() > 0.0 || fast > most {
        return Err(MavResult::MAV_RESULT_DENIED);
    }
    match action as u8 {
        RELAX => Ok(Doing::Relaxed),
        LENGTH => {
            let until = length + by;
            if !(SHORTEST..=longest).contains(&until) {
                return Err(MavResult::MAV_RESULT_DENIED);
            }
            Ok(Doing::Turning { speed: fast.copysign(by), until: Some(until) })
        }
        RATE if speed.abs() > 0.0 => Ok(Doing::Turning { speed, until: None }),
        RATE => Ok(Doing::Tension),
        LOCK | HOLD => Ok(Doing::Locked),
        RETRACT => Ok(Doing::Turning { speed: -fast, until: Some(SHORTEST) }),
        _ => Err(MavResult::MAV_RESULT_UNSUPPORTED),
    }
}
