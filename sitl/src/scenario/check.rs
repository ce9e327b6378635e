//! Every number of a scenario within its range, before the first step.

use super::{Scenario, Step, set_param};
use tautline_firmware::param::Params;

impl Scenario {
    /// Every number within its range.
    pub(super) fn check(&self) -> Result<(), String> {
        let (v, t, w, s, b) =
            (&self.vehicle, &self.tether, &self.wind, &self.sensors, &self.battery);
        let (c, r) = (&self.capture, &self.rod);
        let [ix, iy, iz] = v.inertia;
        let [dx, dy, dz] = v.drag_linear;
        let ranges = [
            ("vehicle.mass", v.mass, 0.1, 50.0),
            ("vehicle.inertia[0]", ix, 1e-5, 10.0),
            ("vehicle.inertia[1]", iy, 1e-5, 10.0),
            ("vehicle.inertia[2]", iz, 1e-5, 10.0),
            ("vehicle.arm", v.arm, 0.03, 2.0),
            ("vehicle.thrust_coefficient", v.thrust_coefficient, 1e-8, 1e-2),
            ("vehicle.torque_ratio", v.torque_ratio, 1e-4, 0.5),
            ("vehicle.rotor_speed_max", v.rotor_speed_max, 50.0, 10_000.0),
            ("vehicle.nominal_voltage", v.nominal_voltage, 3.0, 60.0),
            ("vehicle.throttle_curve", v.throttle_curve, 0.3, 2.0),
            ("vehicle.rotor_time_constant", v.rotor_time_constant, 1e-3, 1.0),
            ("vehicle.common_thrust_error", v.common_thrust_error, 0.0, 0.5),
            ("vehicle.rotor_thrust_error", v.rotor_thrust_error, 0.0, 0.5),
            ("vehicle.drag_linear[0]", dx, 0.0, 10.0),
            ("vehicle.drag_linear[1]", dy, 0.0, 10.0),
            ("vehicle.drag_linear[2]", dz, 0.0, 10.0),
            ("vehicle.drag_quadratic", v.drag_quadratic, 0.0, 10.0),
            ("vehicle.rate_damping", v.rate_damping, 0.0, 1.0),
            ("vehicle.leg_height", v.leg_height, 0.02, 2.0),
            ("vehicle.heading", v.heading, -6.3, 6.3),
            ("tether.length", t.length, 1.0, 200.0),
            ("tether.stiffness", t.stiffness, 10.0, 1e7),
            ("tether.damping_ratio", t.damping_ratio, 0.0, 2.0),
            ("tether.line_density", t.line_density, 0.0, 1.0),
            ("tether.diameter", t.diameter, 0.0, 0.05),
            ("tether.attachment", t.attachment, -0.5, 0.5),
            ("tether.start_slack", t.start_slack, 0.0, 50.0),
            ("tether.start_distance", t.start_distance, 0.2, 5.0),
            ("tether.winch_lag", t.winch_lag, 1e-3, 5.0),
            ("tether.winch_error", t.winch_error, 0.0, 0.5),
            ("tether.winch_friction", t.winch_friction, 0.0, 20.0),
            ("tether.winch_ripple", t.winch_ripple, 0.0, 20.0),
            ("tether.winch_length_max", t.winch_length_max, 1.0, 500.0),
            ("capture.rate", c.rate, 0.0, 1000.0),
            ("capture.delay", c.delay, 0.0, 1.0),
            ("capture.jitter", c.jitter, 0.0, 1.0),
            ("capture.dropped", c.dropped, 0.0, 1.0),
            ("capture.position_noise", c.position_noise, 0.0, 1.0),
            ("capture.attitude_noise", c.attitude_noise, 0.0, 1.0),
            ("capture.rod_noise", c.rod_noise, 0.0, 1.0),
            ("rod.load_mass", r.load_mass, 0.0, 10.0),
            ("rod.length", r.length, 0.1, 5.0),
            ("rod.tilt", r.tilt, 0.0, 1.0),
            ("rod.azimuth", r.azimuth, -6.3, 6.3),
            ("rod.reaction", r.reaction, 0.0, 5.0),
            ("wind.speed", w.speed, 0.0, 25.0),
            ("wind.pulse", w.pulse, 0.0, 25.0),
            ("wind.from", w.from.unwrap_or(0.0), -6.3, 6.3),
            ("sensors.gyro_noise_density", s.gyro_noise_density, 0.0, 0.1),
            ("sensors.accel_noise_density", s.accel_noise_density, 0.0, 1.0),
            ("sensors.gyro_bias", s.gyro_bias, 0.0, 1.0),
            ("sensors.accel_bias", s.accel_bias, 0.0, 5.0),
            ("sensors.gyro_drift", s.gyro_drift, 0.0, 0.1),
            ("sensors.accel_drift", s.accel_drift, 0.0, 1.0),
            ("sensors.warm_up", s.warm_up, -50.0, 50.0),
            ("sensors.vibration", s.vibration, 0.0, 50.0),
            ("sensors.gyro_vibration_ratio", s.gyro_vibration_ratio, 0.0, 1.0),
            ("sensors.range_noise", s.range_noise, 0.0, 5.0),
            ("sensors.pressure_noise", s.pressure_noise, 0.0, 1000.0),
            ("sensors.pressure_drift", s.pressure_drift, 0.0, 100.0),
            ("sensors.length_noise", s.length_noise, 0.0, 5.0),
            ("battery.cells", b.cells, 1.0, 14.0),
            ("battery.capacity", b.capacity, 0.1, 1000.0),
            ("battery.resistance", b.resistance, 0.0, 1.0),
            ("battery.charge", b.charge, 0.0, 1.0),
        ];
        for (key, value, min, max) in ranges {
            within(key, value, min, max)?;
        }
        for (i, fault) in self.fault.iter().enumerate() {
            within(&format!("fault[{i}].at"), fault.at, 0.0, 1e6)?;
            within(&format!("fault[{i}].duration"), fault.duration.unwrap_or(0.0), 0.0, 1e6)?;
            within(&format!("fault[{i}].value"), fault.value, -10.0, 10.0)?;
        }
        for (i, step) in self.mission.iter().enumerate() {
            if let Step::WalkAnchor { way: [north, east], ramp, .. } = step {
                within(&format!("mission[{i}].way[0]"), *north, -1e3, 1e3)?;
                within(&format!("mission[{i}].way[1]"), *east, -1e3, 1e3)?;
                within(&format!("mission[{i}].ramp"), *ramp, 0.0, 100.0)?;
            }
            if let Step::Excite { altitude, .. } = step {
                within(&format!("mission[{i}].altitude"), *altitude, 1.0, 100.0)?;
            }
            let (key, value, min, max) = match step {
                Step::Takeoff { altitude } => ("altitude", *altitude, 0.5, 200.0),
                Step::Hold { seconds } => ("seconds", *seconds, 0.0, 1e6),
                Step::AwaitDisarmed { timeout } => ("timeout", *timeout, 0.0, 1e6),
                Step::TautMove { duration, .. } => ("duration", *duration, 0.0, 1e6),
                Step::WalkAnchor { speed, .. } => ("speed", *speed, 0.0, 10.0),
                Step::Excite { seconds, .. } => ("seconds", *seconds, 0.0, 1e6),
                Step::Arm
                | Step::Altitude
                | Step::TetherAngle
                | Step::Pendulum
                | Step::CatchRod
                | Step::Land
                | Step::TetherHold
                | Step::Taut { .. }
                | Step::Move { .. } => continue,
            };
            within(&format!("mission[{i}].{key}"), value, min, max)?;
        }
        let mut params = Params::default();
        for (name, &value) in &self.params {
            set_param(&mut params, name, value).map_err(|e| format!("params.{name}: {e}"))?;
        }
        Ok(())
    }
}

pub(crate) fn within(key: &str, value: f64, min: f64, max: f64) -> Result<(), String> {
    if value >= min && value <= max {
        Ok(())
    } else {
        Err(format!("{key} = {value} is outside {min} to {max}"))
    }
}
