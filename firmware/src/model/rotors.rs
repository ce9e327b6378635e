//! Where the rotors sit, and which way they turn.

use crate::param::Params;
use crate::signal::{MAX_ROTORS, PerRotor};

/// One rotor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rotor {
    /// Hub, in units of the arm (`VEH_ARM`): towards the nose.
    pub x: f32,
    /// To the right.
    pub y: f32,
    /// +1 if its drag yaws the nose to the right, else -1.
    pub spin: f32,
}

/// All rotors, in the order of the motor outputs.
pub type Rotors = PerRotor<Rotor>;

/// X frame: front right, rear left, front left, rear right; the first two yaw the nose to the right.
const QUAD_X: [(f32, f32, f32); 4] =
    [(1.0, 1.0, 1.0), (-1.0, -1.0, 1.0), (1.0, -1.0, -1.0), (-1.0, 1.0, -1.0)];

/// Terms that couple two axes may be so large, as a share of the rotors' number.
const COUPLING: f32 = 1e-3;

impl Rotors {
    /// A table; `None` for more rotors than [`MAX_ROTORS`], for one that leaves an axis without torque, and for one
    /// whose axes are coupled (roll with pitch, tilt with yaw, thrust with any).
    #[must_use]
    pub fn try_new(table: &[(f32, f32, f32)]) -> Option<Self> {
        if table.len() > MAX_ROTORS {
            return None;
        }
        let mut rotors = Self::all(table.len(), Rotor::default());
        for (rotor, &(x, y, spin)) in rotors.iter_mut().zip(table) {
            *rotor = Rotor { x, y, spin };
        }
        let sum = |of: fn(&Rotor) -> f32| rotors.iter().map(of).sum::<f32>();
        let coupled: [fn(&Rotor) -> f32; 6] =
            [|r| r.x, |r| r.y, |r| r.spin, |r| r.x * r.y, |r| r.x * r.spin, |r| r.y * r.spin];
        let least = COUPLING * table.len() as f32;
        let is_uncoupled = coupled.iter().all(|of| sum(*of).abs() <= least);
        let powers: [fn(&Rotor) -> f32; 3] = [|r| r.x * r.x, |r| r.y * r.y, |r| r.spin * r.spin];
        let has_torque = powers.iter().all(|of| sum(*of) > least);
        (is_uncoupled && has_torque).then_some(rotors)
    }

    /// The vehicle's.
    #[must_use]
    pub fn of(_: &Params) -> Self {
        Self::try_new(&QUAD_X).unwrap_or_default()
    }
}

/// Thrust of all rotors together at full throttle and nominal voltage, N.
#[must_use]
pub fn thrust_max(p: &Params) -> f32 {
    QUAD_X.len() as f32 * p.rotor_thrust_max
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_quad_is_a_table_and_a_skewed_one_is_refused() {
        assert_eq!(Rotors::of(&Params::default()).len(), 4);
        assert!(Rotors::try_new(&[(1.0, 1.0, 1.0); 9]).is_none());
        let mut skewed = QUAD_X;
        skewed[0].0 = 1.5;
        assert!(Rotors::try_new(&skewed).is_none());
        let no_yaw = QUAD_X.map(|(x, y, _)| (x, y, 0.0));
        assert!(Rotors::try_new(&no_yaw).is_none());
    }
}
