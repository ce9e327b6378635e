//! What the sensors said since somebody last asked, for estimators that run beside ours.

use crate::observe::wide;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use tautline_firmware::vehicle::StepOutput;

/// Since the last question.
#[derive(Clone, Debug, Default)]
pub struct Gathered {
    accel: [f64; 3],
    gyro: [f64; 3],
    thrust: f64,
    inertial: u32,
    steps: u32,
    altitude: Option<f32>,
    length: Option<f32>,
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
    }

    /// Means of what comes every millisecond, the newest of the rest; `None` where nothing came.
    pub fn tell<'py>(
        self,
        py: Python<'py>,
        time: f64,
        out: &StepOutput,
    ) -> PyResult<Bound<'py, PyDict>> {
        let all = PyDict::new(py);
        let mean = |sum: [f64; 3]| {
            let count = f64::from(self.inertial);
            (self.inertial > 0)
                .then(|| numpy::PyArray1::from_iter(py, sum.into_iter().map(|sum| sum / count)))
        };
        all.set_item("time", time)?;
        all.set_item("accel", mean(self.accel))?;
        all.set_item("gyro", mean(self.gyro))?;
        all.set_item("altitude", self.altitude)?;
        all.set_item("length", self.length)?;
        all.set_item("thrust", self.thrust / f64::from(self.steps.max(1)))?;
        let line = &out.sensors.line;
        let vector = |v: Option<[f32; 3]>| v.map(|v| wide(py, v));
        all.set_item("line_direction", vector(line.direction.map(|v| v.0.into())))?;
        all.set_item("line_tension", line.tension)?;
        all.set_item("station_tension", line.station_tension)?;
        all.set_item("station_direction", vector(line.station_direction.map(|v| v.0.into())))?;
        all.set_item("magnetic", vector(line.magnetic.map(|v| v.0.into())))?;
        all.set_item("battery_voltage", out.sensors.battery.map(|battery| battery.voltage))?;
        Ok(all)
    }
}
