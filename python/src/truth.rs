//! What is so, as a dictionary.

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use tautline_sitl::flight::quaternion;
use tautline_sitl::plant::{Plant, V3};

pub fn vector<'py>(py: Python<'py>, v: &V3) -> Bound<'py, PyArray1<f64>> {
    PyArray1::from_slice(py, v.as_slice())
}

/// The physical world at `time` s.
pub fn truth<'py>(py: Python<'py>, time: f64, plant: &Plant) -> PyResult<Bound<'py, PyDict>> {
    let (body, tether, all) = (&plant.body, &plant.tether, PyDict::new(py));
    let from_anchor = plant.from_anchor();
    all.set_item("time", time)?;
    all.set_item("position", vector(py, &from_anchor))?;
    all.set_item("velocity", vector(py, &body.velocity))?;
    all.set_item("attitude", PyArray1::from_slice(py, &quaternion(&body.attitude)))?;
    all.set_item("rate", vector(py, &body.rate))?;
    all.set_item("specific_force", vector(py, &plant.specific_force))?;
    all.set_item("height", plant.height_over_ground())?;
    all.set_item("touching", plant.ground.is_touching())?;
    let [x, y, z] = from_anchor.into();
    all.set_item("elevation", (-z).atan2(x.hypot(y)))?;
    all.set_item("azimuth", y.atan2(x))?;
    all.set_item("length", tether.length())?;
    all.set_item("tension", tether.tension())?;
    all.set_item("station_tension", tether.station_tension())?;
    all.set_item("pull", vector(py, &(tether.pull() * tether.tension())))?;
    all.set_item("anchor", vector(py, &plant.anchor.position))?;
    all.set_item("wind", vector(py, &plant.wind.velocity))?;
    let speeds = plant.rotors.iter().map(|rotor| rotor.speed);
    all.set_item("rotor_speed", PyArray1::from_iter(py, speeds))?;
    all.set_item("thrust", plant.thrust())?;
    all.set_item("battery_voltage", plant.battery.voltage())?;
    all.set_item("battery_charge", plant.battery.charge)?;
    Ok(all)
}
