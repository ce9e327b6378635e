//! The built-in mission runner: flies a scenario's mission by MAVLink, as a ground station would.

use super::MavlinkSender;
use crate::plant::{Plant, V3, Walk};
use crate::scenario::{Step, TautControl};
use mavlink::MessageData;
use mavlink::dialects::common::{MANUAL_CONTROL_DATA, MavCmd, MavParamType, PARAM_SET_DATA};
use mavlink::types::CharArray;
use tautline_firmware::param::{Kind, Meta};
use tautline_firmware::supervisor::Mode;
use tautline_runtime::status::Status;

/// Ground station's ids.
const SYSTEM: u32 = 255;
const COMPONENT: u8 = 190;
/// A step of the mission that takes longer has failed, s; and so much longer for each metre that it goes up or down.
const TIMEOUT: f64 = 120.0;
const TIMEOUT_PER_METRE: f64 = 3.0;
const HEARTBEAT_PERIOD: f64 = 0.5;
/// A vehicle that cannot be armed by then is asked once, for its reason, s, and later given up, s.
const ASK_UNARMABLE: f64 = 10.0;
const GIVE_UP: f64 = 62.0;
/// A command is sent again after this time, s.
const REPEAT: f64 = 1.0;
/// Of the joystick, s.
const STICKS_PERIOD: f64 = 0.05;
/// Further below the height of an excitation it only climbs, m.
const CLIMB_FIRST: f64 = 1.5;

/// How the mission stands.
#[derive(Clone, Debug, PartialEq)]
pub enum Progress {
    /// Under way.
    Flying,
    /// All steps done.
    Done,
    /// A step failed.
    Failed(String),
}

/// The mode that a step asks for and waits for.
fn mode_of(step: &Step) -> Option<Mode> {
    match step {
        Step::Taut { control: TautControl::Force } => Some(Mode::TautForce),
        Step::Taut { control: TautControl::Attitude } => Some(Mode::TautAttitude),
        Step::TetherHold => Some(Mode::TetherHold),
        Step::TetherAngle => Some(Mode::TetherAngle),
        Step::Pendulum => Some(Mode::Pendulum),
        Step::Altitude => Some(Mode::Altitude),
        _ => None,
    }
}

/// The taut-link reference, if it rests.
fn taut_rest(status: &Status) -> Option<(f64, f64)> {
    let point = status.taut.filter(|point| point.rests)?;
    Some((f64::from(point.elevation), f64::from(point.second)))
}

fn is_at(x: f64, target: f64) -> bool {
    (x - target).abs() < 1e-3
}

/// What a step takes off to, m.
fn height_of(step: &Step) -> f64 {
    match step {
        Step::Takeoff { altitude } => *altitude,
        _ => 0.0,
    }
}

/// Sticks that shake all four motors: square waves of different periods on climb rate, roll and pitch,
/// about the height.
fn excitation(status: &Status, altitude: f64, time: f64) -> [f64; 3] {
    let square = |period: f64| if (time / period).rem_euclid(1.0) < 0.5 { 1.0 } else { -1.0 };
    let low = altitude - f64::from(status.height);
    if low > CLIMB_FIRST {
        return [0.0, 0.0, 0.8];
    }
    let climb = 0.2 * square(1.1) + 0.2 * square(2.7);
    let back = (0.3 * low).clamp(-0.3, 0.3);
    [0.12 * square(1.7), 0.12 * square(2.3), 0.5 + climb + back]
}

/// State of the mission.
#[derive(Debug)]
pub struct MissionRunner {
    steps: Vec<Step>,
    at: usize,
    step_began: f64,
    commanded_at: Option<f64>,
    heartbeat_at: f64,
    sender: MavlinkSender,
    target: u8,
    progress: Progress,
    /// Roll, pitch and throttle, once the mission has the sticks.
    sticks: Option<[f64; 3]>,
    sticks_at: f64,
    walk: Option<Walk>,
    catches: bool,
    /// Highest take-off, m.
    highest: f64,
    /// The vehicle was armed in this step.
    has_armed: bool,
    /// The operator goes on to be heard when nothing is left to do.
    stays: bool,
}

impl MissionRunner {
    /// For a mission; `system` is the vehicle's MAVLink id.
    #[must_use]
    pub fn new(steps: &[Step], system: u8) -> Self {
        Self {
            highest: steps.iter().map(height_of).fold(0.0, f64::max),
            stays: false,
            steps: steps.to_vec(),
            at: 0,
            step_began: 0.0,
            commanded_at: None,
            heartbeat_at: f64::NEG_INFINITY,
            sender: MavlinkSender::new(SYSTEM, COMPONENT),
            target: system,
            progress: if steps.is_empty() { Progress::Done } else { Progress::Flying },
            sticks: None,
            sticks_at: f64::NEG_INFINITY,
            walk: None,
            catches: false,
            has_armed: false,
        }
    }

    /// The operator stays when everything is done: further steps may be asked for, and until then the link lives.
    pub fn stay(&mut self) {
        self.stays = true;
    }

