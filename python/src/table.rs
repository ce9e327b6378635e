//! A log's topics as rows of bytes and the places of the numbers in them: what NumPy calls a structured array.

use crate::input::wrong;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList};
use tautline_sitl::ulog::{Log, Scalar, Table};

/// NumPy's name of a type.
fn dtype(scalar: Scalar) -> &'static str {
    match scalar {
        Scalar::I8 => "<i1",
        Scalar::U8 | Scalar::Char => "<u1",
        Scalar::I16 => "<i2",
        Scalar::U16 => "<u2",
        Scalar::I32 => "<i4",
        Scalar::U32 => "<u4",
        Scalar::I64 => "<i8",
        Scalar::U64 => "<u8",
        Scalar::F32 => "<f4",
        Scalar::F64 => "<f8",
        Scalar::Bool => "?",
    }
}

/// By topic: the rows, a row's width, bytes, and name, type and offset of each column.
#[pyfunction]
pub fn tables<'py>(py: Python<'py>, log: &Bound<'py, PyBytes>) -> PyResult<Bound<'py, PyDict>> {
    let bytes = log.as_bytes();
    let tables = py
        .detach(|| Log::new(bytes).map(|mut log| tautline_sitl::ulog::tables(&mut log)))
        .map_err(wrong)?;
    let all = PyDict::new(py);
    for (topic, Table { columns, width, rows }) in tables {
        let columns =
            columns.into_iter().map(|column| (column.path, dtype(column.scalar), column.offset));
        all.set_item(topic, (PyBytes::new(py, &rows), width, PyList::new(py, columns)?))?;
    }
    Ok(all)
}
