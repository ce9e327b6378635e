//! What each topic is made of: tables, so that one looks like another. Names and fields are PX4's where PX4 has the topic.

pub use super::estimators::{
    EstimatorEkf4, EstimatorPendulum, EstimatorPosition, EstimatorTaut, EstimatorTetherAngle,
};
use super::flight::{FAST, MEDIUM, RARE, SLOW, Scale};
pub use super::radio::InputRc;
pub use super::raw::{
    ActuatorOutputs, DistanceSensor, ManualControlSetpoint, SensorBaro, StepInputs, VehicleAirData,
    VehicleAngularAcceleration,
};
pub use super::status::{
    EstimatorStatus, FailsafeFlags, VehicleImuStatus, VehicleLandDetected, VehicleStatus,
};
use super::ulog::record;
use crate::frames::V3;
use crate::vehicle::StepOutput;

record! {
    /// `sensor_combined`: filtered and calibrated inertial data, body FRD.
    SensorCombined {
        /// rad/s.
        gyro_rad: [f32; 3],
        /// m/s².
        accelerometer_m_s2: [f32; 3],
        /// °C.
        temperature: f32,
    }
    topic "sensor_combined" every FAST;
    of |out| out.sensors.imu.map(|imu| Self {
            timestamp: out.now.0,
            gyro_rad: three(&imu.value.gyro.0),
            accelerometer_m_s2: three(&imu.value.accel.0),
            temperature: out.sensors.imu_temperature,
        })
}
record! {
    /// `vehicle_attitude` and `vehicle_attitude_groundtruth`: body FRD to NED, `[w, x, y, z]`.
    VehicleAttitude {
        /// Unit quaternion.
        q: [f32; 4],
    }
    topic "vehicle_attitude" every MEDIUM;
    of |out| Some(Self { timestamp: out.now.0, q: out.estimate.attitude.quaternion() })
}
record! {
    /// `vehicle_angular_velocity`: bias removed.
    VehicleAngularVelocity {
        /// rad/s.
        xyz: [f32; 3],
    }
    topic "vehicle_angular_velocity" every MEDIUM;
    of |out| Some(Self { timestamp: out.now.0, xyz: three(&out.estimate.rate.0) })
}
record! {
    /// `vehicle_local_position` and `vehicle_local_position_groundtruth`: NED from the anchor.
    VehicleLocalPosition {
        /// m.
        x: f32,
        /// m.
        y: f32,
        /// m.
        z: f32,
        /// m/s.
        vx: f32,
        /// m/s.
        vy: f32,
        /// m/s.
        vz: f32,
        /// rad.
        heading: f32,
        /// One standard deviation, m.
        eph: f32,
        /// One standard deviation, m.
        epv: f32,
        /// Height by altimeter alone, m.
        dist_bottom: f32,
        /// The horizontal part is known.
        xy_valid: bool,
        /// An altimeter answers.
        z_valid: bool,
        /// The horizontal velocity is known.
        v_xy_valid: bool,
        /// The climb is known.
        v_z_valid: bool,
        /// `dist_bottom` comes from the rangefinder.
        dist_bottom_valid: bool,
    }
    topic "vehicle_local_position" every SLOW;
    of |out| {
        let e = &out.estimate;
        let [x, y, z] = e.position.map_or([0.0; 3], |p| three(&p.0));
        let [vx, vy, vz] = e.velocity.map_or([0.0; 3], |v| three(&v.0));
        let [sx, sy, sz] = three(&e.position_sd);
        Some(Self {
            timestamp: out.now.0,
            x,
            y,
            z,
            vx,
            vy,
            vz,
            heading: e.attitude.euler().2,
            eph: libm::hypotf(sx, sy),
            epv: sz,
            dist_bottom: e.height,
            xy_valid: e.position.is_some(),
            z_valid: out.sensors.altitude_is_fresh,
            v_xy_valid: e.velocity.is_some(),
            v_z_valid: e.velocity.is_some(),
            dist_bottom_valid: out.sensors.altitude_is_fresh && out.sensors.altitude_is_ranged,
        })
}
}
record! {
    /// `vehicle_local_position_setpoint`.
    VehicleLocalPositionSetpoint {
        /// m.
        x: f32,
        /// m.
        y: f32,
        /// m.
        z: f32,
        /// m/s.
        vx: f32,
        /// m/s.
        vy: f32,
        /// m/s.
        vz: f32,
        /// rad.
        yaw: f32,
        /// Tension, N.
        tension: f32,
    }
    topic "vehicle_local_position_setpoint" every SLOW;
    of |out| {
        out.reference.map(|r| {
            let ([x, y, z], [vx, vy, vz]) = (three(&r.position.0), three(&r.velocity.0));
            Self { timestamp: out.now.0, x, y, z, vx, vy, vz, yaw: r.yaw, tension: r.tension }
        })
}
}
record! {
    /// `vehicle_rates_setpoint`.
    VehicleRatesSetpoint {
        /// rad/s.
        roll: f32,
        /// rad/s.
        pitch: f32,
        /// rad/s.
        yaw: f32,
        /// Shares of what all rotors give, body FRD.
        thrust_body: [f32; 3],
        /// Thrust, N.
        thrust: f32,
        /// Torque, N m.
        torque: [f32; 3],
        /// The mixer cut roll or pitch.
        tilt_saturated: bool,
        /// The mixer cut yaw.
        yaw_saturated: bool,
        /// The mixer moved the total thrust.
        thrust_saturated: bool,
    }
    topic "vehicle_rates_setpoint" every MEDIUM;
    of |out, scale| {
        let [roll, pitch, yaw] = three(&out.rate_setpoint.0);
        Some(Self {
            timestamp: out.now.0,
            roll,
            pitch,
            yaw,
            thrust_body: thrust_share(out, scale),
            thrust: out.wrench.thrust,
            torque: three(&out.wrench.torque.0),
            tilt_saturated: out.mixer.tilt_is_saturated,
            yaw_saturated: out.mixer.yaw_is_saturated,
            thrust_saturated: out.mixer.thrust_is_saturated,
        })
}
}
record! {
    /// `vehicle_thrust_setpoint`: what is asked of the mixer.
    VehicleThrustSetpoint {
        /// Shares of what all rotors give, body FRD.
        xyz: [f32; 3],
    }
    topic "vehicle_thrust_setpoint" every MEDIUM;
    of |out, scale| Some(Self { timestamp: out.now.0, xyz: thrust_share(out, scale) })
}
record! {
    /// `vehicle_torque_setpoint`: what is asked of the mixer.
    VehicleTorqueSetpoint {
        /// Shares of what half of the rotors give, body FRD.
        xyz: [f32; 3],
    }
    topic "vehicle_torque_setpoint" every MEDIUM;
    of |out, scale| {
        let ([x, y, z], [full_x, full_y, full_z]) = (three(&out.wrench.torque.0), scale.torque);
        let xyz = [share(x, full_x), share(y, full_y), share(z, full_z)];
        Some(Self { timestamp: out.now.0, xyz })
    }
}
record! {
    /// `actuator_motors`, in the order of the table of rotors; zero beyond the last.
    ActuatorMotors {
        /// Throttle, 0..1.
        control: [f32; 8],
        /// Commanded thrust, N.
        thrust: [f32; 8],
        /// To the winch, N.
        winch_tension: f32,
    }
    topic "actuator_motors" every MEDIUM;
    of |out| Some(Self {
            timestamp: out.now.0,
            control: out.actuation.throttle.padded(),
            thrust: out.actuation.thrusts.padded(),
            winch_tension: out.actuation.winch.tension,
        })
}
record! {
    /// `battery_status`.
    BatteryStatus {
        /// V.
        voltage_v: f32,
        /// A.
        current_a: f32,
        /// 0..1.
        remaining: f32,
        /// mAh.
        discharged_mah: f32,
        /// V, low-passed.
        cell_v: f32,
    }
    topic "battery_status" every RARE;
    of |out| out.sensors.battery.map(|b| Self {
            timestamp: out.now.0,
            voltage_v: b.voltage,
            current_a: b.current,
            remaining: b.remaining,
            discharged_mah: b.drawn / 3.6,
            cell_v: b.cell,
        })
}
record! {
    /// `tether_state` and `tether_state_groundtruth`.
    TetherState {
        /// rad.
        elevation: f32,
        /// rad.
        azimuth: f32,
        /// m.
        length: f32,
        /// N.
        tension: f32,
        /// Not slack.
        taut: bool,
    }
    topic "tether_state" every SLOW;
    of |out| out.estimate.tether.map(|t| Self {
            timestamp: out.now.0,
            elevation: t.elevation,
            azimuth: t.azimuth,
            length: t.length,
            tension: t.tension,
            taut: t.is_taut,
        })
}
record! {
    /// `tether_state_groundtruth`, by the simulator: [`TetherState`] and what only the truth knows.
    TetherTruth {
        /// Of the vehicle from the anchor, rad.
        elevation: f32,
        /// Of the vehicle from the anchor, rad.
        azimuth: f32,
        /// Of the vehicle from the anchor, m.
        length: f32,
        /// At the vehicle, N.
        tension: f32,
        /// Not slack.
        taut: bool,
        /// At the ground station, N.
        tension_station: f32,
        /// Direction of the pull on the vehicle, NED; zero: nothing pulls.
        pull_x: f32,
        /// East.
        pull_y: f32,
        /// Down.
        pull_z: f32,
        /// Line between station and vehicle, unstretched, m.
        line: f32,
        /// Turns that the vehicle has put into it.
        twist: f32,
    }
}
record! {
    /// `wind_groundtruth`, by the simulator: the air's velocity at the vehicle.
    WindTruth {
        /// m/s.
        windspeed_north: f32,
        /// m/s.
        windspeed_east: f32,
        /// m/s.
        windspeed_down: f32,
    }
}
record! {
    /// `tether_sensors`: what a line's own sensors say. Zero where a sensor has not spoken.
    TetherSensors {
        /// Bit 0 vehicle's angles, 1 load cell, 2 station's load cell, 3 station's angles, 4 magnetometer, 5 second
        /// inertial sensor: it has spoken.
        present: u8,
        /// From the vehicle down the line, body FRD, unit vector.
        direction: [f32; 3],
        /// At the vehicle, N.
        tension: f32,
        /// At the station, N.
        tension_station: f32,
        /// From the station up the line, NED, unit vector.
        station_direction: [f32; 3],
        /// Body FRD, µT.
        magnetic: [f32; 3],
        /// Of the second inertial sensor, body FRD, m/s².
        second_accelerometer_m_s2: [f32; 3],
        /// Of the second inertial sensor, body FRD, rad/s.
        second_gyro_rad: [f32; 3],
    }
    topic "tether_sensors" every SLOW;
    of |out| {
        let line = &out.sensors.line;
        let says = [
            line.direction.is_some(),
            line.tension.is_some(),
            line.station_tension.is_some(),
            line.station_direction.is_some(),
            line.magnetic.is_some(),
            line.second_imu.is_some(),
        ];
        let present = says.iter().rev().fold(0, |bits, &is| bits << 1 | u8::from(is));
        let second = line.second_imu;
        (present != 0).then(|| Self {
            timestamp: out.now.0,
            present,
            direction: line.direction.map_or([0.0; 3], |v| three(&v.0)),
            tension: line.tension.unwrap_or(0.0),
            tension_station: line.station_tension.unwrap_or(0.0),
            station_direction: line.station_direction.map_or([0.0; 3], |v| three(&v.0)),
            magnetic: line.magnetic.map_or([0.0; 3], |v| three(&v.0)),
            second_accelerometer_m_s2: second.map_or([0.0; 3], |imu| three(&imu.accel.0)),
            second_gyro_rad: second.map_or([0.0; 3], |imu| three(&imu.gyro.0)),
        })
}
}
record! {
    /// `vehicle_magnetometer`: of a vehicle that has one.
    VehicleMagnetometer {
        /// Body FRD, gauss.
        magnetometer_ga: [f32; 3],
    }
    topic "vehicle_magnetometer" every SLOW;
    of |out| {
        let field = out.sensors.line.magnetic?;
        // A gauss is 100 µT.
        Some(Self { timestamp: out.now.0, magnetometer_ga: three(&field.0).map(|x| x / 100.0) })
    }
}
fn share(x: f32, whole: f32) -> f32 {
    x / whole.max(f32::MIN_POSITIVE)
}

fn thrust_share(out: &StepOutput, scale: &Scale) -> [f32; 3] {
    [0.0, 0.0, -share(out.wrench.thrust, scale.thrust)]
}

pub(super) fn three(v: &V3<f32>) -> [f32; 3] {
    [v.x, v.y, v.z]
}
