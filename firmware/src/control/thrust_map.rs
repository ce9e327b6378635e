//! Which throttle gives that thrust at this voltage?
//!
//! `thrust/thrust_max = (V/V_nom)² (f u² + (1-f) u)`, solved for the throttle `u`.

use crate::param::Params;
use crate::scalar::Scalar;
use crate::time::INNER_DT;

/// Of the nominal voltage: the least and most that is compensated, and how fast, 1/s.
const LEAST: f64 = 0.75;
const MOST: f64 = 1.2;
const SLEW: f64 = 0.1;

/// Curve and nominal point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThrustMap<S> {
    thrust_max: S,
    factor: S,
    /// `None`: no compensation.
    nominal_voltage: Option<S>,
}

impl<S: Scalar> ThrustMap<S> {
    /// From the parameters.
    #[must_use]
    #[inline(never)]
    pub fn new(p: &Params) -> Self {
        Self {
            thrust_max: S::from_f32(p.rotor_thrust_max),
            factor: S::from_f32(p.thrust_factor),
            nominal_voltage: (p.nominal_voltage > 1.0).then(|| S::from_f32(p.nominal_voltage)),
        }
    }

    /// The voltage to fly by, V, a millisecond after `last`: within what a pack does, and no faster than one sags. A
    /// reading that is off shall not be a step of the thrust.
    #[must_use]
    pub fn follow(&self, last: Option<S>, voltage: Option<S>) -> Option<S> {
        let (nominal, shown) = (self.nominal_voltage?, voltage?);
        let shown = shown.limit(nominal * S::lit(LEAST), nominal * S::lit(MOST));
        let last = last.unwrap_or(shown);
        let most = nominal * S::lit(SLEW * INNER_DT);
        Some(last + (shown - last).limit_abs(most))
    }

    /// Throttle, 0..1 for whatever thrust in N. An implausible voltage (below half or above 1.5 times the
    /// nominal one) counts as nominal.
    #[must_use]
    pub fn throttle(&self, thrust: S, voltage: Option<S>) -> S {
        self.throttle_of(thrust, self.full_thrust(voltage))
    }

    /// Throttles of all rotors, into their slots.
    pub fn throttles(&self, thrusts: &[S], voltage: Option<S>, throttles: &mut [S]) {
        let full = self.full_thrust(voltage);
        for (throttle, thrust) in throttles.iter_mut().zip(thrusts) {
            *throttle = self.throttle_of(*thrust, full);
        }
    }

    /// Of a rotor at full throttle, N.
    fn full_thrust(&self, voltage: Option<S>) -> S {
        let sag = match (self.nominal_voltage, voltage) {
            (Some(nominal), Some(v)) if v > nominal * S::lit(0.5) && v < nominal * S::lit(1.5) => {
                let ratio = v / nominal;
                ratio * ratio
            }
            _ => S::one(),
        };
        self.thrust_max * sag
    }

    #[inline]
    fn throttle_of(&self, thrust: S, full: S) -> S {
        let share = thrust / full;
        // Asked so, a thrust that is not a number stops the rotor.
        let y = if share > S::zero() { share.min(S::one()) } else { S::zero() };
        let linear = S::one() - self.factor;
        let root = (linear * linear + S::lit(4.0) * self.factor * y).sqrt();
        // The stable form of the quadratic's root: no division by a small factor.
        (S::lit(2.0) * y / (linear + root).max(S::lit(1e-3))).limit(S::zero(), S::one())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_throttle_inverts_the_curve_and_follows_the_voltage() {
        for factor in [0.0, 0.3, 1.0] {
            let p = Params { thrust_factor: factor, ..Params::default() };
            let map = ThrustMap::<f64>::new(&p);
            let f = f64::from(factor);
            for volts in [12.8, 15.2, 16.8] {
                for i in 1..10 {
                    let u = f64::from(i) * 0.08;
                    let sag = (volts / f64::from(p.nominal_voltage)).powi(2);
                    let thrust = f64::from(p.rotor_thrust_max) * sag * (f * u * u + (1.0 - f) * u);
                    let got = map.throttle(thrust, Some(volts));
                    assert!((got - u).abs() < 1e-6, "{factor} {volts} {u} {got}");
                }
            }
        }
        let map = ThrustMap::<f64>::new(&Params::default());
        let mut voltage = map.follow(None, Some(15.2));
        for _ in 0..1000 {
            voltage = map.follow(voltage, Some(5.0));
        }
        assert!((voltage.unwrap() - 13.68).abs() < 1e-6, "a tenth in a second");
        (0..2000).for_each(|_| voltage = map.follow(voltage, Some(5.0)));
        assert!((voltage.unwrap() - 11.4).abs() < 1e-6, "and no further than a pack goes");
        let map = ThrustMap::<f32>::new(&Params::default());
        assert_eq!(map.throttle(4.0, Some(0.3)).to_bits(), map.throttle(4.0, None).to_bits());
    }
}
