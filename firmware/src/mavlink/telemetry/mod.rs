//! What each outgoing message is made of. One place per message.

// MAVLink deprecates messages that today's clients still send and ask for.
#![allow(deprecated)]

mod sensors;
mod state;
mod system;

use super::{Session, Sink};
use crate::param::Params;
use crate::supervisor::{GroundState, Mode};
use crate::vehicle::StepOutput;
use mavlink::MessageData;
use mavlink::dialects::common as mav;

/// What an outgoing message may be made of.
#[derive(Clone, Copy)]
pub(super) struct Outgoing<'a> {
    pub out: &'a StepOutput,
    pub params: &'a Params,
    /// Of the request, where somebody asked for it.
    pub argument: u16,
}

impl Outgoing<'_> {
    fn view(&self) -> View {
        View::new(self.out)
    }
}

/// One row of [`MESSAGES`].
pub(super) struct Message {
    pub id: u32,
    /// Interval at start, µs, 0 = off; `None` for one that is only sent on request.
    pub interval_us: Option<u32>,
    send: fn(&mut Session, &Outgoing, Sink),
}

/// `interval_ms` 0 = off until somebody asks.
const fn stream<D: MessageData>(
    interval_ms: u32,
    send: fn(&mut Session, &Outgoing, Sink),
) -> Message {
    Message { id: D::ID, interval_us: Some(1000 * interval_ms), send }
}

const fn on_request<D: MessageData>(send: fn(&mut Session, &Outgoing, Sink)) -> Message {
    Message { id: D::ID, interval_us: None, send }
}

/// All messages, with their intervals. Together they fit a line of 57,600 baud with room for what is asked: 4.5 kB/s.
pub(super) const MESSAGES: [Message; 34] = [
    stream::<mav::HEARTBEAT_DATA>(1000, Session::send_heartbeat),
    stream::<mav::SYS_STATUS_DATA>(500, Session::send_sys_status),
    stream::<mav::SYSTEM_TIME_DATA>(1000, Session::send_system_time),
    stream::<mav::ATTITUDE_DATA>(50, Session::send_attitude),
    stream::<mav::ATTITUDE_QUATERNION_DATA>(100, Session::send_quaternion),
    stream::<mav::LOCAL_POSITION_NED_DATA>(100, Session::send_local_position),
    stream::<mav::GLOBAL_POSITION_INT_DATA>(200, Session::send_global_position),
    stream::<mav::ALTITUDE_DATA>(500, Session::send_altitude),
    stream::<mav::SERVO_OUTPUT_RAW_DATA>(500, Session::send_servos),
    stream::<mav::VFR_HUD_DATA>(250, Session::send_hud),
    stream::<mav::BATTERY_STATUS_DATA>(1000, Session::send_battery),
    stream::<mav::ESTIMATOR_STATUS_DATA>(500, Session::send_estimator_status),
    stream::<mav::HOME_POSITION_DATA>(2000, Session::send_home),
    stream::<mav::GPS_GLOBAL_ORIGIN_DATA>(5000, Session::send_origin),
    stream::<mav::EXTENDED_SYS_STATE_DATA>(500, Session::send_landed_state),
    stream::<mav::NAMED_VALUE_FLOAT_DATA>(200, Session::send_tether),
    stream::<mav::ODOMETRY_DATA>(500, Session::send_odometry),
    stream::<mav::CURRENT_MODE_DATA>(2000, Session::send_current_mode),
    stream::<mav::AVAILABLE_MODES_MONITOR_DATA>(5000, Session::send_modes_monitor),
    stream::<mav::WINCH_STATUS_DATA>(500, Session::send_winch),
    stream::<mav::DISTANCE_SENSOR_DATA>(200, Session::send_distance),
    stream::<mav::VIBRATION_DATA>(1000, Session::send_vibration),
    stream::<mav::FENCE_STATUS_DATA>(1000, Session::send_fence),
    stream::<mav::HIGHRES_IMU_DATA>(500, Session::send_imu),
    stream::<mav::SCALED_IMU_DATA>(1000, Session::send_scaled_imu),
    stream::<mav::ATTITUDE_TARGET_DATA>(500, Session::send_attitude_target),
    stream::<mav::POSITION_TARGET_LOCAL_NED_DATA>(500, Session::send_position_target),
    stream::<mav::ACTUATOR_OUTPUT_STATUS_DATA>(500, Session::send_actuators),
    stream::<mav::RC_CHANNELS_DATA>(500, Session::send_channels),
    on_request::<mav::AUTOPILOT_VERSION_DATA>(Session::send_version),
    on_request::<mav::MESSAGE_INTERVAL_DATA>(Session::send_interval),
    on_request::<mav::PROTOCOL_VERSION_DATA>(Session::send_protocol_version),
    on_request::<mav::AVAILABLE_MODES_DATA>(Session::send_available_modes),
    on_request::<mav::COMPONENT_METADATA_DATA>(Session::send_metadata),
];

