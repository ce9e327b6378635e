//! What the vehicle is and how it does.

use super::{Outgoing, standard_mode};
use crate::mavlink::{Session, Sink, speaks_px4};
use crate::model::TetherKind;
use crate::param::Params;
use crate::signal::{Event, ImuHealth, Severity};
use crate::supervisor::{Failure, MODES, ModeRule};
use crate::vehicle::StepOutput;
use mavlink::dialects::common as mav;
use mavlink::types::CharArray;

/// PX4 release whose MAVLink behaviour is followed, as AUTOPILOT_VERSION encodes it (type DEV).
/// QGroundControl refuses to work with less than 1.4.1.
const PX4_INTERFACE_VERSION: u32 = (1 << 24) | (15 << 16);

fn is_breached(out: &StepOutput) -> bool {
    out.failures & Failure::FenceBreached.mask() != 0
}

fn base_mode(out: &StepOutput) -> mav::MavModeFlag {
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

impl Session {
    pub(super) fn send_heartbeat(&mut self, at: &Outgoing, sink: Sink) {
        let Outgoing { out, params, .. } = *at;
        let autopilot = if speaks_px4(params) {
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
            mavtype: match out.actuation.throttle.len() {
                6 => mav::MavType::MAV_TYPE_HEXAROTOR,
                8 => mav::MavType::MAV_TYPE_OCTOROTOR,
                _ => mav::MavType::MAV_TYPE_QUADROTOR,
            },
            autopilot,
            base_mode: base_mode(out),
            system_status,
            mavlink_version: 3,
        };
        self.send(&m, sink);
    }

    pub(super) fn send_sys_status(&mut self, at: &Outgoing, sink: Sink) {
        let Outgoing { out, params, .. } = *at;
        use mav::MavSysStatusSensor as F;
        let inertial = F::MAV_SYS_STATUS_SENSOR_3D_GYRO | F::MAV_SYS_STATUS_SENSOR_3D_ACCEL;
        let altitude =
            F::MAV_SYS_STATUS_SENSOR_ABSOLUTE_PRESSURE | F::MAV_SYS_STATUS_SENSOR_LASER_POSITION;
        // The tether gives the local position; of all bits this one means "a position without GPS".
        let position = F::MAV_SYS_STATUS_SENSOR_VISION_POSITION;
        let always = F::MAV_SYS_STATUS_SENSOR_MOTOR_OUTPUTS;
        let fence = F::MAV_SYS_STATUS_GEOFENCE;
        let attitude = F::MAV_SYS_STATUS_AHRS;
        let battery_bit = F::MAV_SYS_STATUS_SENSOR_BATTERY;
        let prearm = F::MAV_SYS_STATUS_PREARM_CHECK;
        let mut present = inertial | altitude | position | always | attitude | battery_bit | prearm;
        present.set(fence, params.has_fence());
        let receiver = F::MAV_SYS_STATUS_SENSOR_RC_RECEIVER;
        present.set(receiver, out.radio.is_some());
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
        set(receiver, out.radio_is_heard());
        set(battery_bit, out.sensors.battery.is_some());
        // Some clients look at the health of a fence that is not there.
        set(fence, !is_breached(out));
        set(prearm, out.is_armable || out.is_armed);
        let battery = out.sensors.battery.unwrap_or_default();
        let m = mav::SYS_STATUS_DATA {
            onboard_control_sensors_present: present,
            onboard_control_sensors_enabled: present,
            onboard_control_sensors_health: health,
            load: 0,
            voltage_battery: (battery.voltage * 1000.0) as u16,
            current_battery: (battery.current * 100.0) as i16,
            battery_remaining: (battery.remaining * 100.0) as i8,
            drop_rate_comm: 0,
            errors_comm: self.counters.bad_frames.min(u32::from(u16::MAX)) as u16,
            ..Default::default()
        };
        self.send(&m, sink);
    }

    pub(super) fn send_battery(&mut self, at: &Outgoing, sink: Sink) {
        let Outgoing { out, params, .. } = *at;
        let Some(battery) = out.sensors.battery else {
            return;
        };
        let cells = (params.battery_cells as usize).clamp(1, 10);
        let per_cell = (battery.voltage * 1000.0 / cells as f32) as u16;
        let mut voltages = [u16::MAX; 10];
        for cell in voltages.iter_mut().take(cells) {
            *cell = per_cell;
        }
        let m = mav::BATTERY_STATUS_DATA {
            current_consumed: (battery.drawn / 3.6) as i32,
            energy_consumed: -1,
            temperature: i16::MAX,
            voltages,
            current_battery: (battery.current * 100.0) as i16,
            id: 0,
            battery_function: mav::MavBatteryFunction::MAV_BATTERY_FUNCTION_ALL,
            mavtype: mav::MavBatteryType::MAV_BATTERY_TYPE_LIPO,
            battery_remaining: (battery.remaining * 100.0) as i8,
        };
        self.send(&m, sink);
    }

    pub(super) fn send_version(&mut self, _: &Outgoing, sink: Sink) {
        use mav::MavProtocolCapability as C;
        let capabilities = C::MAV_PROTOCOL_CAPABILITY_PARAM_FLOAT
            | C::MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_BYTEWISE
            | C::MAV_PROTOCOL_CAPABILITY_COMMAND_INT
            // Without it clients do not even ask for the empty mission.
            | C::MAV_PROTOCOL_CAPABILITY_MISSION_INT
            | C::MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_LOCAL_NED
            | C::MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_GLOBAL_INT
            | C::MAV_PROTOCOL_CAPABILITY_SET_ATTITUDE_TARGET
            | C::MAV_PROTOCOL_CAPABILITY_FLIGHT_TERMINATION
            | C::MAV_PROTOCOL_CAPABILITY_MAVLINK2;
        let capabilities = if self.is_served {
            capabilities | C::MAV_PROTOCOL_CAPABILITY_FTP
        } else {
            capabilities
        };
        let m = mav::AUTOPILOT_VERSION_DATA {
            capabilities,
            flight_sw_version: PX4_INTERFACE_VERSION,
            middleware_sw_version: PX4_INTERFACE_VERSION,
            uid: self.identity.uid,
            flight_custom_version: self.identity.revision,
            ..Default::default()
        };
        self.send(&m, sink);
    }

    /// Index 0 asks for all; after an accepted request the last index is always sent.
    pub(super) fn send_available_modes(&mut self, at: &Outgoing, sink: Sink) {
        let Outgoing { argument: index, params, .. } = *at;
        let mut count = 0_u8;
        for rule in MODES.iter().filter(|rule| rule.is_built) {
            count += 1;
            if index == 0 || index == u16::from(count) {
                self.send_available_mode((rule, count), params, sink);
            }
        }
    }

    fn send_available_mode(
        &mut self,
        (rule, mode_index): (&ModeRule, u8),
        params: &Params,
        sink: Sink,
    ) {
        use mav::MavModeProperty as P;
        let mut properties = P::empty();
        properties.set(P::MAV_MODE_PROPERTY_AUTO_MODE, !rule.needs.sticks);
        let kind = TetherKind::from_parameter(params.tether_kind);
        let is_forbidden = !rule.on.contains(kind);
        properties.set(P::MAV_MODE_PROPERTY_NOT_USER_SELECTABLE, is_forbidden);
        let m = mav::AVAILABLE_MODES_DATA {
            custom_mode: rule.custom_mode,
            properties,
            number_modes: MODES.iter().filter(|rule| rule.is_built).count() as u8,
            mode_index,
            standard_mode: standard_mode(rule.mode),
            mode_name: CharArray::from(rule.name),
        };
        self.send(&m, sink);
    }

    /// Where a host keeps what describes the parameters; silence where there is no such thing.
    pub(super) fn send_metadata(&mut self, at: &Outgoing, sink: Sink) {
        let Some(file_crc) = self.metadata_crc else { return };
        let m = mav::COMPONENT_METADATA_DATA {
            time_boot_ms: at.out.now.boot_ms(),
            file_crc,
            uri: CharArray::from("mftp://etc/extras/component_general.json"),
        };
        self.send(&m, sink);
    }

    pub(super) fn send_fence(&mut self, at: &Outgoing, sink: Sink) {
        if !at.params.has_fence() {
            return;
        }
        let m = mav::FENCE_STATUS_DATA {
            breach_status: u8::from(is_breached(at.out)),
            ..Default::default()
        };
        self.send(&m, sink);
    }

    /// Which modes can be chosen changes with the kind of link.
    pub(super) fn send_modes_monitor(&mut self, at: &Outgoing, sink: Sink) {
        let seq = at.params.tether_kind as u8;
        self.send(&mav::AVAILABLE_MODES_MONITOR_DATA { seq }, sink);
    }

    pub(in crate::mavlink) fn send_text(&mut self, event: &Event, sink: Sink) {
        self.say(event.severity, &event.message(), sink);
    }

    /// A STATUSTEXT; what is beyond 50 bytes is cut.
    pub(in crate::mavlink) fn say(&mut self, severity: Severity, text: &str, sink: Sink) {
        use mav::MavSeverity as V;
        let severity = match severity {
            Severity::Critical => V::MAV_SEVERITY_CRITICAL,
            Severity::Error => V::MAV_SEVERITY_ERROR,
            Severity::Warning => V::MAV_SEVERITY_WARNING,
            Severity::Info => V::MAV_SEVERITY_INFO,
        };
        self.send(&mav::STATUSTEXT_DATA { severity, text: CharArray::from(text) }, sink);
    }
}
