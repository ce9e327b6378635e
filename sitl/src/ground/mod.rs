//! The ground side of MAVLink: one connection for each that speaks to the vehicle, and what only a simulator or a
//! companion computer can serve.

mod injection;
mod keys;
mod links;
mod services;
mod udp;
mod uplink;
mod winch;

pub use injection::Injection;
pub use keys::{Keys, new_key};
pub use links::{Links, Peer};
pub use services::{Files, Host};
pub use udp::{STATIONS, Udp};
pub use uplink::Uplink;
pub use winch::Winch;
