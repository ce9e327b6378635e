//! Which rotor thrusts give that wrench? Each rotor's share of roll, pitch and yaw follows from the table of rotors.

mod degraded;

use crate::model::Rotors;
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::{MixerReport, PerRotor, Wrench};
use degraded::Degraded;

/// What gives way when a rotor is at its limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Priority {
    /// Each rotor is clipped for itself: the plain form of `fullstate` section 11.
    Clip,
    /// Roll and pitch keep their authority: yaw gives way first, then the total thrust moves, and
    /// only then do roll and pitch shrink together.
    TiltFirst,
}

/// How much a rotor takes part in roll, pitch and yaw.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Part<S> {
    roll: Share<S>,
    pitch: Share<S>,
    yaw: Share<S>,
}

/// Of an axis, -1 to 1: 1 for the rotor that does most.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Share<S>(S);

impl<S: Scalar> Share<S> {
    /// A product in fixed point costs twenty signs, and most shares are whole.
    #[inline(always)]
    fn of(self, x: S) -> S {
        if S::IS_FLOATING {
            self.0 * x
        } else if self.0 == S::one() {
            x
        } else if self.0 == -S::one() {
            -x
        } else {
            self.0 * x
        }
    }
}

/// Geometry and limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mixer<S> {
    parts: PerRotor<Part<S>>,
    /// Of the rotor that does most, per unit of the whole: thrust, roll, pitch, yaw.
    shares: [S; 4],
    /// Unit of the table of rotors, m.
    pub arm: S,
    /// Drag torque per thrust, m.
    pub torque_ratio: S,
    /// Lowest thrust of a rotor, N.
    pub min: S,
    /// Highest thrust of a rotor, N.
    pub max: S,
    /// At the limit.
    pub priority: Priority,
    /// A rotor is dead.
    degraded: Option<Degraded<S>>,
}

/// Yaw may take this share of the mean rotor thrust.
const YAW_SHARE: f64 = 0.25;

impl<S: Scalar> Mixer<S> {
    /// From the parameters, roll and pitch first.
    #[must_use]
    #[inline(never)]
    pub fn new(p: &Params) -> Self {
        Self::for_rotors(&Rotors::of(p), p)
    }

    /// For another table of rotors.
    #[must_use]
    pub fn for_rotors(rotors: &Rotors, p: &Params) -> Self {
        // The axes are uncoupled, so the least-squares allocation is a rotor's lever over the sum of squares.
        let most = |of: fn(&crate::model::Rotor) -> f32| {
            rotors.iter().map(of).fold(0.0_f32, |most, x| most.max(x.abs())).max(f32::MIN_POSITIVE)
        };
        let (x, y, spin) = (most(|r| r.x), most(|r| r.y), most(|r| r.spin));
        let squares = |of: fn(&crate::model::Rotor) -> f32| rotors.iter().map(of).sum::<f32>();
        let share = |most: f32, sum: f32| S::from_f32(most / sum.max(f32::MIN_POSITIVE));
        Self {
            parts: rotors.map(|r| Part {
                roll: Share(S::from_f32(-r.y / y)),
                pitch: Share(S::from_f32(r.x / x)),
                yaw: Share(S::from_f32(r.spin / spin)),
            }),
            shares: [
                S::from_f32(1.0 / rotors.len().max(1) as f32),
                share(y, squares(|r| r.y * r.y)),
                share(x, squares(|r| r.x * r.x)),
                share(spin, squares(|r| r.spin * r.spin)),
            ],
            arm: S::from_f32(p.arm),
            torque_ratio: S::from_f32(p.torque_ratio),
            min: S::from_f32(p.rotor_thrust_min),
            max: S::from_f32(p.rotor_thrust_max),
            priority: Priority::TiltFirst,
            degraded: None,
        }
    }

    /// A rotor is dead, the others do its work; false: they cannot, nothing changes.
    #[must_use]
    pub fn lose(&mut self, rotor: usize, p: &Params) -> bool {
        let degraded = Degraded::without(&Rotors::of(p), rotor, self.min, self.max);
        self.degraded = degraded.or(self.degraded);
        degraded.is_some()
    }

