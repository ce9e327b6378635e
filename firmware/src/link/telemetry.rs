//! What each outgoing message is made of. One place per message.

// MAVLink deprecates messages that today's clients still send and ask for.
#![allow(deprecated)]

use super::{Link, Sink, global};
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::{Event, ImuHealth};
use crate::supervisor::{GroundState, MODES, Mode, ModeRule};
use crate::vehicle::StepOutput;
use mavlink::dialects::common as mav;
use mavlink::types::CharArray;

/// PX4 release whose MAVLink behaviour is followed, as AUTOPILOT_VERSION encodes it (type DEV).
/// QGroundControl refuses to work with less than 1.4.1.
const PX4_INTERFACE_VERSION: u32 = (1 << 24) | (15 << 16);
/// Standard gravity by which MAVLink's tension in kg is meant, m/s².
const KG_TO_N: f32 = 9.806_65;

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
    fn new<S: Scalar>(out: &StepOutput<S>) -> Self {
        let e = &out.estimate;
        let three = |v: &crate::frames::V3<S>| [v.x.to_f32(), v.y.to_f32(), v.z.to_f32()];
        let (roll, pitch, yaw) = e.attitude.euler();
        Self {
            boot_ms: out.now.boot_ms(),
            usec: out.now.0,
            position: e.position.map(|p| three(&p.0)),
            velocity: e.velocity.map(|v| three(&v.0)),
            euler: [roll.to_f32(), pitch.to_f32(), yaw.to_f32()],
            rate: three(&e.rate.0),
            quaternion: e.attitude.quaternion().map(Scalar::to_f32),
            height: e.height.to_f32(),
            climb: e.climb.to_f32(),
        }
    }
}

/// Heading in hundredths of a degree, 0..36000.
fn heading_cdeg(yaw: f32) -> u16 {
    let degrees = yaw.to_degrees();
    ((if degrees < 0.0 { degrees + 360.0 } else { degrees }) * 100.0) as u16
}

fn base_mode<S: Scalar>(out: &StepOutput<S>) -> mav::MavModeFlag {
    use mav::MavModeFlag as F;
    let mut flags = F::MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | F::MAV_MODE_FLAG_STABILIZE_ENABLED;
    let manual = out.mode.rule().needs.sticks;
    flags |= if manual {
        F::MAV_MODE_FLAG_MANUAL_INPUT_ENABLED
    } else {
        F::MAV_MODE_FLAG_AUTO_ENABLED | F::MAV_MODE_FLAG_GUIDED_ENABLED
    };
    if out.is_armed {
        flags |= F::MAV_MODE_FLAG_SAFETY_ARMED;
    }
    flags
}

fn standard_mode(mode: Mode) -> mav::MavStandardMode {
    use mav::MavStandardMode as M;
    match mode {
        Mode::Altitude => M::MAV_STANDARD_MODE_ALTITUDE_HOLD,
        Mode::Land => M::MAV_STANDARD_MODE_LAND,
        Mode::Takeoff => M::MAV_STANDARD_MODE_TAKEOFF,
        Mode::Stabilize | Mode::TetherHold | Mode::Descent => M::MAV_STANDARD_MODE_NON_STANDARD,
    }
}

