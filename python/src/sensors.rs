//! What the sensors said since somebody last asked, for estimators that run beside ours.

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use tautline_sitl::flight::Readings;

/// The readings at `time` s as a dictionary; `None` where nothing came.
pub fn sensors<'py>(py: Python<'py>, time: f64, read: &Readings) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    let vector = |v: Option<[f64; 3]>| v.map(|v| PyArray1::from_slice(py, &v));
    all.set_item("time", time)?;
    all.set_item("accel", vector(read.accel))?;
    all.set_item("gyro", vector(read.gyro))?;
    all.set_item("altitude", read.altitude)?;
    all.set_item("length", read.length)?;
    all.set_item("thrust", read.thrust)?;
    all.set_item("velocity", vector(read.velocity))?;
    all.set_item("line_direction", vector(read.line_direction))?;
    all.set_item("line_tension", read.line_tension)?;
    all.set_item("station_tension", read.station_tension)?;
    all.set_item("station_direction", vector(read.station_direction))?;
    all.set_item("magnetic", vector(read.magnetic))?;
    all.set_item("winch_tension", read.winch_tension)?;
    all.set_item("battery_voltage", read.battery_voltage)?;
    Ok(all)
}
