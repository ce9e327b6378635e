//! A pilot's radio commands the vehicle: sticks, switches, who wins, and what becomes of a flight without it.

#![allow(clippy::unwrap_used, clippy::panic, clippy::indexing_slicing, reason = "tests")]

mod radio {
    mod authority;
    mod loss;
    pub mod pilot;
    mod switches;
    mod tells;
}
