//! Elevation with pitch, or elevation with link force: feedback linearisation on a taut link.
//! `planar` section 6.
//!
//! [`ElevationAttitudeStatic`] (Γa), [`ElevationAttitude`] (Γa', thrust rate as input) and
//! [`ElevationForce`] (Γb, thrust acceleration as input) are pure; [`ThrustState`] integrates what they
//! ask; [`PlanarLoop`] joins one of them to the high-gain observer; [`TautController`] flies one of them in
//! three dimensions.

mod controller;
mod elevation_attitude;
mod elevation_force;
mod inversion;
mod law;
mod planar_loop;
mod thrust_state;

pub use controller::{TautController, TautControllerState};
pub use elevation_attitude::{ElevationAttitude, ElevationAttitudeStatic};
pub use elevation_force::{ElevationForce, ForceOutputs};
pub use inversion::Inversion;
pub use law::Law;
pub use planar_loop::{
    Acting, PlanarCommand, PlanarInput, PlanarLoop, PlanarLoopSettings, PlanarLoopState,
};
pub use thrust_state::{Applied, ThrustLimits, ThrustState};
