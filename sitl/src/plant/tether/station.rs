//! The ground station's drum: a motor holds the line's tension within its force and speed.

use crate::scenario::TetherSection;

/// Drum and motor as the line feels them, everything at the line.
#[derive(Clone, Debug)]
pub struct WinchModel {
    /// Lag of the tension set-point, s.
    pub lag: f64,
    /// Slow relative error, uniform within ±.
    pub error: f64,
    /// Coulomb friction of the drum, N.
    pub friction: f64,
    /// Ripple amplitude, N, at 40 rad/s.
    pub ripple: f64,
    /// Longest line, m.
    pub length_max: f64,
    /// Drum with its line, gear and motor, kg.
    pub inertia: f64,
    /// Most that the motor pulls, N.
    pub force_max: f64,
    /// Fastest line, m/s.
    pub speed_max: f64,
    /// Of the integral loop over the load cell, 1/s.
    pub gain: f64,
    /// It turns at this speed, whatever it is asked: a fault, m/s.
    pub turns: Option<f64>,
}

/// What the motor does this millisecond.
#[derive(Clone, Copy, Debug)]
pub struct Drum<'a> {
    /// The winch.
    pub model: &'a WinchModel,
    /// Tension that its controller wants, N.
    pub wanted: f64,
}

/// Speed over which drum friction turns round, m/s.
const FRICTION_SPEED: f64 = 0.05;
/// Of the wanted tension, that the loop over the load cell may add.
const TRIM_SHARE: f64 = 0.1;
/// Shortest line that a drum leaves outside, m.
const SHORTEST: f64 = 0.2;

impl WinchModel {
    /// As the scenario describes it.
    #[must_use]
    pub fn new(tether: &TetherSection) -> Self {
        Self {
            lag: tether.winch_lag,
            error: tether.winch_error,
            friction: tether.winch_friction,
            ripple: tether.winch_ripple,
            length_max: tether.winch_length_max,
            inertia: tether.winch_inertia,
            force_max: tether.winch_force_max,
            speed_max: tether.winch_speed_max,
            gain: tether.winch_gain,
            turns: None,
        }
    }

    /// Friction while the line runs out at `speed` m/s, N.
    #[inline]
    #[must_use]
    pub fn friction(&self, speed: f64) -> f64 {
        let turning = speed / FRICTION_SPEED;
        self.friction * turning / (1.0 + turning * turning).sqrt()
    }
}

impl Drum<'_> {
    /// Force of the motor on the line, N, with what the loop over the load cell adds.
    #[must_use]
    pub fn pull(&self, trim: f64) -> f64 {
        (self.wanted + trim).clamp(0.0, self.model.force_max)
    }

    /// That, `dt` s after the load cell showed `measured` N: as much as friction and a share of the tension may be
    /// off. Slow, since drum and line would swing on anything faster.
    #[must_use]
    pub fn trimmed(&self, trim: f64, measured: f64, dt: f64) -> f64 {
        let most = self.model.friction + TRIM_SHARE * self.wanted;
        (trim + self.model.gain * (self.wanted - measured) * dt).clamp(-most, most)
    }

    /// Friction per speed, N s/m, for a step at whose end the friction is to hold.
    #[must_use]
    pub fn friction_per_speed(&self, speed: f64) -> f64 {
        self.model.friction / (speed * speed + FRICTION_SPEED * FRICTION_SPEED).sqrt()
    }

    /// The speed that motor and line allow with `length` m outside.
    #[must_use]
    pub fn limited(&self, speed: f64, length: f64) -> f64 {
        if let Some(turns) = self.model.turns {
            return if length <= SHORTEST { turns.max(0.0) } else { turns };
        }
        let low = if length <= SHORTEST { 0.0 } else { -self.model.speed_max };
        let high = if length >= self.model.length_max { 0.0 } else { self.model.speed_max };
        speed.clamp(low, high)
    }
}
