//! A smooth move of elevation and link force, or elevation and pitch, and whether it can be flown.

use super::{SmoothMove, Smoothness, ThrustBranch};
use crate::model::{PlanarModel, PlanarState, TetherKind};
use crate::scalar::Scalar;
use crate::signal::{PlanarReference, TautPurpose};

/// Largest pitch of a plan, rad.
const PITCH_MAX: f64 = 1.1;
/// A link force that changes its sign must do so within this time, s: near zero it shows no direction.
const CROSSING_TIME: f64 = 2.0;

/// What a plan must keep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TautBounds<S> {
    /// Vehicle and link.
    pub model: PlanarModel<S>,
    /// What the link carries.
    pub kind: TetherKind,
    /// Lowest and highest thrust, N.
    pub thrust: (S, S),
    /// Lowest magnitude of the link force, N.
    pub force_min: S,
    /// Lowest and highest elevation, rad.
    pub elevation: (S, S),
}

/// Two smooth moves side by side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TautPlan<S> {
    purpose: TautPurpose,
    elevation: SmoothMove<S>,
    second: SmoothMove<S>,
    time: S,
}

impl<S: Scalar> TautPlan<S> {
    /// Points of a move that are checked, one after the other.
    pub const CHECKS: u8 = 33;

    /// Stay at an elevation, rad, and a link force, N, or pitch, rad.
    #[must_use]
    pub fn stay(purpose: TautPurpose, elevation: S, second: S) -> Self {
        Self {
            purpose,
            elevation: SmoothMove::stay(elevation, elevation_order(purpose)),
            second: SmoothMove::stay(second, Smoothness::C2),
            time: S::one(),
        }
    }

    /// From and to, in `duration` s; `None` for values that are no numbers or no time.
    #[must_use]
    pub fn go(
        purpose: TautPurpose,
        [from, to]: [S; 2],
        [second_from, second_to]: [S; 2],
        duration: S,
    ) -> Option<Self> {
        let order = elevation_order(purpose);
        Some(Self {
            purpose,
            elevation: SmoothMove::try_new(from, to, duration, order).ok()?,
            second: SmoothMove::try_new(second_from, second_to, duration, Smoothness::C2).ok()?,
            time: S::zero(),
        })
    }

    /// Advances by `dt` s.
    pub fn step(&mut self, dt: S) -> PlanarReference<S> {
        self.time = (self.time + dt).min(self.elevation.duration());
        self.at(self.time)
    }

    /// Where it is now.
    #[must_use]
    pub fn now(&self) -> PlanarReference<S> {
        self.at(self.time)
    }

    fn at(&self, time: S) -> PlanarReference<S> {
        PlanarReference { elevation: self.elevation.at(time), second: self.second.at(time) }
    }

    /// Whether it rests at its end.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.time >= self.elevation.duration()
    }

    /// Elevation, rad, and link force, N, or pitch, rad, where it ends.
    #[must_use]
    pub fn end(&self) -> (S, S) {
        (self.elevation.end(), self.second.end())
    }

    /// Whether vehicle and link can follow at one of [`Self::CHECKS`] points, or what they cannot: each costs as much as
    /// half a step of the vehicle, so that they are looked at one by one. The first also judges where the move ends.
    ///
    /// # Errors
    /// A reason for the operator.
    pub fn check(&self, at: u8, bounds: &TautBounds<S>) -> Result<(), &'static str> {
        if at == 0 && self.purpose == TautPurpose::Force {
            let [first] = self.second.at(S::zero());
            let last = self.second.end();
            let is_crossing = (first > S::zero()) != (last > S::zero());
            check_carried(bounds.kind, last)?;
            if last.abs() < bounds.force_min {
                return Err("Move refused: link force too small to be seen");
            }
            if is_crossing && self.elevation.duration() > S::lit(CROSSING_TIME) {
                return Err("Move refused: cross zero force within 2 s");
            }
        }
        let share = S::lit(f64::from(at)) / S::lit(f64::from(Self::CHECKS - 1));
        let point = self.at(self.elevation.duration() * share);
        let (low, high) = bounds.elevation;
        let [phi, ..] = point.elevation;
        if !(phi >= low && phi <= high) {
            return Err("Move refused: elevation out of range");
        }
        self.check_point(&point, bounds)
    }

    fn check_point(
        &self,
        point: &PlanarReference<S>,
        bounds: &TautBounds<S>,
    ) -> Result<(), &'static str> {
        let model = &bounds.model;
        let (state, thrust) = match self.purpose {
            TautPurpose::Force => model
                .flat_force(&point.elevation, &point.second, ThrustBranch::Positive)
                .map(|(flat, _)| (flat.state, flat.thrust))
                .map_err(|_| "Move refused: it needs no thrust at all")?,
            TautPurpose::Attitude => {
                let [phi, phi1, phi2, phi3, _] = point.elevation;
                model
                    .flat_attitude(&[phi, phi1, phi2, phi3], &point.second)
                    .map(|flat| (flat.state, flat.thrust))
                    .map_err(|_| "Move refused: thrust along the link")?
            }
        };
        let (min, max) = bounds.thrust;
        if thrust < min {
            return Err("Move refused: thrust below its minimum");
        }
        if thrust > max {
            return Err("Move refused: more thrust than rotors give");
        }
        if state.pitch.abs() > S::lit(PITCH_MAX) {
            return Err("Move refused: pitch out of range");
        }
        self.check_force(model, &state, thrust, bounds)
    }

    fn check_force(
        &self,
        model: &PlanarModel<S>,
        state: &PlanarState<S>,
        thrust: S,
        bounds: &TautBounds<S>,
    ) -> Result<(), &'static str> {
        let force = model.link_force(state, thrust);
        check_carried(bounds.kind, force)?;
        // A bar passes through zero; the ends of its move are checked by themselves.
        if bounds.kind != TetherKind::Bar && force.abs() < bounds.force_min {
            return Err("Move refused: link force too small to be seen");
        }
        Ok(())
    }
}

fn check_carried<S: Scalar>(kind: TetherKind, force: S) -> Result<(), &'static str> {
    match (kind.carries(force.to_f32()), force < S::zero()) {
        (true, _) => Ok(()),
        (false, true) => Err("Move refused: a cable cannot push"),
        (false, false) => Err("Move refused: a strut cannot pull"),
    }
}

fn elevation_order(purpose: TautPurpose) -> Smoothness {
    match purpose {
        TautPurpose::Force => Smoothness::C4,
        TautPurpose::Attitude => Smoothness::C3,
    }
}
