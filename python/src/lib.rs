//! Tautline's simulator for Python: what `tautline/_native.pyi` declares. The package around it is Python.

mod campaign;
mod input;
mod observe;
mod plant;
mod sensors;
mod sim;
mod table;
mod tautbench;
mod truth;

use pyo3::prelude::*;

#[pymodule]
mod _native {
    #[pymodule_export]
    use super::campaign::{campaign_merge, campaign_shard, campaign_size};
    #[pymodule_export]
    use super::input::{fault_kinds, parameters};
    #[pymodule_export]
    use super::plant::{Batch, Plant};
    #[pymodule_export]
    use super::sim::Sim;
    #[pymodule_export]
    use super::table::tables;
    #[pymodule_export]
    use super::tautbench::{TautBench, tautbench_summary};
}
