//! Load cells.

pub mod nau7802;