    /// One more step, after those that are still to be flown; a failure before it is forgotten.
    pub fn ask(&mut self, step: Step, time: f64) {
        if self.progress != Progress::Flying {
            self.progress = Progress::Flying;
            self.at = self.steps.len();
            self.step_began = time;
            self.commanded_at = None;
        }
        self.highest = self.highest.max(height_of(&step));
        self.steps.push(step);
    }

    /// Nothing more of what was asked is flown.
    pub fn drop_rest(&mut self) {
        self.steps.truncate(self.at);
        self.progress = Progress::Done;
    }

    /// Sets a parameter, as a ground station does.
    pub fn set_parameter(&mut self, meta: &Meta, value: f32, send: &mut dyn FnMut(&[u8])) {
        let is_whole = meta.kind == Kind::Int;
        let message = PARAM_SET_DATA {
            // Whole numbers travel in the float's bytes.
            param_value: if is_whole { f32::from_bits(value as i32 as u32) } else { value },
            target_system: self.target,
            target_component: 1,
            param_id: CharArray::from(meta.name),
            param_type: if is_whole {
                MavParamType::MAV_PARAM_TYPE_INT32
            } else {
                MavParamType::MAV_PARAM_TYPE_REAL32
            },
        };
        send(&self.sender.frame(&message));
    }

    /// The mission's ground station asks for a mode.
    pub(super) fn set_mode(&mut self, mode: Mode) -> Vec<u8> {
        self.sender.set_mode(self.target, mode)
    }

    /// The vehicle's MAVLink id.
    pub(super) fn target(&self) -> u8 {
        self.target
    }

    /// A message from the mission's ground station.
    pub(super) fn frame<D: MessageData>(&mut self, message: &D) -> Vec<u8> {
        self.sender.frame(message)
    }

    /// The step under way, from 1.
    #[must_use]
    pub fn step_number(&self) -> usize {
        self.at + 1
    }

    /// How the mission stands.
    #[must_use]
    pub fn progress(&self) -> &Progress {
        &self.progress
    }

    /// What people beside the vehicle do in the steps that began now: walk with the anchor, catch the rod.
    pub fn act_by_hand(&mut self, plant: &mut Plant) {
        if let Some(walk) = self.walk.take() {
            plant.anchor.go(walk);
        }
        let catches = std::mem::take(&mut self.catches);
        if let Some(rod) = plant.rod.as_mut().filter(|_| catches) {
            rod.catch();
        }
    }

    /// Whether a hold is being flown: the time to measure.
    #[must_use]
    pub fn is_holding(&self) -> bool {
        matches!(self.steps.get(self.at), Some(Step::Hold { .. }))
            && self.progress == Progress::Flying
    }

    /// Takes the vehicle's last status and sends what the step needs.
    pub fn step(&mut self, status: &Status, time: f64, send: &mut dyn FnMut(&[u8])) {
        if self.progress != Progress::Flying && !self.stays {
            return;
        }
        let by_radio = matches!(self.steps.get(self.at), Some(Step::Radio { .. }));
        if time >= self.heartbeat_at + HEARTBEAT_PERIOD && !by_radio {
            self.heartbeat_at = time;
            send(&self.sender.ground_heartbeat());
        }
        if self.progress != Progress::Flying {
            return;
        }
        let Some(step) = self.steps.get(self.at).cloned() else {
            self.progress = Progress::Done;
            return;
        };
        let waited = time - self.step_began;
        self.has_armed |= status.is_armed;
        if let Some(sticks) = self.sticks.filter(|_| time >= self.sticks_at + STICKS_PERIOD) {
            self.sticks_at = time;
            let excited = match step {
                Step::Excite { altitude, .. } => excitation(status, altitude, waited),
                _ => sticks,
            };
            self.send_sticks(excited, send);
        }
        if let Step::WalkAnchor { way: [north, east], speed, ramp } = step {
            self.walk = Some(Walk { way: V3::new(north, east, 0.0), speed, ramp });
        }
        self.catches |= step == Step::CatchRod;
        if self.is_done(&step, status, waited) {
            self.at += 1;
            self.step_began = time;
            self.commanded_at = None;
            self.has_armed = false;
            return;
        }
        let timeout = match step {
            Step::Hold { seconds } => seconds + 1.0,
            Step::AwaitDisarmed { timeout } | Step::Radio { timeout } => timeout,
            Step::Excite { seconds, .. } => seconds + 1.0,
            Step::Takeoff { altitude } => TIMEOUT + TIMEOUT_PER_METRE * altitude,
            Step::Land => TIMEOUT + TIMEOUT_PER_METRE * self.highest,
            _ => TIMEOUT,
        };
        if step == Step::Arm && waited > GIVE_UP {
            self.progress = Progress::Failed("never armed".into());
            return;
        }
        if waited > timeout {
            self.progress = Progress::Failed(format!("{} not done after {timeout} s", step.name()));
            return;
        }
        let is_flight =
            !by_radio && !matches!(step, Step::Arm | Step::Altitude | Step::AwaitDisarmed { .. });
        if is_flight && !status.is_armed && waited > REPEAT && !matches!(step, Step::Land) {
            self.progress = Progress::Failed(format!("disarmed during {}", step.name()));
            return;
        }
        if self.commanded_at.is_none_or(|at| time > at + REPEAT)
            && self.command(&step, status, waited, send)
        {
            self.commanded_at = Some(time);
        }
    }

