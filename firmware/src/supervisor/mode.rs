//! Flight modes: what each needs, its name and its MAVLink numbers. What a mode does stands in [`crate::mode`].

use crate::feature;
use crate::model::TetherKind;

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

/// What becomes of a mode on the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rest {
    /// Stays, also while disarmed.
    Stays,
    /// Goes over to Tether Hold when the motors stop.
    EndsWithMotors,
    /// It ends on the ground itself, and goes over to Tether Hold before the next flight.
    Lands,
}

/// Kinds of link that a mode flies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Links {
    /// Whatever there is.
    Any,
    /// Cable, strut or bar, without a winch.
    FixedLength,
    /// A cable without a winch.
    Cable,
    /// None: free flight.
    Free,
}

impl Links {
    /// Whether this link is one of them.
    #[must_use]
    pub fn contains(self, kind: TetherKind) -> bool {
        match self {
            Self::Any => true,
            Self::FixedLength => !kind.is_free() && !kind.has_winch(),
            Self::Cable => kind == TetherKind::Cable,
            Self::Free => kind.is_free(),
        }
    }
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
    /// MAVLink's `MAV_STANDARD_MODE`; 0 = none of the standard ones.
    pub standard_mode: u8,
    /// What it needs.
    pub needs: Needs,
    /// What becomes of it on the ground.
    pub rest: Rest,
    /// On what link it flies.
    pub on: Links,
    /// Whether the core is built with it.
    pub is_built: bool,
    /// Sticks move it, whether or not it can do without.
    pub by_sticks: bool,
    /// It leaves the ground by itself, from a known place, and may be asked for anew until it has.
    pub takes_off: bool,
    /// What the operator reads when it has done what it was asked and Tether Hold takes over; `None` for a mode that
    /// goes on.
    pub completes: Option<&'static str>,
}

impl ModeRule {
    /// PX4's `vehicle_status.nav_state`, by which its tools name and colour a flight's modes. It follows from
    /// `custom_mode`, except that Descent has a number there and none in MAVLink.
    #[must_use]
    pub const fn nav_state(&self) -> u8 {
        if matches!(self.mode, Mode::Descent) {
            return 12;
        }
        let [_, _, main, sub] = self.custom_mode.to_le_bytes();
        match (main, sub) {
            (2, _) => 1,
            (3, _) => 2,
            (4, 2) => 17,
            (4, 3) => 4,
            (4, 5) => 5,
            (4, 6) => 18,
            // External 1 to 8.
            (4, 11..=18) => sub + 12,
            (6, _) => 14,
            (7, _) => 15,
            // Manual, which none of ours is.
            _ => 0,
        }
    }
}

impl ModeRule {
    /// PX4's number of the mode in a slot of a mode switch, `COM_FLTMODE1` and the like. It follows from `custom_mode`.
    #[must_use]
    pub const fn switch_number(&self) -> i32 {
        let [_, _, main, sub] = self.custom_mode.to_le_bytes();
        match (main, sub) {
            (2, _) => 1,
            (3, _) => 2,
            (4, 2) => 10,
            (4, 3) => 4,
            (4, 5) => 5,
            (4, 6) => 11,
            // External 1 to 8.
            (4, 11..=18) => sub as i32 + 89,
            (6, _) => 7,
            (7, _) => 8,
            // Manual, which none of ours is.
            _ => 0,
        }
    }
}

const fn px4(main: u32, sub: u32) -> u32 {
    (sub << 24) | (main << 16)
}

const NOTHING: Needs = Needs { position: false, altitude: false, sticks: false, taut: false };
const STICKS: Needs = Needs { sticks: true, ..NOTHING };
const POSITION: Needs = Needs { position: true, altitude: true, taut: true, ..NOTHING };
const TAUT: Needs = Needs { taut: true, ..NOTHING };
const CAPTURE: Needs = Needs { position: true, ..NOTHING };

