//! What each outgoing message is made of. One place per message.

// MAVLink deprecates messages that today's clients still send and ask for.
#![allow(deprecated)]

mod state;
mod system;

use super::{Link, Sink};
use crate::param::Params;
use crate::supervisor::{GroundState, Mode};
use crate::vehicle::StepOutput;
use mavlink::dialects::common as mav;

/// Whether [`Link::send_message`] can send it.
pub fn is_known(id: u32) -> bool {
    matches!(
        id,
        0 | 1
            | 2
            | 30
            | 31
            | 32
            | 33
            | 36
            | 74
            | 85
            | 147
            | 148
            | 230
            | 242
            | 244
            | 245
            | 251
            | 300
            | 331
            | 435
            | 436
            | 9005
    )
}

/// Estimate in `f32`, as every message wants it.
struct View {
    boot_ms: u32,
    usec: u64,
    position: Option<[f32; 3]>,
    velocity: Option<[f32; 3]>,
    euler: [f32; 3],
    rate: [f32; 3],
    quaternion: [f32; 4],
    height: f32,
    climb: f32,
}

impl View {
    fn new(out: &StepOutput) -> Self {
        let e = &out.estimate;
        let three = |v: &crate::frames::V3<f32>| [v.x, v.y, v.z];
        let (roll, pitch, yaw) = e.attitude.euler();
        Self {
            boot_ms: out.now.boot_ms(),
            usec: out.now.0,
            position: e.position.map(|p| three(&p.0)),
            velocity: e.velocity.map(|v| three(&v.0)),
            euler: [roll, pitch, yaw],
            rate: three(&e.rate.0),
            quaternion: e.attitude.quaternion(),
            height: e.height,
            climb: e.climb,
        }
    }
}

fn standard_mode(mode: Mode) -> mav::MavStandardMode {
    let number = mode.rule().standard_mode;
    num_traits::FromPrimitive::from_u8(number).unwrap_or(mav::MavStandardMode::DEFAULT)
}

impl Link {
    /// Sends one message; nothing for an id that is not known or has nothing to say yet.
    pub(in crate::link) fn send_message(
        &mut self,
        id: u32,
        argument: u16,
        out: &StepOutput,
        params: &Params,
        sink: Sink,
    ) {
        let v = View::new(out);
        match id {
            0 => self.send_heartbeat(out, params, sink),
            1 => self.send_sys_status(out, sink),
            2 => self
                .send(&mav::SYSTEM_TIME_DATA { time_unix_usec: 0, time_boot_ms: v.boot_ms }, sink),
            30 => {
                let ([roll, pitch, yaw], [p, q, r]) = (v.euler, v.rate);
                let m = mav::ATTITUDE_DATA {
                    time_boot_ms: v.boot_ms,
                    roll,
                    pitch,
                    yaw,
                    rollspeed: p,
                    pitchspeed: q,
                    yawspeed: r,
                };
                self.send(&m, sink);
            }
            31 => {
                let ([q1, q2, q3, q4], [p, q, r]) = (v.quaternion, v.rate);
                let m = mav::ATTITUDE_QUATERNION_DATA {
                    time_boot_ms: v.boot_ms,
                    q1,
                    q2,
                    q3,
                    q4,
                    rollspeed: p,
                    pitchspeed: q,
                    yawspeed: r,
                };
                self.send(&m, sink);
            }
            32 => {
                if let (Some([x, y, z]), Some([vx, vy, vz])) = (v.position, v.velocity) {
                    let m = mav::LOCAL_POSITION_NED_DATA {
                        time_boot_ms: v.boot_ms,
                        x,
                        y,
                        z,
                        vx,
                        vy,
                        vz,
                    };
                    self.send(&m, sink);
                }
            }
            33 => self.send_global_position(&v, params, sink),
            36 => {
                let [a, b, c, d] = out.actuation.throttle.map(|t| (1000.0 + 1000.0 * t) as u16);
                let m = mav::SERVO_OUTPUT_RAW_DATA {
                    time_usec: v.usec as u32,
                    servo1_raw: a,
                    servo2_raw: b,
                    servo3_raw: c,
                    servo4_raw: d,
                    ..Default::default()
                };
                self.send(&m, sink);
            }
            74 => self.send_hud(&v, out, params, sink),
            85 => self.send_position_target(&v, out, sink),
            147 => self.send_battery(out, params, sink),
            148 => self.send_version(sink),
            230 => self.send_estimator_status(&v, out, params, sink),
            242 => self.send_home(params, sink),
            244 => {
                let interval_us = self.streams.interval(u32::from(argument)).unwrap_or(0);
                self.send(&mav::MESSAGE_INTERVAL_DATA { interval_us, message_id: argument }, sink);
            }
            245 => {
                let landed_state = match out.ground {
                    GroundState::OnGround => mav::MavLandedState::MAV_LANDED_STATE_ON_GROUND,
                    GroundState::TakingOff => mav::MavLandedState::MAV_LANDED_STATE_TAKEOFF,
                    GroundState::InAir => mav::MavLandedState::MAV_LANDED_STATE_IN_AIR,
                    GroundState::Landing => mav::MavLandedState::MAV_LANDED_STATE_LANDING,
                };
                let vtol_state = mav::MavVtolState::MAV_VTOL_STATE_UNDEFINED;
                self.send(&mav::EXTENDED_SYS_STATE_DATA { vtol_state, landed_state }, sink);
            }
            251 => self.send_tether(out, sink),
            300 => {
                let m = mav::PROTOCOL_VERSION_DATA {
                    version: 200,
                    min_version: 100,
                    max_version: 200,
                    ..Default::default()
                };
                self.send(&m, sink);
            }
            331 => self.send_odometry(&v, out, sink),
            435 => self.send_available_modes(argument, sink),
            436 => {
                let custom_mode = out.mode.rule().custom_mode;
                let m = mav::CURRENT_MODE_DATA {
                    custom_mode,
                    intended_custom_mode: custom_mode,
                    standard_mode: standard_mode(out.mode),
                };
                self.send(&m, sink);
            }
            9005 => self.send_winch(out, sink),
            _ => {}
        }
    }
}
