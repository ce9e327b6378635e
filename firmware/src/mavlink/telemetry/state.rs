//! Where the vehicle is and how well it knows.

use super::Outgoing;
use crate::mavlink::{KG_TO_N, Session, Sink, global};
use crate::signal::{FilterHealth, ImuHealth, PositionSource};
use mavlink::dialects::common as mav;
use mavlink::types::CharArray;

/// Heading in hundredths of a degree, 0..36000.
fn heading_cdeg(yaw: f32) -> u16 {
    let degrees = yaw.to_degrees();
    ((if degrees < 0.0 { degrees + 360.0 } else { degrees }) * 100.0) as u16
}

impl Session {
    pub(super) fn send_altitude(&mut self, at: &Outgoing, sink: Sink) {
        let v = &at.view();
        let m = mav::ALTITUDE_DATA {
            time_usec: v.usec,
            altitude_monotonic: v.height,
            altitude_amsl: at.params.home_altitude + v.height,
            altitude_local: v.height,
            altitude_relative: v.height,
            altitude_terrain: v.height,
            bottom_clearance: v.height - at.params.ground_height,
        };
        self.send(&m, sink);
    }

    /// The anchor, from which everything local counts.
    pub(super) fn send_origin(&mut self, at: &Outgoing, sink: Sink) {
        let (latitude, longitude) = global::to_lat_lon(at.params, 0.0, 0.0);
        let altitude = (at.params.home_altitude * 1000.0) as i32;
        self.send(&mav::GPS_GLOBAL_ORIGIN_DATA { latitude, longitude, altitude }, sink);
    }

    pub(super) fn send_global_position(&mut self, at: &Outgoing, sink: Sink) {
        let Outgoing { params, .. } = *at;
        let v = &at.view();
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

    pub(super) fn send_hud(&mut self, at: &Outgoing, sink: Sink) {
        let Outgoing { out, params, .. } = *at;
        let v = &at.view();
        let [vn, ve, _] = v.velocity.unwrap_or_default();
        let [_, _, yaw] = v.euler;
        let throttle = &out.actuation.throttle;
        let mean = throttle.iter().sum::<f32>() / throttle.len().max(1) as f32;
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

    pub(super) fn send_position_target(&mut self, at: &Outgoing, sink: Sink) {
        let Outgoing { out, .. } = *at;
        let v = &at.view();
        let Some(r) = &out.reference else { return };
        let m = mav::POSITION_TARGET_LOCAL_NED_DATA {
            time_boot_ms: v.boot_ms,
            x: r.position.0.x,
            y: r.position.0.y,
            z: r.position.0.z,
            vx: r.velocity.0.x,
            vy: r.velocity.0.y,
            vz: r.velocity.0.z,
            yaw: r.yaw,
            coordinate_frame: mav::MavFrame::MAV_FRAME_LOCAL_NED,
            ..Default::default()
        };
        self.send(&m, sink);
    }

    /// Position in LOCAL_NED around the anchor, velocity in body axes.
    pub(super) fn send_odometry(&mut self, at: &Outgoing, sink: Sink) {
        let Outgoing { out, .. } = *at;
        let v = &at.view();
        let (Some([x, y, z]), Some(velocity)) = (v.position, &out.estimate.velocity) else {
            return;
        };
        let body = out.estimate.attitude.to_body(*velocity).0;
        let ([p, q, r], sd) = (v.rate, &out.estimate.position_sd);
        let variance = |s: f32| s * s;
        // Upper triangle of x y z roll pitch yaw, row by row; NaN first means "unknown" in MAVLink.
        let mut pose_covariance = [0.0; 21];
        for (at, value) in [(0, sd.x), (6, sd.y), (11, sd.z), (20, out.estimate.heading_sd)] {
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
            vx: body.x,
            vy: body.y,
            vz: body.z,
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

    /// Elevation and azimuth in degrees, length in m, tension in N; in the taut-link modes also elevation
    /// and pitch in degrees and link force in N as the inertial observer sees them.
    pub(super) fn send_tether(&mut self, at: &Outgoing, sink: Sink) {
        let Outgoing { out, .. } = *at;
        let degrees = |angle: f32| angle.to_degrees();
        let tether = out.estimate.tether.as_ref().map(|tether| {
            [
                ("tet_elev", degrees(tether.elevation)),
                ("tet_azim", degrees(tether.azimuth)),
                ("tet_len", tether.length),
                ("tet_tens", tether.tension),
            ]
        });
        let taut = out.taut.as_ref().filter(|_| out.taut_reference.is_some()).map(|taut| {
            [
                ("tlk_elev", degrees(taut.planar.elevation)),
                ("tlk_pitch", degrees(taut.planar.pitch)),
                ("tlk_force", taut.link_force),
            ]
        });
        let angle = out.angle.as_ref().map(|angle| {
            let [north, west] = angle.angles();
            [
                ("tag_north", degrees(north)),
                ("tag_west", degrees(west)),
                ("tag_tens", angle.tension),
            ]
        });
        let taut = taut.into_iter().chain(angle).flatten();
        for (name, value) in tether.into_iter().flatten().chain(taut) {
            let m = mav::NAMED_VALUE_FLOAT_DATA {
                time_boot_ms: out.now.boot_ms(),
                value,
                name: CharArray::from(name),
            };
            self.send(&m, sink);
        }
    }

    /// MAVLink gives the tension in kg.
    pub(super) fn send_winch(&mut self, at: &Outgoing, sink: Sink) {
        let Outgoing { out, .. } = *at;
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
            line_length: tether.length,
            speed: f32::NAN,
            tension: tether.tension / KG_TO_N,
            voltage: f32::NAN,
            current: f32::NAN,
            status,
            temperature: i16::MAX,
        };
        self.send(&m, sink);
    }

    pub(super) fn send_home(&mut self, at: &Outgoing, sink: Sink) {
        let Outgoing { params, .. } = *at;
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

    pub(super) fn send_estimator_status(&mut self, at: &Outgoing, sink: Sink) {
        let Outgoing { out, params, .. } = *at;
        let v = &at.view();
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
        // Our ratios are squared and fail at these; MAVLink's fail at 1.
        let simple = params.divergence_ratio;
        let most = match e.source {
            PositionSource::FullState => FilterHealth::FULL_STATE_MOST,
            _ => FilterHealth { accel: simple, altitude: simple, length: simple },
        };
        let ratio = |x: f32, most: f32| libm::sqrtf((x / most).max(0.0));
        let m = mav::ESTIMATOR_STATUS_DATA {
            time_usec: v.usec,
            vel_ratio: ratio(e.health.accel, most.accel),
            pos_horiz_ratio: ratio(e.health.length, most.length),
            pos_vert_ratio: ratio(e.health.altitude, most.altitude),
            pos_horiz_accuracy: libm::hypotf(e.position_sd.x, e.position_sd.y),
            pos_vert_accuracy: e.position_sd.z,
            flags,
            ..Default::default()
        };
        self.send(&m, sink);
    }
}
