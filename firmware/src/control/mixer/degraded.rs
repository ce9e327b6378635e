//! Which thrusts give that wrench when a rotor is dead? The rotors that are left carry thrust, roll and pitch as evenly as
//! they can; yaw gets what room remains, and is given up first: a vehicle that turns about the vertical still flies.

use crate::model::{Rotor, Rotors};
use crate::scalar::Scalar;
use crate::signal::{MAX_ROTORS, MixerReport, PerRotor};

/// Of one rotor, for a unit of thrust, roll, pitch and yaw; torques over arm and torque ratio.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Part<S> {
    /// Thrust, roll, pitch.
    base: [S; 3],
    yaw: S,
}

/// Allocation without one rotor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Degraded<S> {
    parts: PerRotor<Part<S>>,
    dead: usize,
    /// Yaw that thrust, roll and pitch bring with them.
    lean: [S; 3],
    min: S,
    max: S,
}

/// A rotor with a smaller share of the thrust does not limit it.
const SHARE_MIN: f64 = 0.02;
/// Halvings of roll and pitch until they fit.
const HALVINGS: u8 = 4;

fn row(rotor: &Rotor) -> [f32; 3] {
    [1.0, -rotor.y, rotor.x]
}

fn dot(a: &[f32; 3], b: &[f32; 3]) -> f32 {
    let [a0, a1, a2] = a;
    let [b0, b1, b2] = b;
    a0 * b0 + a1 * b1 + a2 * b2
}

/// Inverse of a symmetric matrix of rows; `None` if it has none.
fn inverse([[a, b, c], [_, d, e], [.., f]]: [[f32; 3]; 3]) -> Option<[[f32; 3]; 3]> {
    let (m00, m01, m02) = (d * f - e * e, c * e - b * f, b * e - c * d);
    let det = a * m00 + b * m01 + c * m02;
    if det.abs() < 1e-6 {
        return None;
    }
    let (m11, m12, m22) = (a * f - c * c, b * c - a * e, a * d - b * b);
    let rows = [[m00, m01, m02], [m01, m11, m12], [m02, m12, m22]];
    Some(rows.map(|row| row.map(|x| x / det)))
}

impl<S: Scalar> Degraded<S> {
    /// `None` where the rest cannot carry thrust, roll, pitch and yaw.
    pub fn without(rotors: &Rotors, dead: usize, min: S, max: S) -> Option<Self> {
        let alive = || rotors.iter().enumerate().filter(move |(i, _)| *i != dead).map(|(_, r)| r);
        let mut gram = [[0.0_f32; 3]; 3];
        let mut spins = [0.0_f32; 3];
        for rotor in alive() {
            let b = row(rotor);
            for (line, x) in gram.iter_mut().zip(b) {
                for (sum, y) in line.iter_mut().zip(b) {
                    *sum += x * y;
                }
            }
            for (sum, x) in spins.iter_mut().zip(b) {
                *sum += x * rotor.spin;
            }
        }
        let inverse = inverse(gram)?;
        let of = |b: &[f32; 3]| inverse.map(|line| dot(&line, b));
        // Yaw alone: the spins without what of them thrust, roll and pitch make.
        let along = of(&spins);
        let turn = |rotor: &Rotor| rotor.spin - dot(&row(rotor), &along);
        let power: f32 = alive().map(|rotor| rotor.spin * turn(rotor)).sum();
        if power < 0.1 {
            return None;
        }
        let mut parts = PerRotor::all(rotors.len().min(MAX_ROTORS), Part::default());
        let mut lean = [0.0_f32; 3];
        for (i, (part, rotor)) in parts.iter_mut().zip(rotors.iter()).enumerate() {
            if i != dead {
                let base = of(&row(rotor));
                for (sum, x) in lean.iter_mut().zip(base) {
                    *sum += rotor.spin * x;
                }
                *part = Part { base: base.map(S::from_f32), yaw: S::from_f32(turn(rotor) / power) };
            }
        }
        Some(Self { parts, dead, lean: lean.map(S::from_f32), min, max })
    }

    /// Thrust, roll, pitch, yaw, N, into rotor thrusts, N.
    pub fn step(&self, [thrust, roll, pitch, yaw]: [S; 4], thrusts: &mut [S]) -> MixerReport {
        let mut report = MixerReport::default();
        let (mut roll, mut pitch) = (roll, pitch);
        let mut room = self.room(roll, pitch);
        for _ in 0..HALVINGS {
            if room.0 <= room.1 {
                break;
            }
            let half = S::lit(0.5);
            (roll, pitch) = (roll * half, pitch * half);
            room = self.room(roll, pitch);
            report.tilt_is_saturated = true;
        }
        let fitted = thrust.min(room.1).max(room.0);
        report.thrust_is_saturated = fitted != thrust;
        let [by_thrust, by_roll, by_pitch] = self.lean;
        let wanted = yaw - (by_thrust * fitted + by_roll * roll + by_pitch * pitch);
        let (mut least, mut most) = (-S::lit(1e3), S::lit(1e3));
        for part in self.alive() {
            let asked = part.of(fitted, roll, pitch);
            if part.yaw.abs() > S::lit(SHARE_MIN) {
                let (a, b) = ((self.min - asked) / part.yaw, (self.max - asked) / part.yaw);
                least = least.max(a.min(b));
                most = most.min(a.max(b));
            }
        }
        let turn = if least <= most { wanted.min(most).max(least) } else { S::zero() };
        report.yaw_is_saturated = turn != wanted;
        for (i, (slot, part)) in thrusts.iter_mut().zip(self.parts.iter()).enumerate() {
            let asked = part.of(fitted, roll, pitch) + part.yaw * turn;
            *slot = match () {
                () if i == self.dead => S::zero(),
                () if asked > self.min => asked.min(self.max),
                // Nor does one that is not a number turn a motor up.
                () => self.min,
            };
        }
        report
    }