/// The enum, its table and the way from one to the other, of one row a mode.
macro_rules! modes {
    ($($(#[$doc:meta])+ $mode:ident: $name:literal, $number:expr, $needs:expr, $rest:ident
        $(, $field:ident = $value:expr)*;)+) => {
        /// What the vehicle does with itself.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        pub enum Mode {
            $($(#[$doc])+ $mode,)+
        }

        /// All modes.
        pub const MODES: [ModeRule; [$($name),+].len()] = [$(
            ModeRule {
                $($field: $value,)*
                ..row(Mode::$mode, $name, $number, $needs, Rest::$rest)
            },
        )+];

        impl Mode {
            /// This mode's row.
            #[must_use]
            #[allow(non_snake_case, reason = "a binding a mode")]
            pub const fn rule(self) -> &'static ModeRule {
                let [$($mode),+] = &MODES;
                match self {
                    $(Self::$mode => $mode,)+
                }
            }
        }
    };
}

const fn row(
    mode: Mode,
    name: &'static str,
    custom_mode: u32,
    needs: Needs,
    rest: Rest,
) -> ModeRule {
    ModeRule {
        mode,
        name,
        custom_mode,
        standard_mode: 0,
        needs,
        rest,
        on: Links::Any,
        is_built: true,
        by_sticks: needs.sticks,
        takes_off: false,
        completes: None,
    }
}

// The sub modes of PX4's AUTO: 2 take-off, 3 loiter, 5 return, 6 land, 11 to 15 external 1 to 5. Of MAVLink's
// standard modes: 1 position hold, 4 altitude hold, 5 safe recovery, 7 land, 8 take-off.
modes! {
    /// Sticks give roll, pitch, yaw rate and throttle.
    Stabilize: "Stabilize", px4(7, 0), STICKS, Stays;
    /// Sticks give roll, pitch, yaw rate and climb rate.
    Altitude: "Altitude", px4(2, 0), Needs { altitude: true, ..STICKS }, Stays, standard_mode = 4;
    /// Hold and move in tether coordinates.
    #[default]
    TetherHold: "Tether Hold", px4(4, 3), POSITION, Stays;
    /// Leave the ground and fly to the start of the hold.
    Takeoff: "Takeoff", px4(4, 2), POSITION, EndsWithMotors, standard_mode = 8,
        takes_off = true, completes = Some("Take-off complete, holding");
    /// Return, come down, stop the motors.
    Land: "Land", px4(4, 6), POSITION, Lands, standard_mode = 7;
    /// Level and sinking; knows nothing of position or tether.
    Descent: "Descent", px4(4, 11), NOTHING, Lands;
    /// Elevation and link force on a taut link, by inertia.
    TautForce: "Taut Force", px4(4, 12), TAUT, EndsWithMotors,
        on = Links::FixedLength, is_built = feature::TautLink::<()>::IS_BUILT;
    /// Elevation and pitch on a taut link, by inertia.
    TautAttitude: "Taut Attitude", px4(4, 13), TAUT, EndsWithMotors,
        on = Links::FixedLength, is_built = feature::TautLink::<()>::IS_BUILT;
    /// Direction of a taut tether, by inertia, under constant thrust.
    TetherAngle: "Tether Angle", px4(4, 14), TAUT, EndsWithMotors,
        on = Links::Cable, is_built = feature::TetherAngle::<()>::IS_BUILT;
    /// Balances a load on a rod, under motion capture, without a tether.
    Pendulum: "Pendulum", px4(4, 15), CAPTURE, EndsWithMotors,
        on = Links::Free, is_built = feature::Pendulum::<()>::IS_BUILT;
    /// As Land, asked for by the name that ground stations have for it.
    Return: "Return", px4(4, 5), POSITION, Lands, standard_mode = 5;
    /// Sticks give velocities.
    Position: "Position", px4(3, 0), POSITION, EndsWithMotors, standard_mode = 1, by_sticks = true,
        completes = Some("Sticks lost, holding");
    /// A program's set-points.
    Offboard: "Offboard", px4(6, 0), POSITION, EndsWithMotors,
        completes = Some("Offboard stream ended, holding");
}

impl Mode {
    /// Whether it stands on a taut link alone, without a position.
    #[must_use]
    pub const fn flies_taut(self) -> bool {
        let needs = self.rule().needs;
        needs.taut && !needs.position
    }

    /// Whether it ends on the ground.
    #[must_use]
    pub fn lands(self) -> bool {
        self.rule().rest == Rest::Lands
    }

    /// From MAVLink's `MAV_STANDARD_MODE`, for those that have a number there.
    #[must_use]
    pub fn from_standard(number: u8) -> Option<Self> {
        MODES.iter().find(|rule| number > 0 && rule.standard_mode == number).map(|rule| rule.mode)
    }

    /// From PX4's number in a slot of a mode switch.
    #[must_use]
    pub fn from_switch(number: i32) -> Option<Self> {
        MODES.iter().find(|rule| rule.switch_number() == number).map(|rule| rule.mode)
    }

    /// From MAVLink's `custom_mode`.
    #[must_use]
    pub fn from_custom_mode(custom_mode: u32) -> Option<Self> {
        MODES.iter().find(|rule| rule.custom_mode == custom_mode).map(|rule| rule.mode)
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
            assert_eq!(Mode::from_switch(rule.switch_number()), Some(rule.mode));
        }
        assert_eq!(Mode::from_custom_mode(u32::MAX), None);
        // Manual, mission, acro.
        assert_eq!([0, 3, 6].map(Mode::from_switch), [None; 3]);
    }

    #[test]
    fn every_mode_has_a_number_of_its_own_among_px4s() {
        let numbers = MODES.map(|rule| (rule.name, rule.nav_state()));
        let expected = [
            ("Stabilize", 15),
            ("Altitude", 1),
            ("Tether Hold", 4),
            ("Takeoff", 17),
            ("Land", 18),
            ("Descent", 12),
            ("Taut Force", 24),
            ("Taut Attitude", 25),
            ("Tether Angle", 26),
            ("Pendulum", 27),
            ("Return", 5),
            ("Position", 2),
            ("Offboard", 14),
        ];
        assert_eq!(numbers, expected);
    }
}
