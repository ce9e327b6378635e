//! Which way does the rod of a flying inverted pendulum point, how fast does it turn, and what pushes
//! the vehicle? `pendulum` section 4.
//!
//! Measured: the rod's direction, position and velocity of the vehicle, its attitude, the thrust that was
//! applied. Not measured: the rod's rate and the disturbance.
//!
//! [`PendulumFilter`] is the article's linear time-varying Kalman filter in discrete form. Its vertical
//! disturbance is practically unobservable while the rod stands upright; [`VerticalDisturbance`] (E1)
//! takes that from the load's vertical velocity. [`PendulumObserver`] joins the two.

mod covariance;
mod filter;
mod observer;
mod vertical;

pub use covariance::PendulumCovariance;
pub use filter::{PendulumFilter, PendulumNoise, PendulumPosterior};
pub use observer::{PendulumEstimate, PendulumObserver, PendulumObserverState, PendulumReading};
pub use vertical::{VerticalDisturbance, VerticalDisturbanceState};
