//! A board without its microcontroller: the tasks of an image, their ports and a flash whose power may go.

#![allow(clippy::unwrap_used, clippy::panic, clippy::indexing_slicing, reason = "tests")]

mod board {
    pub mod bench;
    mod power;
    mod signing;
}
