//! How far may the azimuth have turned? Nothing but a sensor of the heading or of the place sees the vehicle and its gyro
//! turn about the anchor together. The filter takes itself for surer than it is: linearised anew at each step it seems to
//! see a little. So what is not seen is counted here: the gyro's drift about the vertical, integrated.

use crate::scalar::Scalar;

/// How the gyro's bias wanders, rad/s/√s, and what it may be off by after rest, rad/s.
const WALK: f64 = 3e-5;
const BIAS_SD: f64 = 5e-5;
/// How much it moves with the part's temperature, rad/s/K.
const PER_KELVIN: f64 = 5e-5;
/// Once a second: smaller steps would be lost in the digits.
const DT: f64 = 1.0;

/// Covariance of azimuth and gyro bias, beside what the filter itself says.
#[derive(Clone, Copy, Debug)]
pub(super) struct HeadingDrift<S> {
    angle: S,
    both: S,
    bias: S,
    /// °C, when the bias was taken and now.
    taken_at: S,
    warmth: S,
}

impl<S: Scalar> HeadingDrift<S> {
    /// When the bias was taken, at this temperature, °C.
    pub fn new(temperature: S) -> Self {
        let o = S::zero();
        let bias = S::lit(BIAS_SD * BIAS_SD);
        Self { angle: o, both: o, bias, taken_at: temperature, warmth: o }
    }

    /// One second on.
    pub fn step(&mut self, temperature: S) {
        let dt = S::lit(DT);
        self.angle += self.both * (dt + dt) + self.bias * dt * dt;
        self.both += self.bias * dt;
        self.bias += S::lit(WALK * WALK * DT);
        let warmth = (temperature - self.taken_at).abs();
        if warmth > self.warmth {
            let more = warmth * warmth - self.warmth * self.warmth;
            self.bias += more * S::lit(PER_KELVIN * PER_KELVIN);
            self.warmth = warmth;
        }
    }

    /// The azimuth was seen, or the heading, to `sd` rad.
    pub fn see(&mut self, sd: S) {
        let gain = S::one() / (self.angle + sd * sd);
        let (angle, both) = (self.angle, self.both);
        self.angle -= angle * angle * gain;
        self.bias = (self.bias - both * both * gain).max(S::zero());
        self.both -= angle * both * gain;
    }

    /// rad².
    pub fn variance(&self) -> S {
        self.angle.max(S::zero())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unseen_it_grows_with_the_walk_of_the_bias() {
        let mut drift = HeadingDrift::<f64>::new(25.0);
        (0..400).for_each(|_| drift.step(25.0));
        let sd = drift.variance().sqrt();
        // √(σ_b² t² + q² t³ / 3): 0.14 rad.
        let expected = ((BIAS_SD * 400.0).powi(2) + WALK * WALK * 400_f64.powi(3) / 3.0).sqrt();
        assert!((sd / expected - 1.0).abs() < 0.01, "{sd} {expected}");
        let mut cold = drift;
        (0..400).for_each(|_| cold.step(25.0));
        (0..400).for_each(|_| drift.step(35.0));
        assert!(drift.variance() > cold.variance() + 0.03, "a warmer gyro is another one");
    }

    #[test]
    fn seen_now_and_then_it_stays_within_what_is_seen() {
        let mut drift = HeadingDrift::<f32>::new(25.0);
        for _ in 0..86_400 {
            drift.step(25.0);
            drift.see(0.05);
        }
        let sd = drift.variance().sqrt();
        assert!(sd > 0.005 && sd < 0.03, "{sd}");
    }
}
