//! Which branch is right? `planar` section 7.4.

use crate::scalar::Scalar;

/// One of the two branches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BranchIndex {
    /// Starts with a link force in tension.
    #[default]
    A,
    /// Half a turn away.
    B,
}

impl BranchIndex {
    /// The other one.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::A => Self::B,
            Self::B => Self::A,
        }
    }

    /// Of a pair.
    pub(super) fn of<T: Copy>(self, pair: &[T; 2]) -> T {
        let [a, b] = *pair;
        match self {
            Self::A => a,
            Self::B => b,
        }
    }
}

/// How residuals and priors decide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Selector<S> {
    /// The other branch must be better by this much, m/s²; zero: the smaller residual wins.
    pub hysteresis: S,
    /// The vehicle is above the anchor: decides at once where one branch is above and one below.
    pub is_above_ground: bool,
}

impl<S: Scalar> Selector<S> {
    /// Given the selected branch, both residuals, m/s², and both elevations, rad.
    #[must_use]
    pub fn select(
        &self,
        selected: BranchIndex,
        errors: &[S; 2],
        elevations: &[S; 2],
    ) -> BranchIndex {
        let [above_a, above_b] = elevations.map(|phi| phi.sin_cos().0 > S::zero());
        if self.is_above_ground && above_a != above_b {
            return if above_a { BranchIndex::A } else { BranchIndex::B };
        }
        let other = selected.other();
        if other.of(errors) + self.hysteresis < selected.of(errors) { other } else { selected }
    }
}
