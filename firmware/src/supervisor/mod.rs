//! May the vehicle do this, and what must it do when something fails? Tables and pure functions.

mod arming;
mod failsafe;
mod ground;
mod line;
mod mode;
mod rotor;

pub use arming::{ARMING_CHECKS, ArmingCheck, ArmingFacts};
pub use failsafe::{
    FAILSAFES, Failsafe, FailsafeAction, FailsafeFacts, FailsafeState, Failsafes, Failure,
};
pub use ground::{GroundContact, GroundState, TouchDown, TouchDownInput, TouchDownState};
pub use line::{LineFault, LineInput, LineWatch};
pub use mode::{Links, MODES, Mode, ModeRule, Needs, Rest};
pub use rotor::{RotorWatch, RotorWatchState};
