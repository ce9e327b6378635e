//! The ground side: who may ask, peers beside each other, files, logs, the shell, the winch, and the key.

#![allow(clippy::unwrap_used, clippy::panic, clippy::indexing_slicing, reason = "tests")]

mod ground {
    mod authority;
    mod modes;
    mod peers;
    mod services;
    mod signing;
    pub mod station;
    mod winch;
}