impl Link {
    /// Sends one message; nothing for an id that is not known or has nothing to say yet.
    pub(super) fn send_message<S: Scalar>(
        &mut self,
        id: u32,
        argument: u16,
        out: &StepOutput<S>,
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
                let [a, b, c, d] =
                    out.actuation.throttle.map(|t| (1000.0 + 1000.0 * t.to_f32()) as u16);
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

    pub(super) fn send_text(&mut self, event: &Event, sink: Sink) {
        use crate::signal::Severity;
        use mav::MavSeverity as V;
        let severity = match event.severity {
            Severity::Critical => V::MAV_SEVERITY_CRITICAL,
            Severity::Error => V::MAV_SEVERITY_ERROR,
            Severity::Warning => V::MAV_SEVERITY_WARNING,
            Severity::Info => V::MAV_SEVERITY_INFO,
        };
        self.send(&mav::STATUSTEXT_DATA { severity, text: CharArray::from(event.text) }, sink);
    }

    fn send_heartbeat<S: Scalar>(&mut self, out: &StepOutput<S>, params: &Params, sink: Sink) {
        let autopilot = if params.autopilot_type as u8 == 12 {
            mav::MavAutopilot::MAV_AUTOPILOT_PX4
        } else {
            mav::MavAutopilot::MAV_AUTOPILOT_GENERIC
        };
        let system_status = match (out.failures != 0, out.is_armed, out.estimate.is_levelled) {
            (true, true, _) => mav::MavState::MAV_STATE_CRITICAL,
            (false, true, _) => mav::MavState::MAV_STATE_ACTIVE,
            (_, false, true) => mav::MavState::MAV_STATE_STANDBY,
            (_, false, false) => mav::MavState::MAV_STATE_CALIBRATING,
        };
        let m = mav::HEARTBEAT_DATA {
            custom_mode: out.mode.rule().custom_mode,
            mavtype: mav::MavType::MAV_TYPE_QUADROTOR,
            autopilot,
            base_mode: base_mode(out),
            system_status,
            mavlink_version: 3,
        };
        self.send(&m, sink);
    }

    fn send_sys_status<S: Scalar>(&mut self, out: &StepOutput<S>, sink: Sink) {
        use mav::MavSysStatusSensor as F;
        let inertial = F::MAV_SYS_STATUS_SENSOR_3D_GYRO | F::MAV_SYS_STATUS_SENSOR_3D_ACCEL;
        let altitude =
            F::MAV_SYS_STATUS_SENSOR_ABSOLUTE_PRESSURE | F::MAV_SYS_STATUS_SENSOR_LASER_POSITION;
        // The tether gives the local position; of all bits this one means "a position without GPS".
        let position = F::MAV_SYS_STATUS_SENSOR_VISION_POSITION;
        let always = F::MAV_SYS_STATUS_GEOFENCE | F::MAV_SYS_STATUS_SENSOR_MOTOR_OUTPUTS;
        let attitude = F::MAV_SYS_STATUS_AHRS;
        let battery_bit = F::MAV_SYS_STATUS_SENSOR_BATTERY;
        let prearm = F::MAV_SYS_STATUS_PREARM_CHECK;
        let present = inertial | altitude | position | always | attitude | battery_bit | prearm;
        let mut health = always;
        let mut set = |bits: F, holds: bool| {
            if holds {
                health |= bits;
            }
        };
        set(inertial, out.sensors.imu_health == ImuHealth::Good);
        set(altitude, out.sensors.altitude_is_fresh);
        set(position, out.estimate.position.is_some());
        set(attitude, out.estimate.is_levelled);
        set(battery_bit, out.sensors.battery.is_some());
        set(prearm, out.is_armable || out.is_armed);
        let battery = out.sensors.battery.unwrap_or_default();
        let m = mav::SYS_STATUS_DATA {
            onboard_control_sensors_present: present,
            onboard_control_sensors_enabled: present,
            onboard_control_sensors_health: health,
            load: 0,
            voltage_battery: (battery.voltage.to_f32() * 1000.0) as u16,
            current_battery: (battery.current.to_f32() * 100.0) as i16,
            battery_remaining: (battery.remaining.to_f32() * 100.0) as i8,
            drop_rate_comm: 0,
            errors_comm: self.counters.bad_frames.min(u32::from(u16::MAX)) as u16,
            ..Default::default()
        };
        self.send(&m, sink);
    }

    fn send_global_position(&mut self, v: &View, params: &Params, sink: Sink) {
        let (Some([n, e, d]), Some([vn, ve, vd])) = (v.position, v.velocity) else {
            return;
        };
        let (lat, lon) = global::to_lat_lon(params, n, e);
        let [_, _, yaw] = v.euler;
        let m = mav::GLOBAL_POSITION_INT_DATA {
            time_boot_ms: v.boot_ms,
            lat,
            lon,
            alt: ((params.home_altitude - d) * 1000.0) as i32,
            relative_alt: (-d * 1000.0) as i32,
            vx: (vn * 100.0) as i16,
            vy: (ve * 100.0) as i16,
            vz: (vd * 100.0) as i16,
            hdg: heading_cdeg(yaw),
        };
        self.send(&m, sink);
    }

    fn send_hud<S: Scalar>(&mut self, v: &View, out: &StepOutput<S>, params: &Params, sink: Sink) {
        let [vn, ve, _] = v.velocity.unwrap_or_default();
        let [_, _, yaw] = v.euler;
        let mean: f32 = out.actuation.throttle.iter().map(|t| t.to_f32()).sum::<f32>() * 0.25;
        let m = mav::VFR_HUD_DATA {
            airspeed: 0.0,
            groundspeed: libm::hypotf(vn, ve),
            alt: params.home_altitude + v.height,
            climb: v.climb,
            heading: (heading_cdeg(yaw) / 100) as i16,
            throttle: (mean * 100.0) as u16,
        };
        self.send(&m, sink);
    }

    fn send_position_target<S: Scalar>(&mut self, v: &View, out: &StepOutput<S>, sink: Sink) {
        let Some(r) = &out.reference else { return };
        let m = mav::POSITION_TARGET_LOCAL_NED_DATA {
            time_boot_ms: v.boot_ms,
            x: r.position.0.x.to_f32(),
            y: r.position.0.y.to_f32(),
            z: r.position.0.z.to_f32(),
            vx: r.velocity.0.x.to_f32(),
            vy: r.velocity.0.y.to_f32(),
            vz: r.velocity.0.z.to_f32(),
            yaw: r.yaw.to_f32(),
            coordinate_frame: mav::MavFrame::MAV_FRAME_LOCAL_NED,
            ..Default::default()
        };
        self.send(&m, sink);
    }

    fn send_battery<S: Scalar>(&mut self, out: &StepOutput<S>, params: &Params, sink: Sink) {
        let Some(battery) = out.sensors.battery else {
            return;
        };
        let cells = (params.battery_cells as usize).clamp(1, 10);
        let per_cell = (battery.voltage.to_f32() * 1000.0 / cells as f32) as u16;
        let mut voltages = [u16::MAX; 10];
        for cell in voltages.iter_mut().take(cells) {
            *cell = per_cell;
        }
        let m = mav::BATTERY_STATUS_DATA {
            current_consumed: (battery.drawn.to_f32() / 3.6) as i32,
            energy_consumed: -1,
            temperature: i16::MAX,
            voltages,
            current_battery: (battery.current.to_f32() * 100.0) as i16,
            id: 0,
            battery_function: mav::MavBatteryFunction::MAV_BATTERY_FUNCTION_ALL,
            mavtype: mav::MavBatteryType::MAV_BATTERY_TYPE_LIPO,
            battery_remaining: (battery.remaining.to_f32() * 100.0) as i8,
        };
        self.send(&m, sink);
    }

    fn send_version(&mut self, sink: Sink) {
        use mav::MavProtocolCapability as C;
        let capabilities = C::MAV_PROTOCOL_CAPABILITY_PARAM_FLOAT
            | C::MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_BYTEWISE
            | C::MAV_PROTOCOL_CAPABILITY_COMMAND_INT
            | C::MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_LOCAL_NED
            | C::MAV_PROTOCOL_CAPABILITY_MAVLINK2;
        let m = mav::AUTOPILOT_VERSION_DATA {
            capabilities,
            flight_sw_version: PX4_INTERFACE_VERSION,
            middleware_sw_version: PX4_INTERFACE_VERSION,
            flight_custom_version: *b"tautline",
            ..Default::default()
        };
        self.send(&m, sink);
    }

    fn send_estimator_status<S: Scalar>(
        &mut self,
        v: &View,
        out: &StepOutput<S>,
        params: &Params,
        sink: Sink,
    ) {
        use mav::EstimatorStatusFlags as F;
        let e = &out.estimate;
        let mut flags = F::empty();
        let mut set = |bits: F, holds: bool| {
            if holds {
                flags |= bits;
            }
        };
        set(F::ESTIMATOR_ATTITUDE, e.is_levelled);
        set(F::ESTIMATOR_POS_VERT_ABS | F::ESTIMATOR_VELOCITY_VERT, out.sensors.altitude_is_fresh);
        set(F::ESTIMATOR_POS_VERT_AGL, out.sensors.altitude_is_ranged);
        set(F::ESTIMATOR_POS_HORIZ_REL | F::ESTIMATOR_VELOCITY_HORIZ, e.position.is_some());
        set(F::ESTIMATOR_ACCEL_ERROR, out.sensors.imu_health != ImuHealth::Good);
        // Our ratios are squared and fail at `EST_DIV_RATIO`; MAVLink's fail at 1.
        let ratio = |x: S| libm::sqrtf((x.to_f32() / params.divergence_ratio).max(0.0));
        let m = mav::ESTIMATOR_STATUS_DATA {
            time_usec: v.usec,
            vel_ratio: ratio(e.health.accel),
            pos_horiz_ratio: ratio(e.health.length),
            pos_vert_ratio: ratio(e.health.altitude),
            pos_horiz_accuracy: libm::hypotf(e.position_sd.x.to_f32(), e.position_sd.y.to_f32()),
            pos_vert_accuracy: e.position_sd.z.to_f32(),
            flags,
            ..Default::default()
        };
        self.send(&m, sink);
    }

    fn send_home(&mut self, params: &Params, sink: Sink) {
        let (latitude, longitude) = global::to_lat_lon(params, 0.0, 0.0);
        let m = mav::HOME_POSITION_DATA {
            latitude,
            longitude,
            altitude: (params.home_altitude * 1000.0) as i32,
            q: [1.0, 0.0, 0.0, 0.0],
            ..Default::default()
        };
        self.send(&m, sink);
    }

    /// Elevation and azimuth in degrees, length in m, tension in N.
    fn send_tether<S: Scalar>(&mut self, out: &StepOutput<S>, sink: Sink) {
        let Some(tether) = &out.estimate.tether else {
            return;
        };
        let values = [
            ("tet_elev", tether.elevation.to_f32().to_degrees()),
            ("tet_azim", tether.azimuth.to_f32().to_degrees()),
            ("tet_len", tether.length.to_f32()),
            ("tet_tens", tether.tension.to_f32()),
        ];
        for (name, value) in values {
            let m = mav::NAMED_VALUE_FLOAT_DATA {
                time_boot_ms: out.now.boot_ms(),
                value,
                name: CharArray::from(name),
            };
            self.send(&m, sink);
        }
    }

    /// Position in LOCAL_NED around the anchor, velocity in body axes.
    fn send_odometry<S: Scalar>(&mut self, v: &View, out: &StepOutput<S>, sink: Sink) {
        let (Some([x, y, z]), Some(velocity)) = (v.position, &out.estimate.velocity) else {
            return;
        };
        let body = out.estimate.attitude.to_body(*velocity).0;
        let ([p, q, r], sd) = (v.rate, &out.estimate.position_sd);
        let variance = |s: S| s.to_f32() * s.to_f32();
        // Upper triangle of x y z roll pitch yaw, row by row; NaN first means "unknown" in MAVLink.
        let mut pose_covariance = [0.0; 21];
        for (at, value) in [(0, sd.x), (6, sd.y), (11, sd.z)] {
            if let Some(slot) = pose_covariance.get_mut(at) {
                *slot = variance(value);
            }
        }
        let mut velocity_covariance = [0.0; 21];
        if let Some(first) = velocity_covariance.first_mut() {
            *first = f32::NAN;
        }
        let m = mav::ODOMETRY_DATA {
            time_usec: v.usec,
            x,
            y,
            z,
            q: v.quaternion,
            vx: body.x.to_f32(),
            vy: body.y.to_f32(),
            vz: body.z.to_f32(),
            rollspeed: p,
            pitchspeed: q,
            yawspeed: r,
            pose_covariance,
            velocity_covariance,
            frame_id: mav::MavFrame::MAV_FRAME_LOCAL_NED,
            child_frame_id: mav::MavFrame::MAV_FRAME_BODY_FRD,
        };
        self.send(&m, sink);
    }

    /// Index 0 asks for all; after an accepted request the last index is always sent.
    fn send_available_modes(&mut self, index: u16, sink: Sink) {
        let mut count = 0_u8;
        for rule in &MODES {
            count += 1;
            if index == 0 || index == u16::from(count) {
                self.send_available_mode(rule, count, sink);
            }
        }
    }

    fn send_available_mode(&mut self, rule: &ModeRule, mode_index: u8, sink: Sink) {
        let properties = if rule.needs.sticks {
            mav::MavModeProperty::empty()
        } else {
            mav::MavModeProperty::MAV_MODE_PROPERTY_AUTO_MODE
        };
        let m = mav::AVAILABLE_MODES_DATA {
            custom_mode: rule.custom_mode,
            properties,
            number_modes: MODES.len() as u8,
            mode_index,
            standard_mode: standard_mode(rule.mode),
            mode_name: CharArray::from(rule.name),
        };
        self.send(&m, sink);
    }

    /// MAVLink gives the tension in kg.
    fn send_winch<S: Scalar>(&mut self, out: &StepOutput<S>, sink: Sink) {
        let Some(tether) = &out.estimate.tether else {
            return;
        };
        let status = if out.sensors.tether_is_fresh {
            mav::MavWinchStatusFlag::MAV_WINCH_STATUS_HEALTHY
        } else {
            mav::MavWinchStatusFlag::empty()
        };
        let m = mav::WINCH_STATUS_DATA {
            time_usec: out.now.0,
            line_length: tether.length.to_f32(),
            speed: f32::NAN,
            tension: tether.tension.to_f32() / KG_TO_N,
            voltage: f32::NAN,
            current: f32::NAN,
            status,
            temperature: i16::MAX,
        };
        self.send(&m, sink);
    }
}
