//! Register traffic of every driver against the fakes.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::float_cmp,
    reason = "tests"
)]

mod devices {
    mod flying;
    mod line;
    mod radio;
}