    fn is_done(&self, step: &Step, status: &Status, waited: f64) -> bool {
        if let Some(mode) = mode_of(step) {
            return status.is_in(mode);
        }
        match step {
            Step::Arm => status.is_armed,
            Step::Takeoff { .. } => status.is_in(Mode::TetherHold) && status.is_in_air,
            Step::Hold { seconds } => waited >= *seconds,
            Step::Move { .. } => {
                let rests = status.reference_speed.is_some_and(|speed| speed < 1e-3);
                self.commanded_at.is_some() && waited > 2.0 && rests
            }
            Step::TautMove { elevation: [_, to], second: [_, second], duration, .. } => {
                waited > *duration
                    && taut_rest(status)
                        .is_some_and(|(phi, y)| is_at(phi, *to) && is_at(y, *second))
            }
            Step::Excite { seconds, .. } => waited >= *seconds,
            Step::WalkAnchor { .. } | Step::CatchRod => true,
            Step::Land | Step::AwaitDisarmed { .. } => !status.is_armed,
            Step::Radio { .. } => self.has_armed && !status.is_armed,
            // Those that wait for their mode.
            Step::Taut { .. }
            | Step::TetherHold
            | Step::TetherAngle
            | Step::Pendulum
            | Step::Altitude => false,
        }
    }

    /// Sends what the step needs; false when nothing is to be sent.
    fn command(
        &mut self,
        step: &Step,
        status: &Status,
        waited: f64,
        send: &mut dyn FnMut(&[u8]),
    ) -> bool {
        let degrees = |x: &Option<f64>| x.map_or(f32::NAN, |x| x.to_degrees() as f32);
        let plain = |x: &Option<f64>| x.map_or(f32::NAN, |x| x as f32);
        let mut p = [0.0_f32; 7];
        let command = match step {
            Step::Arm => {
                let asks_why = waited > ASK_UNARMABLE && self.commanded_at.is_none();
                if !status.is_armable && !asks_why {
                    return false;
                }
                p = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
                MavCmd::MAV_CMD_COMPONENT_ARM_DISARM
            }
            Step::Takeoff { altitude } => {
                if status.is_in(Mode::Takeoff) {
                    return false;
                }
                p = [0.0, 0.0, 0.0, f32::NAN, f32::NAN, f32::NAN, *altitude as f32];
                MavCmd::MAV_CMD_NAV_TAKEOFF
            }
            Step::Move { elevation, azimuth, length, tension } => {
                if self.commanded_at.is_some() {
                    return false;
                }
                p = [
                    degrees(elevation),
                    degrees(azimuth),
                    plain(length),
                    plain(tension),
                    0.0,
                    0.0,
                    0.0,
                ];
                MavCmd::MAV_CMD_USER_1
            }
            Step::TautMove { elevation: [from, to], second: [y_from, y_to], control, duration } => {
                // Again until it is accepted and flown.
                let is_there = |(phi, y)| is_at(phi, *to) && is_at(y, *y_to);
                if taut_rest(status).is_none_or(is_there) {
                    return false;
                }
                let is_force = *control == TautControl::Force;
                let unit = |y: &f64| if is_force { *y as f32 } else { y.to_degrees() as f32 };
                let degrees = |x: &f64| x.to_degrees() as f32;
                p = [
                    degrees(from),
                    degrees(to),
                    unit(y_from),
                    unit(y_to),
                    0.0,
                    0.0,
                    *duration as f32,
                ];
                if is_force { MavCmd::MAV_CMD_USER_2 } else { MavCmd::MAV_CMD_USER_3 }
            }
            Step::Land => {
                if status.is_in(Mode::Land) {
                    return false;
                }
                MavCmd::MAV_CMD_NAV_LAND
            }
            Step::Taut { .. }
            | Step::TetherHold
            | Step::TetherAngle
            | Step::Pendulum
            | Step::Altitude => {
                if matches!(step, Step::Altitude) {
                    self.sticks = Some([0.0; 3]);
                }
                let Some(mode) = mode_of(step) else { return false };
                send(&self.sender.set_mode(self.target, mode));
                return true;
            }
            Step::Hold { .. }
            | Step::Excite { .. }
            | Step::WalkAnchor { .. }
            | Step::CatchRod
            | Step::Radio { .. }
            | Step::AwaitDisarmed { .. } => return false,
        };
        send(&self.sender.command(self.target, command, p));
        true
    }

    fn send_sticks(&mut self, [roll, pitch, throttle]: [f64; 3], send: &mut dyn FnMut(&[u8])) {
        let unit = |x: f64| (x.clamp(-1.0, 1.0) * 1e3) as i16;
        let message = MANUAL_CONTROL_DATA {
            x: unit(pitch),
            y: unit(roll),
            z: unit(throttle.max(0.0)),
            r: 0,
            target: self.target,
            ..MANUAL_CONTROL_DATA::default()
        };
        send(&self.sender.frame(&message));
    }
}
