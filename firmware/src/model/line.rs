//! What a line's weight does: hangs on the vehicle, makes the tension grow upwards, and asks for a tension below
//! which the line lies on the ground.
//!
//! A taut line of length `d` at elevation `φ` with weight `w` per length, as a shallow curve about its chord:
//! half of `w d` hangs on each end, the tension along the chord is that of the middle, and the vehicle's is larger
//! than the station's by `w` times its height.

use super::TetherKind;
use crate::math::GRAVITY;
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::{Aid, AidSet, SphericalPoint};

/// A chord shorter than its line by less than this is not told from it, m.
const SAG_MAX: f32 = 0.03;

/// Weight per length, N/m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line<S>(pub S);

impl<S: Scalar> Line<S> {
    /// From the parameters.
    #[must_use]
    pub fn new(p: &Params) -> Self {
        Self(S::from_f32(p.line_density) * S::lit(GRAVITY))
    }

    /// What hangs on the vehicle, N, of `length` m.
    #[must_use]
    pub fn half_weight(&self, length: S) -> S {
        self.0 * length * S::lit(0.5)
    }

    /// Tension of the middle over the station's, N, with the vehicle `height` m above it; the vehicle's over the
    /// middle's as well.
    #[must_use]
    pub fn growth(&self, height: S) -> S {
        self.0 * height * S::lit(0.5)
    }
}

impl Line<f32> {
    /// Whether a load cell counts in the filter.
    #[must_use]
    pub fn has_cell(p: &Params) -> bool {
        AidSet::from_parameter(p.aids).contains(Aid::Cell)
    }

    /// Whether the chord is the line, to what a length is measured to: at the set-point, with as much out as may be.
    #[must_use]
    pub fn is_straight(p: &Params, kind: TetherKind) -> bool {
        let longest = if kind.has_winch() { p.length_max } else { p.tether_length };
        let weight = Self::new(p).0 * longest;
        let k = weight / p.tension;
        longest * k * k < 24.0 * SAG_MAX
    }

    /// By how much the tension is moved to see where the line points, N. A line that hangs in a curve swings with it, and
    /// shows nothing but that, unless a cell says how it pulls.
    #[must_use]
    pub fn dither(p: &Params, kind: TetherKind) -> f32 {
        let is_seen = Self::is_straight(p, kind) || (!kind.has_winch() && Self::has_cell(p));
        if is_seen { p.dither } else { 0.0 }
    }
}

impl<S: Scalar> Line<S> {
    /// Tension at the station, N, at which the line leaves it level: with less it lies on the ground.
    ///
    /// Of the curve about the chord: on the safe side, by a seventh at 45° and two fifths at 75°.
    #[must_use]
    pub fn least_tension(&self, place: &SphericalPoint<S>) -> S {
        let (sin, cos) = place.elevation.sin_cos();
        self.half_weight(place.length) * cos / sin.max(S::lit(0.01))
    }

    /// Tension at the station, N, with which a vehicle of `weight` N that thrusts `thrust` N holds it there; negative:
    /// it does not lift the line.
    #[must_use]
    pub fn most_tension(&self, place: &SphericalPoint<S>, weight: S, thrust: S) -> S {
        let (sin, cos) = place.elevation.sin_cos();
        let down = weight + self.half_weight(place.length);
        let across = down * cos;
        let middle = (thrust * thrust - across * across).max(S::zero()).sqrt() - down * sin;
        middle - self.growth(place.length * sin)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINE: Line<f32> = Line(0.03 * 9.81);

    fn at(elevation: f32, length: f32) -> SphericalPoint<f32> {
        SphericalPoint { elevation: elevation.to_radians(), azimuth: 0.0, length }
    }

    #[test]
    fn a_level_start_agrees_with_the_catenary() {
        // Of 45 m of chord at 45 degrees: 5.8 N exactly.
        let least = LINE.least_tension(&at(45.0, 45.0));
        assert!(least > 5.8 && least < 5.8 * 1.17, "{least}");
        // At 75 degrees: 1.05 N exactly.
        let least = LINE.least_tension(&at(75.0, 45.0));
        assert!(least > 1.05 && least < 1.05 * 1.7, "{least}");
    }

    #[test]
    fn the_most_tension_is_what_thrust_is_left_for() {
        let (place, weight, thrust) = (at(60.0, 45.0), 34.3, 100.0);
        let most = LINE.most_tension(&place, weight, thrust);
        let middle = most + LINE.growth(45.0 * 60_f32.to_radians().sin());
        let up = weight + LINE.half_weight(45.0) + middle * 60_f32.to_radians().sin();
        let side = middle * 60_f32.to_radians().cos();
        assert!((up.hypot(side) - thrust).abs() < 1e-3);
        assert!(LINE.most_tension(&at(80.0, 400.0), weight, thrust) < 0.0);
    }
}
