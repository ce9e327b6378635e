//! Elevation, pitch and link force from accelerometer and gyro alone: the high-gain observer on a
//! taut link. `planar` section 7.
//!
//! The accelerometer, with the thrust taken out, shows the link force as a vector: its direction is
//! φ+θ, its size |fL|/m, and its sign is unknown. So two branches run half a turn apart, and a residual
//! decides; priors or a fixed sign do without the second. In the coordinates `z = [φ+θ, φ', φ'']` the
//! dynamics are a chain of integrators with one non-linear term, and a linear high-gain observer
//! converges in every branch.
//!
//! **What it needs**: a taut link (or a bar), a link force well above the accelerometer's noise, and the
//! thrust that really acts. **What it cannot know**: a thrust error at rest, a steady wind (both look
//! like link force), and at a standstill which of the two branches is right.

mod canonical;
mod gain;
mod input;
mod naive;
mod observer;
mod predictor;
mod select;
mod settings;

pub use canonical::{Canonical, Drive};
pub use gain::CorrectorGain;
pub use input::{ForceReading, HighGainInput};
pub use naive::{Naive, NaiveStep};
pub use observer::{Branch, HighGain, HighGainEstimate, HighGainState};
pub use predictor::Predictor;
pub use select::{BranchIndex, Selector};
pub use settings::{Branches, Discrimination, HighGainSettings, SwitchOff, Update};
