//! TautBench: an open benchmark for estimators on a tether.
//!
//! [`generate`] flies the cells of [`Grid`] and writes what an estimator may read and, apart from it, the truth.
//! [`score_folder`] compares a stranger's estimates, [`methods`] runs the firmware's own over the same recorded inputs, and
//! [`table`] puts all of them beside each other. `docs/tautbench.md` has the formats and the rules.

mod columns;
mod data;
mod errors;
mod estimates;
mod grid;
pub mod methods;
mod page;
mod record;
mod score;
mod table;

pub use columns::{TIME, Table};
pub use data::{
    About, DataSet, FlightEntry, Manifest, Settings, Unscored, generate, readings_file, sha256,
};
pub use errors::{Errors, compare};
pub use estimates::{Estimate, Estimates, columns};
pub use grid::{Cell, Grid, LeftOut, SAMPLE};
pub use page::{one, page};
pub use record::{Recorded, reading, record};
pub use score::{
    CellScore, Figure, FlightScore, Quartiles, Score, score_flight, score_folder, summarize,
};
pub use table::table;
