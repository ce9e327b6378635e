//! Sensors that help the full-state filter, each of which may be absent.

/// Which one; its bit in the parameter EST_AIDS is `1 << self as u8`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Aid {
    /// Direction of the line at the vehicle.
    Angles = 0,
    /// Direction of the line at the station.
    Fairlead = 1,
    /// Tension at the station, or else at the vehicle.
    Cell = 2,
    /// Heading by the earth's field.
    Compass = 3,
    /// Position by ODOMETRY and its like.
    Position = 4,
    /// Velocity by ODOMETRY.
    Velocity = 5,
}

impl Aid {
    /// In the order of their bits.
    pub const ALL: [Self; 6] =
        [Self::Angles, Self::Fairlead, Self::Cell, Self::Compass, Self::Position, Self::Velocity];

    /// What an operator reads where it contradicts the estimate.
    #[must_use]
    pub const fn contradiction(self) -> &'static str {
        match self {
            Self::Angles => "Line angles contradict: not used",
            Self::Fairlead => "Station's line direction contradicts: not used",
            Self::Cell => "Load cell contradicts: counts for little",
            Self::Compass => "Compass contradicts: not used",
            Self::Position => "External position contradicts: not used",
            Self::Velocity => "External velocity contradicts: not used",
        }
    }

    /// What an operator reads where it says nothing.
    #[must_use]
    pub const fn silence(self) -> &'static str {
        match self {
            Self::Angles => "Line angles silent: flying without",
            Self::Fairlead => "Station's line direction silent: flying without",
            Self::Cell => "Load cell silent: flying without",
            Self::Compass => "Compass silent: flying without",
            Self::Position => "External position silent: flying without",
            Self::Velocity => "External velocity silent: flying without",
        }
    }
}

/// Some of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AidSet(u8);

impl AidSet {
    /// The sum of bits that EST_AIDS is.
    #[must_use]
    pub fn from_parameter(value: f32) -> Self {
        Self(value as u8)
    }

    /// Whether it is among them.
    #[must_use]
    pub const fn contains(self, aid: Aid) -> bool {
        self.0 & (1 << aid as u8) != 0
    }

    /// Puts it in, or takes it out.
    pub fn set(&mut self, aid: Aid, is_in: bool) {
        let bit = 1 << aid as u8;
        self.0 = if is_in { self.0 | bit } else { self.0 & !bit };
    }

    /// Those that are not in another set.
    #[must_use]
    pub const fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// Whether there is none.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Each of them.
    pub fn iter(self) -> impl Iterator<Item = Aid> {
        Aid::ALL.into_iter().filter(move |aid| self.contains(*aid))
    }
}

/// Sensors that should help and do not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AidReport {
    /// They contradict the rest.
    pub rejected: AidSet,
    /// They say nothing.
    pub silent: AidSet,
}