    /// The same value for each rotor.
    #[must_use]
    pub fn each(&self, value: S) -> PerRotor<S> {
        PerRotor::all(self.parts.len(), value)
    }

    /// Rotor thrusts, N, each within the limits, into their slots; and what had to be cut.
    pub fn step(&self, wrench: &Wrench<S>, thrusts: &mut [S]) -> MixerReport {
        let torque = &wrench.torque.0;
        if let Some(degraded) = &self.degraded {
            let wanted = [
                wrench.thrust,
                torque.x / self.arm,
                torque.y / self.arm,
                torque.z / self.torque_ratio,
            ];
            return degraded.step(wanted, thrusts);
        }
        let [thrust_share, roll_share, pitch_share, yaw_share] = self.shares;
        let mut mean = wrench.thrust * thrust_share;
        let mut roll = torque.x * roll_share / self.arm;
        let mut pitch = torque.y * pitch_share / self.arm;
        let wanted_yaw = torque.z * yaw_share / self.torque_ratio;
        let mut yaw = wanted_yaw.limit_abs(mean.max(S::zero()) * S::lit(YAW_SHARE));

        let mut report = MixerReport::default();
        let load = self.ask(mean, [roll, pitch, yaw], thrusts);
        let span = self.max - self.min;
        let two = S::lit(2.0);
        let mut tilt = load.tilt;
        // The usual case: every rotor can give what it is asked, with room for yaw.
        let fits = tilt * two <= span && yaw.abs() <= span / two - tilt && load.fits;
        if fits {
            report.yaw_is_saturated = yaw != wanted_yaw;
            return report;
        }
        if self.priority == Priority::TiltFirst {
            if tilt * two > span {
                let shrink = span / (tilt * two);
                roll *= shrink;
                pitch *= shrink;
                tilt = self.ask(mean, [roll, pitch, yaw], thrusts).tilt.min(span / two);
                report.tilt_is_saturated = true;
            }
            // Room that the tilt leaves, once the mean may move: half the span minus the tilt.
            yaw = yaw.limit_abs(span / two - tilt);
            // The rotors that roll, pitch and yaw together load most and least.
            let (mut top, mut bottom) = (S::zero(), S::zero());
            for part in self.parts.iter() {
                let more = part.roll.of(roll) + part.pitch.of(pitch) + part.yaw.of(yaw);
                top = top.max(more);
                bottom = bottom.max(-more);
            }
            let fitted = mean.min(self.max - top).max(self.min + bottom);
            report.thrust_is_saturated = fitted != mean;
            mean = fitted;
        }
        report.yaw_is_saturated = yaw != wanted_yaw;
        let load = self.ask(mean, [roll, pitch, yaw], thrusts);
        if self.priority == Priority::Clip && !load.fits {
            report.tilt_is_saturated = true;
            report.thrust_is_saturated = true;
        }
        // Asked so, a wrench that is not a number gives the lowest thrusts.
        for thrust in thrusts.iter_mut() {
            *thrust = if *thrust > self.min { thrust.min(self.max) } else { self.min };
        }
        report
    }

    /// What mean, roll, pitch and yaw ask of each rotor, N, into its slot.
    fn ask(&self, mean: S, [roll, pitch, yaw]: [S; 3], thrusts: &mut [S]) -> Load<S> {
        let mut load = Load { tilt: S::zero(), fits: true };
        for (thrust, part) in thrusts.iter_mut().zip(self.parts.iter()) {
            let (roll, pitch) = (part.roll.of(roll), part.pitch.of(pitch));
            let asked = mean + roll + pitch + part.yaw.of(yaw);
            load.tilt = load.tilt.max((roll + pitch).abs());
            load.fits &= asked >= self.min && asked <= self.max;
            *thrust = asked;
        }
        load
    }
}

/// Of all rotors, N.
struct Load<S> {
    /// The most that roll and pitch together ask of one.
    tilt: S,
    /// Each is within its limits.
    fits: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frames::{Body, V3};

    fn mixer() -> Mixer<f64> {
        Mixer::new(&Params::default())
    }

