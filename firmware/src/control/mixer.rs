//! Which rotor thrusts give that wrench? X frame: front right, rear left, front left, rear right;
//! the first two turn so that their drag yaws the nose to the right.

use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::{MixerReport, ROTORS, Wrench};

/// What gives way when a rotor is at its limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Priority {
    /// Each rotor is clipped for itself: the plain form of `fullstate` section 11.
    Clip,
    /// Roll and pitch keep their authority: yaw gives way first, then the total thrust moves, and
    /// only then do roll and pitch shrink together.
    TiltFirst,
}

/// Geometry and limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mixer<S> {
    /// Rotor distance along each body axis, m.
    pub arm: S,
    /// Drag torque per thrust, m.
    pub torque_ratio: S,
    /// Lowest thrust of a rotor, N.
    pub min: S,
    /// Highest thrust of a rotor, N.
    pub max: S,
    /// At the limit.
    pub priority: Priority,
}

/// Yaw may take this share of the mean rotor thrust.
const YAW_SHARE: f64 = 0.25;

impl<S: Scalar> Mixer<S> {
    /// From the parameters, roll and pitch first.
    #[must_use]
    #[inline(never)]
    pub fn new(p: &Params) -> Self {
        Self {
            arm: S::from_f32(p.arm),
            torque_ratio: S::from_f32(p.torque_ratio),
            min: S::from_f32(p.rotor_thrust_min),
            max: S::from_f32(p.rotor_thrust_max),
            priority: Priority::TiltFirst,
        }
    }

    /// Rotor thrusts, N, each within the limits, and what had to be cut.
    #[must_use]
    pub fn step(&self, wrench: &Wrench<S>) -> ([S; ROTORS], MixerReport) {
        let quarter = S::lit(0.25);
        let torque = &wrench.torque.0;
        let mut mean = wrench.thrust * quarter;
        let mut roll = torque.x * quarter / self.arm;
        let mut pitch = torque.y * quarter / self.arm;
        let wanted_yaw = torque.z * quarter / self.torque_ratio;
        let mut yaw = wanted_yaw.limit_abs(mean.max(S::zero()) * S::lit(YAW_SHARE));

        let mut report = MixerReport::default();
        if self.priority == Priority::TiltFirst {
            let span = self.max - self.min;
            let two = S::lit(2.0);
            let tilt = roll.abs() + pitch.abs();
            if tilt * two > span {
                let shrink = span / (tilt * two);
                roll *= shrink;
                pitch *= shrink;
                report.tilt_is_saturated = true;
            }
            let tilt = (roll.abs() + pitch.abs()).min(span / two);
            // Room that the tilt leaves, once the mean may move: half the span minus the tilt.
            yaw = yaw.limit_abs(span / two - tilt);
            // The rotor that yaw loads most beyond the tilt: the two pairs see yaw with opposite sign.
            let (diagonal, other) = ((roll - pitch).abs(), (roll + pitch).abs());
            let top = (diagonal + yaw).max(other - yaw);
            let bottom = (diagonal - yaw).max(other + yaw);
            let fitted = mean.min(self.max - top).max(self.min + bottom);
            report.thrust_is_saturated = fitted != mean;
            mean = fitted;
        }
        report.yaw_is_saturated = yaw != wanted_yaw;
        let asked = [
            mean - roll + pitch + yaw,
            mean + roll - pitch + yaw,
            mean + roll + pitch - yaw,
            mean - roll - pitch - yaw,
        ];
        let thrusts = asked.map(|thrust| thrust.limit(self.min, self.max));
        if self.priority == Priority::Clip && thrusts != asked {
            report.tilt_is_saturated = true;
            report.thrust_is_saturated = true;
        }
        (thrusts, report)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frames::{Body, V3};

    fn mixer() -> Mixer<f64> {
        Mixer::new(&Params::default())
    }

    fn wrench_of(m: &Mixer<f64>, [fr, rl, fl, rr]: [f64; 4]) -> (f64, V3<f64>) {
        let roll = m.arm * (rl + fl - fr - rr);
        let pitch = m.arm * (fr + fl - rl - rr);
        let yaw = m.torque_ratio * (fr + rl - fl - rr);
        (fr + rl + fl + rr, V3::new(roll, pitch, yaw))
    }

    #[test]
    fn a_feasible_wrench_is_given_exactly() {
        let m = mixer();
        let torque = V3::new(0.3, -0.2, 0.02);
        let (f, report) = m.step(&Wrench { thrust: 15.0, torque: Body(torque) });
        let (thrust, got) = wrench_of(&m, f);
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
            let (f, report) = m.step(&asked);
            assert!(f.iter().all(|&t| t >= m.min && t <= m.max));
            let (thrust, got) = wrench_of(&m, f);
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
}
