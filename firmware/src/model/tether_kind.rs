//! What joins vehicle and anchor.

/// Kind of the link; parameter `TET_KIND`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TetherKind {
    /// A cable of fixed length: pulls.
    Cable,
    /// A cable on a constant-tension winch: pulls.
    Winch,
    /// A strut: pushes.
    Strut,
    /// A bar: pulls and pushes.
    Bar,
    /// None: free flight under motion capture.
    Free,
}

impl TetherKind {
    /// From the parameter.
    #[must_use]
    pub fn from_parameter(value: f32) -> Self {
        match value as i32 {
            1 => Self::Winch,
            2 => Self::Strut,
            3 => Self::Bar,
            4 => Self::Free,
            _ => Self::Cable,
        }
    }

    /// Whether it pays out and in.
    #[must_use]
    pub fn has_winch(self) -> bool {
        self == Self::Winch
    }

    /// Whether it can carry this force, N, positive in tension.
    #[must_use]
    pub fn carries(self, force: f32) -> bool {
        match self {
            Self::Cable | Self::Winch => force >= 0.0,
            Self::Strut => force <= 0.0,
            Self::Bar => true,
            Self::Free => false,
        }
    }

    /// Whether there is no link at all.
    #[must_use]
    pub fn is_free(self) -> bool {
        self == Self::Free
    }

    /// Whether its length holds whatever the force.
    #[must_use]
    pub fn is_rigid(self) -> bool {
        matches!(self, Self::Strut | Self::Bar)
    }
}