    fn mix(m: &Mixer<f64>, wrench: &Wrench<f64>) -> (PerRotor<f64>, MixerReport) {
        let mut thrusts = m.each(0.0);
        let report = m.step(wrench, &mut thrusts);
        (thrusts, report)
    }

    fn wrench_of(m: &Mixer<f64>, thrusts: &[f64]) -> (f64, V3<f64>) {
        let &[fr, rl, fl, rr] = thrusts else { panic!("{thrusts:?}") };
        let roll = m.arm * (rl + fl - fr - rr);
        let pitch = m.arm * (fr + fl - rl - rr);
        let yaw = m.torque_ratio * (fr + rl - fl - rr);
        (fr + rl + fl + rr, V3::new(roll, pitch, yaw))
    }

    #[test]
    fn a_feasible_wrench_is_given_exactly() {
        let m = mixer();
        let torque = V3::new(0.3, -0.2, 0.02);
        let (f, report) = mix(&m, &Wrench { thrust: 15.0, torque: Body(torque) });
        let (thrust, got) = wrench_of(&m, &f);
        assert!((thrust - 15.0).abs() < 1e-9 && (got - torque).norm() < 1e-9);
        assert_eq!(report, MixerReport::default());
    }

    #[test]
    fn roll_and_pitch_are_exact_whenever_the_rotors_can_give_them() {
        let m = mixer();
        for i in 0..4000_u32 {
            let x = |k: u32| f64::from((i * 7919 + k * 104_729) % 2001) / 1000.0 - 1.0;
            let (roll, pitch) = (x(1) * 3.0, x(2) * 3.0);
            let asked =
                Wrench { thrust: 16.0 * (1.0 + x(3)), torque: Body(V3::new(roll, pitch, x(4))) };
            let (f, report) = mix(&m, &asked);
            assert!(f.iter().all(|&t| t >= m.min && t <= m.max));
            let (thrust, got) = wrench_of(&m, &f);
            if report.tilt_is_saturated {
                assert!(
                    (got.x * pitch - got.y * roll).abs() < 1e-6,
                    "the direction of the tilt changed"
                );
            } else {
                assert!(
                    (got.x - roll).abs() < 1e-9 && (got.y - pitch).abs() < 1e-9,
                    "{asked:?} {f:?}"
                );
            }
            if !report.thrust_is_saturated {
                assert!((thrust - asked.thrust).abs() < 1e-9);
            }
        }
    }

    /// Six on a circle, the first in front and to the right, turning by turns.
    fn hexa() -> Rotors {
        let rotor = |i: u8| {
            let (sin, cos) = (f64::from(i) * 60.0 + 30.0).to_radians().sin_cos();
            (cos as f32, sin as f32, if i.is_multiple_of(2) { 1.0 } else { -1.0 })
        };
        Rotors::try_new(&[0, 1, 2, 3, 4, 5].map(rotor)).unwrap()
    }

    #[test]
    fn six_rotors_give_a_feasible_wrench_as_four_do() {
        let rotors = hexa();
        let m = Mixer::<f64>::for_rotors(&rotors, &Params::default());
        let torque = V3::new(0.4, -0.3, 0.05);
        let (f, report) = mix(&m, &Wrench { thrust: 20.0, torque: Body(torque) });
        assert_eq!((f.len(), report), (6, MixerReport::default()));
        let sum = |of: fn(f64, f64, f64) -> f64| {
            let each = rotors.iter().zip(f.iter());
            let wide = |x: f32| f64::from(x);
            each.map(|(r, t)| of(wide(r.x), wide(r.y), wide(r.spin)) * t).sum::<f64>()
        };
        assert!((sum(|_, _, _| 1.0) - 20.0).abs() < 1e-6);
        assert!((-m.arm * sum(|_, y, _| y) - torque.x).abs() < 1e-6);
        assert!((m.arm * sum(|x, _, _| x) - torque.y).abs() < 1e-6);
        assert!((m.torque_ratio * sum(|_, _, s| s) - torque.z).abs() < 1e-6);
    }
}