    fn alive(&self) -> impl Iterator<Item = &Part<S>> {
        self.parts.iter().enumerate().filter(|(i, _)| *i != self.dead).map(|(_, part)| part)
    }

    /// Smallest and largest thrust with this roll and pitch, N.
    fn room(&self, roll: S, pitch: S) -> (S, S) {
        let (mut least, mut most) = (S::zero(), S::lit(1e4));
        for part in self.alive() {
            let [by_thrust, ..] = part.base;
            if by_thrust > S::lit(SHARE_MIN) {
                let tilt = part.of(S::zero(), roll, pitch);
                least = least.max((self.min - tilt) / by_thrust);
                most = most.min((self.max - tilt) / by_thrust);
            }
        }
        (least, most)
    }
}

impl<S: Scalar> Part<S> {
    fn of(&self, thrust: S, roll: S, pitch: S) -> S {
        let [by_thrust, by_roll, by_pitch] = self.base;
        by_thrust * thrust + by_roll * roll + by_pitch * pitch
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::param::Params;

    fn rotors(frame: u8) -> Rotors {
        Rotors::of(&Params { frame: f32::from(frame), ..Params::default() })
    }

    fn given(rotors: &Rotors, thrusts: &[f64]) -> [f64; 4] {
        let sum = |of: fn(&Rotor) -> f32| {
            rotors.iter().zip(thrusts).map(|(r, t)| f64::from(of(r)) * t).sum::<f64>()
        };
        [sum(|_| 1.0), sum(|r| -r.y), sum(|r| r.x), sum(|r| r.spin)]
    }

    #[test]
    fn five_of_six_and_seven_of_eight_give_thrust_roll_and_pitch_exactly() {
        for frame in 2..=6 {
            let rotors = rotors(frame);
            for dead in 0..rotors.len() {
                let degraded = Degraded::<f64>::without(&rotors, dead, 0.05, 8.1).unwrap();
                let mut thrusts = [0.0; MAX_ROTORS];
                let thrusts = &mut thrusts[..rotors.len()];
                let wanted = [20.0, 0.6, -0.4, 0.0];
                let report = degraded.step(wanted, thrusts);
                assert!(!report.tilt_is_saturated && !report.thrust_is_saturated);
                assert!(thrusts[dead] == 0.0, "the dead one");
                let got = given(&rotors, thrusts);
                for (got, wanted) in got.iter().zip(wanted).take(3) {
                    assert!((got - wanted).abs() < 1e-3, "frame {frame}, {dead}: {got} {wanted}");
                }
                let yaws = rotors.len() == 8;
                assert!(!yaws || (got[3].abs() < 1e-3 && !report.yaw_is_saturated), "{got:?}");
            }
        }
    }

    #[test]
    fn yaw_gives_way_first_and_every_thrust_stays_within_its_limits() {
        let rotors = rotors(2);
        let degraded = Degraded::<f64>::without(&rotors, 0, 0.05, 8.1).unwrap();
        for i in 0..2000_u32 {
            let x = |k: u32| f64::from((i * 7919 + k * 104_729) % 2001) / 1000.0 - 1.0;
            let mut thrusts = [0.0; 6];
            let wanted = [16.0 * (1.0 + x(1)), 20.0 * x(2), 20.0 * x(3), 10.0 * x(4)];
            let report = degraded.step(wanted, &mut thrusts);
            assert!(thrusts[1..].iter().all(|t| (0.05..=8.1).contains(t)), "{wanted:?}");
            let got = given(&rotors, &thrusts);
            if !report.tilt_is_saturated && !report.thrust_is_saturated {
                assert!((got[1] - wanted[1]).abs() < 0.1 && (got[2] - wanted[2]).abs() < 0.1);
            }
        }
        let mut thrusts = [0.0; 6];
        degraded.step([f64::NAN; 4], &mut thrusts);
        assert!(thrusts.iter().all(|t| *t <= 0.05), "{thrusts:?}");
    }

    #[test]
    fn four_rotors_cannot_do_without_one() {
        assert!((0..4).all(|i| Degraded::<f64>::without(&rotors(0), i, 0.0, 8.0).is_none()));
    }
}
