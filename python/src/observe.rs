//! What the firmware knows and does, as a dictionary.

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use tautline_firmware::signal::FlightReference;
use tautline_firmware::supervisor::GroundState;
use tautline_firmware::vehicle::StepOutput;

/// Numbers in double precision, as everything is in Python.
pub fn wide<'py>(
    py: Python<'py>,
    values: impl IntoIterator<Item = f32>,
) -> Bound<'py, PyArray1<f64>> {
    PyArray1::from_iter(py, values.into_iter().map(f64::from))
}

/// After the last step, at `time` s. What is not known is `None`.
pub fn observation<'py>(
    py: Python<'py>,
    time: f64,
    out: &StepOutput,
    reference: Option<FlightReference>,
) -> PyResult<Bound<'py, PyDict>> {
    let (estimate, all) = (&out.estimate, PyDict::new(py));
    all.set_item("time", time)?;
    all.set_item("mode", out.mode.rule().name)?;
    all.set_item("armed", out.is_armed)?;
    all.set_item("armable", out.is_armable)?;
    all.set_item("in_air", matches!(out.ground, GroundState::InAir | GroundState::Landing))?;
    all.set_item("attitude", wide(py, estimate.attitude.quaternion()))?;
    all.set_item("rate", wide(py, estimate.rate.0.iter().copied()))?;
    let vector = |v: Option<[f32; 3]>| v.map(|v| wide(py, v));
    all.set_item("position", vector(estimate.position.map(|p| p.0.into())))?;
    all.set_item("velocity", vector(estimate.velocity.map(|v| v.0.into())))?;
    all.set_item("height", estimate.height)?;
    all.set_item("climb", estimate.climb)?;
    let tether = estimate.tether.as_ref();
    all.set_item("elevation", tether.map(|t| t.elevation))?;
    all.set_item("azimuth", tether.map(|t| t.azimuth))?;
    all.set_item("length", tether.map(|t| t.length))?;
    all.set_item("tension", tether.map(|t| t.tension))?;
    all.set_item("taut", tether.map(|t| t.is_taut))?;
    all.set_item("reference_position", vector(reference.map(|r| r.position.0.into())))?;
    all.set_item("reference_velocity", vector(reference.map(|r| r.velocity.0.into())))?;
    all.set_item("reference_yaw", reference.map(|r| r.yaw))?;
    all.set_item("throttle", wide(py, out.actuation.throttle.iter().copied()))?;
    all.set_item("winch_tension", out.actuation.winch.tension)?;
    Ok(all)
}
