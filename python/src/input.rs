//! Scenarios and parameters as Python gives them: a file, a text, a mapping. What is wrong with one is a `ValueError` of
//! the library's one line.

use pyo3::exceptions::{PyTypeError, PyUserWarning, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use pythonize::{depythonize, pythonize};
use std::ffi::CString;
use std::path::{Path, PathBuf};
use tautline_firmware::param::{META, Params};
use tautline_sitl::scenario::{FAULTS, Scenario, Step, params_file, set_param};

/// The library's line as Python's error.
pub fn wrong(line: impl ToString) -> PyErr {
    PyValueError::new_err(line.to_string().replace('\n', " "))
}

/// A path cannot hold a line's end, and no file of ours an equals sign: everything else is a name.
fn is_text(text: &str) -> bool {
    text.trim().is_empty() || text.contains(['\n', '=', '['])
}

/// A TOML file's path, TOML text, or a mapping of the same keys.
pub fn scenario(source: &Bound<PyAny>) -> PyResult<Scenario> {
    if source.is_instance_of::<PyDict>() {
        let table: toml::Table =
            depythonize(source).map_err(|e| wrong(format!("scenario: {e}")))?;
        let text = toml::to_string(&table).map_err(|e| wrong(format!("scenario: {e}")))?;
        return Scenario::parse(&text, "scenario").map_err(wrong);
    }
    if let Ok(text) = source.extract::<String>() {
        return match is_text(&text) {
            true => Scenario::parse(&text, "scenario").map_err(wrong),
            false => Scenario::load(Path::new(&text)).map_err(wrong),
        };
    }
    match source.extract::<PathBuf>() {
        Ok(path) => Scenario::load(&path).map_err(wrong),
        Err(_) => Err(PyTypeError::new_err("scenario: a path, TOML text or a dict is expected")),
    }
}

/// The scenario's parameters and then `source`'s: a mapping of names to values or a parameter file.
pub fn params(scenario: &Scenario, source: Option<&Bound<PyAny>>) -> PyResult<Params> {
    let mut params = scenario.params().map_err(wrong)?;
    let Some(source) = source else { return Ok(params) };
    if let Ok(values) = source.cast::<PyDict>() {
        for (name, value) in values {
            let name: String = name.extract()?;
            let value: f64 =
                value.extract().map_err(|_| wrong(format!("{name} is not a number")))?;
            set_param(&mut params, &name, value as f32).map_err(wrong)?;
        }
    } else {
        let path: PathBuf = source
            .extract()
            .map_err(|_| PyTypeError::new_err("params: a dict or a parameter file is expected"))?;
        warn(source.py(), params_file::load(&mut params, &path).map_err(wrong)?)?;
    }
    warn(source.py(), scenario.contradictions(&params).map_err(wrong)?)?;
    Ok(params)
}

fn warn(py: Python, lines: Vec<String>) -> PyResult<()> {
    let kind = py.get_type::<PyUserWarning>();
    for line in lines {
        PyErr::warn(py, &kind, &CString::new(line)?, 3)?;
    }
    Ok(())
}

/// A step of a mission as the scenario file spells it.
pub fn step(source: &Bound<PyAny>) -> PyResult<Step> {
    // As a file's: its numbers are checked with it.
    let file = PyDict::new(source.py());
    file.set_item("mission", [source])?;
    let scenario = scenario(&file)?;
    scenario.mission.into_iter().next().ok_or_else(|| wrong("mission: no step"))
}

/// Name, unit and meaning of every kind of fault.
#[pyfunction]
pub fn fault_kinds(py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
    let kinds: Vec<_> = FAULTS.iter().map(|rule| (rule.name, rule.unit, rule.doc.trim())).collect();
    Ok(pythonize(py, &kinds)?)
}

/// All parameters of a scenario by name, after `params`.
#[pyfunction]
#[pyo3(name = "parameters", signature = (scenario, params = None))]
pub fn parameters<'py>(
    scenario: &Bound<'py, PyAny>,
    params: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let values = self::params(&self::scenario(scenario)?, params)?;
    let all = PyDict::new(scenario.py());
    for (index, meta) in META.iter().enumerate() {
        all.set_item(meta.name, values.get(index))?;
    }
    Ok(all)
}
