//! Which scalar the firmware computes with.

use serde::{Deserialize, Serialize};

/// What the firmware computes with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Arithmetic {
    /// Single precision, as the boards with an FPU fly.
    #[default]
    F32,
    /// Double precision.
    F64,
    /// Fixed point of 16 and 16 bits, saturating, as a board without an FPU would fly.
    Q16,
}
