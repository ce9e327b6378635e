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

/// Table of a frame: x, y, spin of each rotor.
type Table = &'static [(f32, f32, f32)];

/// Sines of 22.5 and 67.5 degrees, of 45, of 60.
const S22: f32 = 0.382_683_43;
const S67: f32 = 0.923_879_5;
const S45: f32 = core::f32::consts::FRAC_1_SQRT_2;
const S60: f32 = 0.866_025_4;

/// By `VEH_FRAME`; outputs numbered as PX4 and ArduPilot number them. The quad X and the coaxial frame sit on the corners
/// of a square of two arms' width, the others on a circle of one arm's radius.
const FRAMES: [Table; 7] = [
    // X frame: front right, rear left, front left, rear right; the first two yaw the nose to the right.
    &[(1.0, 1.0, 1.0), (-1.0, -1.0, 1.0), (1.0, -1.0, -1.0), (-1.0, 1.0, -1.0)],
    // Plus.
    &[(0.0, 1.0, 1.0), (0.0, -1.0, 1.0), (1.0, 0.0, -1.0), (-1.0, 0.0, -1.0)],
    // Hexa X.
    &[
        (0.0, 1.0, -1.0),
        (0.0, -1.0, 1.0),
        (S60, -0.5, -1.0),
        (-S60, 0.5, 1.0),
        (S60, 0.5, 1.0),
        (-S60, -0.5, -1.0),
    ],
    // Hexa plus.
    &[
        (1.0, 0.0, -1.0),
        (-1.0, 0.0, 1.0),
        (-0.5, -S60, -1.0),
        (0.5, S60, 1.0),
        (0.5, -S60, 1.0),
        (-0.5, S60, -1.0),
    ],
    // Octo X.
    &[
        (S67, S22, -1.0),
        (-S67, -S22, -1.0),
        (S22, S67, 1.0),
        (-S67, S22, 1.0),
        (S67, -S22, 1.0),
        (-S22, -S67, 1.0),
        (S22, -S67, -1.0),
        (-S22, S67, -1.0),
    ],
    // Octo plus.
    &[
        (1.0, 0.0, -1.0),
        (-1.0, 0.0, -1.0),
        (S45, S45, 1.0),
        (-S45, S45, 1.0),
        (S45, -S45, 1.0),
        (-S45, -S45, 1.0),
        (0.0, -1.0, -1.0),
        (0.0, 1.0, -1.0),
    ],
    // Coaxial octo on an X: four above, four below that turn the other way.
    &[
        (1.0, 1.0, 1.0),
        (1.0, -1.0, -1.0),
        (-1.0, -1.0, 1.0),
        (-1.0, 1.0, -1.0),
        (1.0, -1.0, 1.0),
        (1.0, 1.0, -1.0),
        (-1.0, 1.0, 1.0),
        (-1.0, -1.0, -1.0),
    ],
];

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
    pub fn of(p: &Params) -> Self {
        Self::try_new(table(p)).unwrap_or_default()
    }
}

fn table(p: &Params) -> Table {
    let [quad, ..] = FRAMES;
    FRAMES.get(p.frame as usize).copied().unwrap_or(quad)
}

/// Thrust of all rotors together at full throttle and nominal voltage, N.
#[must_use]
pub fn thrust_max(p: &Params) -> f32 {
    table(p).len() as f32 * p.rotor_thrust_max
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_frame_is_a_table_without_coupling() {
        let counts = [4, 4, 6, 6, 8, 8, 8];
        for (frame, count) in counts.into_iter().enumerate() {
            let p = Params { frame: frame as f32, ..Params::default() };
            assert_eq!(Rotors::of(&p).len(), count, "frame {frame}");
            assert_eq!(thrust_max(&p), count as f32 * p.rotor_thrust_max);
        }
    }

    #[test]
    fn a_skewed_table_and_one_of_too_many_rotors_are_refused() {
        let [quad, ..] = FRAMES;
        assert!(Rotors::try_new(&[(1.0, 1.0, 1.0); 9]).is_none());
        let mut skewed = quad.to_vec();
        skewed[0].0 = 1.5;
        assert!(Rotors::try_new(&skewed).is_none());
        let no_yaw: std::vec::Vec<_> = quad.iter().map(|&(x, y, _)| (x, y, 0.0)).collect();
        assert!(Rotors::try_new(&no_yaw).is_none());
    }
}
