//! Flight modes, what each needs, and its MAVLink number.

/// What the vehicle does with itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Sticks give roll, pitch, yaw rate and throttle.
    Stabilize,
    /// Sticks give roll, pitch, yaw rate and climb rate.
    Altitude,
    /// Hold and move in tether coordinates.
    #[default]
    TetherHold,
    /// Leave the ground and fly to the start of the hold.
    Takeoff,
    /// Return, come down, stop the motors.
    Land,
    /// Level and sinking; knows nothing of position or tether.
    Descent,
    /// Elevation and link force on a taut link, by inertia.
    TautForce,
    /// Elevation and pitch on a taut link, by inertia.
    TautAttitude,
    /// Direction of a taut tether, by inertia, under constant thrust.
    TetherAngle,
    /// Balances a load on a rod, under motion capture, without a tether.
    Pendulum,
}

/// What a mode cannot do without.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Needs {
    /// Position and tension estimate.
    pub position: bool,
    /// Altimeter.
    pub altitude: bool,
    /// Joystick.
    pub sticks: bool,
    /// A taut link.
    pub taut: bool,
}

/// One row of [`MODES`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModeRule {
    /// The mode.
    pub mode: Mode,
    /// As shown to the operator.
    pub name: &'static str,
    /// PX4's `custom_mode`: main mode in bits 16..24, sub mode in bits 24..32.
    pub custom_mode: u32,
    /// Further `custom_mode` values that select it.
    pub aliases: &'static [u32],
    /// What it needs.
    pub needs: Needs,
}

const fn px4(main: u32, sub: u32) -> u32 {
    (sub << 24) | (main << 16)
}

const NOTHING: Needs = Needs { position: false, altitude: false, sticks: false, taut: false };
const POSITION: Needs = Needs { position: true, altitude: true, taut: true, ..NOTHING };
const TAUT: Needs = Needs { taut: true, ..NOTHING };
const CAPTURE: Needs = Needs { position: true, ..NOTHING };

/// All modes. The sub modes of PX4's AUTO: 2 take-off, 3 loiter, 5 return, 6 land, 11 to 15 external 1 to 5.
pub const MODES: [ModeRule; 10] = [
    ModeRule {
        mode: Mode::Stabilize,
        name: "Stabilize",
        custom_mode: px4(7, 0),
        aliases: &[],
        needs: Needs { sticks: true, ..NOTHING },
    },
    ModeRule {
        mode: Mode::Altitude,
        name: "Altitude",
        custom_mode: px4(2, 0),
        aliases: &[],
        needs: Needs { sticks: true, altitude: true, ..NOTHING },
    },
    ModeRule {
        mode: Mode::TetherHold,
        name: "Tether Hold",
        custom_mode: px4(4, 3),
        aliases: &[px4(3, 0), px4(6, 0)],
        needs: POSITION,
    },
    ModeRule {
        mode: Mode::Takeoff,
        name: "Takeoff",
        custom_mode: px4(4, 2),
        aliases: &[],
        needs: POSITION,
    },
    ModeRule {
        mode: Mode::Land,
        name: "Land",
        custom_mode: px4(4, 6),
        aliases: &[px4(4, 5)],
        needs: POSITION,
    },
    ModeRule {
        mode: Mode::Descent,
        name: "Descent",
        custom_mode: px4(4, 11),
        aliases: &[],
        needs: NOTHING,
    },
    ModeRule {
        mode: Mode::TautForce,
        name: "Taut Force",
        custom_mode: px4(4, 12),
        aliases: &[],
        needs: TAUT,
    },
    ModeRule {
        mode: Mode::TautAttitude,
        name: "Taut Attitude",
        custom_mode: px4(4, 13),
        aliases: &[],
        needs: TAUT,
    },
    ModeRule {
        mode: Mode::TetherAngle,
        name: "Tether Angle",
        custom_mode: px4(4, 14),
        aliases: &[],
        needs: TAUT,
    },
    ModeRule {
        mode: Mode::Pendulum,
        name: "Pendulum",
        custom_mode: px4(4, 15),
        aliases: &[],
        needs: CAPTURE,
    },
];

impl Mode {
    /// This mode's row.
    #[must_use]
    pub const fn rule(self) -> &'static ModeRule {
        let [stabilize, altitude, hold, takeoff, land, descent, force, attitude, angle, pendulum] =
            &MODES;
        match self {
            Self::Stabilize => stabilize,
            Self::Altitude => altitude,
            Self::TetherHold => hold,
            Self::Takeoff => takeoff,
            Self::Land => land,
            Self::Descent => descent,
            Self::TautForce => force,
            Self::TautAttitude => attitude,
            Self::TetherAngle => angle,
            Self::Pendulum => pendulum,
        }
    }

    /// Whether it stands on a taut link alone, without a position.
    #[must_use]
    pub const fn flies_taut(self) -> bool {
        let needs = self.rule().needs;
        needs.taut && !needs.position
    }

    /// From MAVLink's `custom_mode`.
    #[must_use]
    pub fn from_custom_mode(custom_mode: u32) -> Option<Self> {
        MODES
            .iter()
            .find(|rule| rule.custom_mode == custom_mode || rule.aliases.contains(&custom_mode))
            .map(|rule| rule.mode)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_mode_finds_its_own_row_and_number() {
        for rule in &MODES {
            assert_eq!(rule.mode.rule(), rule);
            assert_eq!(Mode::from_custom_mode(rule.custom_mode), Some(rule.mode));
        }
        assert_eq!(Mode::from_custom_mode(u32::MAX), None);
    }
}
