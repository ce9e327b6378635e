//! What the sensors said over some steps, for an estimator that runs at its own pace beside the firmware's.

use tautline_firmware::vehicle::StepOutput;

/// Since somebody last read; `None`: nothing came, or it is not fitted. Body axes are forward, right, down.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Readings {
    /// Mean specific force, body axes, m/s².
    pub accel: Option<[f64; 3]>,
    /// Mean angular rate, body axes, rad/s; its bias is in it.
    pub gyro: Option<[f64; 3]>,
    /// Over the anchor, m.
    pub altitude: Option<f64>,
    /// Line outside by the winch's encoder, m.
    pub length: Option<f64>,
    /// Of all rotors by the motor model, mean, N.
    pub thrust: f64,
    /// Over the ground by optical flow, body axes, m/s.
    pub velocity: Option<[f64; 3]>,
    /// From the vehicle down the line, body axes, unit vector.
    pub line_direction: Option<[f64; 3]>,
    /// By the load cell at the vehicle, N.
    pub line_tension: Option<f64>,
    /// At the station, N.
    pub station_tension: Option<f64>,
    /// From the station up the line, NED, unit vector.
    pub station_direction: Option<[f64; 3]>,
    /// Field, body axes, µT.
    pub magnetic: Option<[f64; 3]>,
    /// Asked of the winch, where there is one, N.
    pub winch_tension: f64,
    /// V.
    pub battery_voltage: Option<f64>,
}

/// Collects from step to step.
#[derive(Clone, Debug, Default)]
pub struct Gathered {
    accel: [f64; 3],
    gyro: [f64; 3],
    thrust: f64,
    inertial: u32,
    steps: u32,
    altitude: Option<f32>,
    length: Option<f32>,
    velocity: Option<[f32; 3]>,
}

fn add(sum: &mut [f64; 3], value: [f32; 3]) {
    sum.iter_mut().zip(value).for_each(|(sum, value)| *sum += f64::from(value));
}

impl Gathered {
    /// One millisecond.
    pub fn take(&mut self, out: &StepOutput) {
        let sensors = &out.sensors;
        if let Some(imu) = sensors.imu.filter(|_| !sensors.imu_is_held) {
            add(&mut self.accel, imu.value.accel.0.into());
            add(&mut self.gyro, imu.value.gyro.0.into());
            self.inertial += 1;
        }
        self.thrust += f64::from(out.estimate.thrust);
        self.steps += 1;
        self.altitude = sensors.altitude.map(|sample| sample.value).or(self.altitude);
        self.length = sensors.tether_length.map(|sample| sample.value).or(self.length);
        self.velocity = sensors.velocity.map(|sample| sample.value.0.into()).or(self.velocity);
    }

    /// Means of what comes every millisecond, the newest of the rest, after the last step; it collects anew.
    pub fn read(&mut self, out: &StepOutput) -> Readings {
        let all = std::mem::take(self);
        let mean = |sum: [f64; 3]| {
            (all.inertial > 0).then(|| sum.map(|sum| sum / f64::from(all.inertial)))
        };
        let line = &out.sensors.line;
        let wide = |v: [f32; 3]| v.map(f64::from);
        Readings {
            accel: mean(all.accel),
            gyro: mean(all.gyro),
            altitude: all.altitude.map(f64::from),
            length: all.length.map(f64::from),
            thrust: all.thrust / f64::from(all.steps.max(1)),
            velocity: all.velocity.map(wide),
            line_direction: line.direction.map(|v| wide(v.0.into())),
            line_tension: line.tension.map(f64::from),
            station_tension: line.station_tension.map(f64::from),
            station_direction: line.station_direction.map(|v| wide(v.0.into())),
            magnetic: line.magnetic.map(|v| wide(v.0.into())),
            winch_tension: f64::from(out.actuation.winch.tension),
            battery_voltage: out.sensors.battery.map(|battery| f64::from(battery.voltage)),
        }
    }
}
