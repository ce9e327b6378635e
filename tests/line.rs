//! A line that weighs: what is sensed of it, what is said of it, what is refused for it, and flights on it.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::float_cmp,
    reason = "tests"
)]

#[path = "line/flights.rs"]
mod flights;
#[path = "line/link.rs"]
mod link;
#[path = "line/refusals.rs"]
mod refusals;
#[path = "line/sense.rs"]
mod sense;