/// Whether somebody can ask for it.
pub(super) fn is_known(id: u32) -> bool {
    MESSAGES.iter().any(|message| message.id == id)
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

impl Session {
    /// Sends one message; nothing for an id that is not known or has nothing to say yet.
    pub(in crate::mavlink) fn send_message(&mut self, id: u32, at: &Outgoing, sink: Sink) {
        if let Some(message) = MESSAGES.iter().find(|message| message.id == id) {
            (message.send)(self, at, sink);
        }
    }

    fn send_system_time(&mut self, at: &Outgoing, sink: Sink) {
        let time_boot_ms = at.out.now.boot_ms();
        self.send(&mav::SYSTEM_TIME_DATA { time_unix_usec: 0, time_boot_ms }, sink);
    }

    fn send_attitude(&mut self, at: &Outgoing, sink: Sink) {
        let v = at.view();
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

    fn send_quaternion(&mut self, at: &Outgoing, sink: Sink) {
        let v = at.view();
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

    fn send_local_position(&mut self, at: &Outgoing, sink: Sink) {
        let v = at.view();
        if let (Some([x, y, z]), Some([vx, vy, vz])) = (v.position, v.velocity) {
            let m = mav::LOCAL_POSITION_NED_DATA { time_boot_ms: v.boot_ms, x, y, z, vx, vy, vz };
            self.send(&m, sink);
        }
    }

    fn send_servos(&mut self, at: &Outgoing, sink: Sink) {
        let out = at.out;
        let pulses = out.actuation.throttle.map(|t| (1000.0 + 1000.0 * t) as u16);
        let [a, b, c, d, e, f, g, h] = pulses.padded();
        let m = mav::SERVO_OUTPUT_RAW_DATA {
            time_usec: out.now.0 as u32,
            servo1_raw: a,
            servo2_raw: b,
            servo3_raw: c,
            servo4_raw: d,
            servo5_raw: e,
            servo6_raw: f,
            servo7_raw: g,
            servo8_raw: h,
            ..Default::default()
        };
        self.send(&m, sink);
    }

    fn send_interval(&mut self, at: &Outgoing, sink: Sink) {
        let argument = at.argument;
        let interval_us = self.streams.interval(u32::from(argument)).unwrap_or(0);
        self.send(&mav::MESSAGE_INTERVAL_DATA { interval_us, message_id: argument }, sink);
    }

    fn send_landed_state(&mut self, at: &Outgoing, sink: Sink) {
        let out = at.out;
        let landed_state = match out.ground {
            GroundState::OnGround => mav::MavLandedState::MAV_LANDED_STATE_ON_GROUND,
            GroundState::TakingOff => mav::MavLandedState::MAV_LANDED_STATE_TAKEOFF,
            GroundState::InAir => mav::MavLandedState::MAV_LANDED_STATE_IN_AIR,
            GroundState::Landing => mav::MavLandedState::MAV_LANDED_STATE_LANDING,
        };
        let vtol_state = mav::MavVtolState::MAV_VTOL_STATE_UNDEFINED;
        self.send(&mav::EXTENDED_SYS_STATE_DATA { vtol_state, landed_state }, sink);
    }

    fn send_protocol_version(&mut self, _: &Outgoing, sink: Sink) {
        let m = mav::PROTOCOL_VERSION_DATA {
            version: 200,
            min_version: 100,
            max_version: 200,
            ..Default::default()
        };
        self.send(&m, sink);
    }

    fn send_current_mode(&mut self, at: &Outgoing, sink: Sink) {
        let out = at.out;
        let custom_mode = out.mode.rule().custom_mode;
        let m = mav::CURRENT_MODE_DATA {
            custom_mode,
            intended_custom_mode: custom_mode,
            standard_mode: standard_mode(out.mode),
        };
        self.send(&m, sink);
    }
}
