//! What one mode hands to the next.

use crate::control::{ClimbState, PositionState};
use crate::scalar::Scalar;
use crate::trajectory::Plan;

/// Set-points of the operator, and what the loops that several modes use have learnt.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Handover<S: Scalar> {
    /// Of the nose, rad from North.
    pub heading: S,
    /// Of the tether in flight, N.
    pub tension: S,
    pub plan: Plan<S>,
    pub position: PositionState<S>,
    pub climb: ClimbState<S>,
}
