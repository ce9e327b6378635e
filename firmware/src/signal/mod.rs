//! Plain data between the stages. Missing is `None`; never NaN, never zero.

mod aid;
mod command;
mod estimate;
mod event;
mod line;
mod per_rotor;
mod radio;
mod reference;
mod request;
mod sensors;
mod setpoint;

pub use aid::{Aid, AidReport, AidSet};
pub use command::{Actuation, MixerReport, WinchCommand, Wrench};
pub use estimate::{Estimate, FilterHealth, PositionSource, TetherState};
pub use event::{Amount, EVENTS_MAX, Event, EventQueue, Severity, TEXT_MAX};
pub(crate) use line::take;
pub use line::{LineSensors, RawAngles, RawFairlead, RawLineSensors, RawMagnetometer, RawTension};
pub use per_rotor::{MAX_ROTORS, PerRotor};
pub use radio::{RADIO_CHANNELS, RawRadio};
pub use reference::{FlightReference, LoadReference, PlanarReference, SphericalPoint, TautPurpose};
pub use request::{Action, CLOSED_THROTTLE, Outcome, Reply, Request, Sticks, Ticket};
pub use sensors::*;
pub use setpoint::Setpoint;
