//! What the sensors say and the actuators are told.

use super::Outgoing;
use crate::frames::V3;
use crate::mavlink::{Session, Sink};
use crate::time::Micros;
use mavlink::dialects::common as mav;

/// Standard gravity in a thousandth of which SCALED_IMU counts, m/s².
const MILLI_G: f32 = 9.806_65e-3;
/// What a rangefinder of the supported kind sees at the least, cm.
const RANGE_MIN: u16 = 10;
/// RC_CHANNELS: the middle of a stick, its half range, and the throttle's lowest, µs.
const MIDDLE: f32 = 1500.0;
const HALF: f32 = 500.0;
const LOW: f32 = 1000.0;
/// Channels older than this are not shown, µs.
const FRESH_US: u64 = 1_000_000;
/// No such channel.
const NONE: u16 = u16::MAX;

fn three(v: &V3<f32>) -> [f32; 3] {
    [v.x, v.y, v.z]
}

impl Session {
    pub(super) fn send_imu(&mut self, at: &Outgoing, sink: Sink) {
        use mav::HighresImuUpdatedFlags as F;
        let Some(imu) = &at.out.sensors.imu else { return };
        let ([xacc, yacc, zacc], [xgyro, ygyro, zgyro]) =
            (three(&imu.value.accel.0), three(&imu.value.gyro.0));
        let m = mav::HIGHRES_IMU_DATA {
            time_usec: at.out.now.0,
            xacc,
            yacc,
            zacc,
            xgyro,
            ygyro,
            zgyro,
            pressure_alt: at.params.home_altitude + at.out.estimate.height,
            fields_updated: F::HIGHRES_IMU_UPDATED_XACC
                | F::HIGHRES_IMU_UPDATED_YACC
                | F::HIGHRES_IMU_UPDATED_ZACC
                | F::HIGHRES_IMU_UPDATED_XGYRO
                | F::HIGHRES_IMU_UPDATED_YGYRO
                | F::HIGHRES_IMU_UPDATED_ZGYRO,
            ..Default::default()
        };
        self.send(&m, sink);
    }

    pub(super) fn send_scaled_imu(&mut self, at: &Outgoing, sink: Sink) {
        let Some(imu) = &at.out.sensors.imu else { return };
        let [xacc, yacc, zacc] = three(&imu.value.accel.0).map(|x| (x / MILLI_G) as i16);
        let [xgyro, ygyro, zgyro] = three(&imu.value.gyro.0).map(|x| (x * 1000.0) as i16);
        let m = mav::SCALED_IMU_DATA {
            time_boot_ms: at.out.now.boot_ms(),
            xacc,
            yacc,
            zacc,
            xgyro,
            ygyro,
            zgyro,
            ..Default::default()
        };
        self.send(&m, sink);
    }

    /// The rangefinder, while the altitude is its own.
    pub(super) fn send_distance(&mut self, at: &Outgoing, sink: Sink) {
        let (sensors, estimate) = (&at.out.sensors, &at.out.estimate);
        if !(sensors.altitude_is_ranged && sensors.altitude_is_fresh) {
            return;
        }
        let distance = estimate.height / estimate.attitude.cos_tilt().max(0.1);
        let m = mav::DISTANCE_SENSOR_DATA {
            time_boot_ms: at.out.now.boot_ms(),
            min_distance: RANGE_MIN,
            max_distance: (at.params.range_max * 100.0) as u16,
            current_distance: ((distance - at.params.range_offset) * 100.0) as u16,
            mavtype: mav::MavDistanceSensor::MAV_DISTANCE_SENSOR_LASER,
            id: 0,
            orientation: mav::MavSensorOrientation::MAV_SENSOR_ROTATION_PITCH_270,
            covariance: u8::MAX,
        };
        self.send(&m, sink);
    }

    /// The same on all axes: the filters keep no more.
    pub(super) fn send_vibration(&mut self, at: &Outgoing, sink: Sink) {
        let shake = at.out.estimate.vibration;
        let m = mav::VIBRATION_DATA {
            time_usec: at.out.now.0,
            vibration_x: shake,
            vibration_y: shake,
            vibration_z: shake,
            ..Default::default()
        };
        self.send(&m, sink);
    }

    pub(super) fn send_actuators(&mut self, at: &Outgoing, sink: Sink) {
        let throttle = &at.out.actuation.throttle;
        let mut actuator = [0.0; 32];
        for (to, from) in actuator.iter_mut().zip(throttle.iter()) {
            *to = *from;
        }
        let active = (1_u32 << throttle.len().min(31)) - 1;
        self.send(
            &mav::ACTUATOR_OUTPUT_STATUS_DATA { time_usec: at.out.now.0, active, actuator },
            sink,
        );
    }

    pub(super) fn send_attitude_target(&mut self, at: &Outgoing, sink: Sink) {
        if !at.out.is_armed {
            return;
        }
        let [roll, pitch, yaw] = three(&at.out.rate_setpoint.0);
        let m = mav::ATTITUDE_TARGET_DATA {
            time_boot_ms: at.out.now.boot_ms(),
            q: at.out.estimate.attitude.quaternion(),
            body_roll_rate: roll,
            body_pitch_rate: pitch,
            body_yaw_rate: yaw,
            thrust: at.out.wrench.thrust / at.params.thrust_max.max(0.1),
            type_mask: mav::AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_ATTITUDE_IGNORE,
        };
        self.send(&m, sink);
    }

    /// A radio's channels; without one what a joystick says, as such.
    pub(super) fn send_channels(&mut self, at: &Outgoing, sink: Sink) {
        let now = at.out.now;
        if let Some(radio) = at.out.radio.filter(|radio| now.since(radio.at) < FRESH_US) {
            let quality = radio.value.link_quality.unwrap_or(u8::MAX);
            return self.send_rc((&radio.value.channels, quality), now, sink);
        }
        let Some(sticks) = self.sticks.filter(|s| now.since(s.at) < FRESH_US) else {
            return;
        };
        let us = |x: f32| (MIDDLE + HALF * x) as u16;
        let s = sticks.value;
        let throttle = (LOW + 2.0 * HALF * s.throttle) as u16;
        self.send_rc((&[us(s.roll), us(-s.pitch), throttle, us(s.yaw)], u8::MAX), now, sink);
    }

    /// Channels, and how well they are heard: a share, %, as PX4 sends it, or [`u8::MAX`].
    fn send_rc(&mut self, (channels, rssi): (&[u16], u8), now: Micros, sink: Sink) {
        let us = |channel: usize| channels.get(channel).copied().unwrap_or(NONE);
        let m = mav::RC_CHANNELS_DATA {
            time_boot_ms: now.boot_ms(),
            chan1_raw: us(0),
            chan2_raw: us(1),
            chan3_raw: us(2),
            chan4_raw: us(3),
            chan5_raw: us(4),
            chan6_raw: us(5),
            chan7_raw: us(6),
            chan8_raw: us(7),
            chan9_raw: us(8),
            chan10_raw: us(9),
            chan11_raw: us(10),
            chan12_raw: us(11),
            chan13_raw: us(12),
            chan14_raw: us(13),
            chan15_raw: us(14),
            chan16_raw: us(15),
            chan17_raw: NONE,
            chan18_raw: NONE,
            chancount: channels.len() as u8,
            rssi,
        };
        self.send(&m, sink);
    }
}
