//! Does the line's weight allow it? A place and a tension, before anybody flies there.

use super::Context;
use super::refusal::{Refusal, denied};
use crate::control::RadialControl;
use crate::model::Line;
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::SphericalPoint;

/// Share of the largest thrust that a set-point may use.
const THRUST_RESERVE: f32 = 0.9;

/// What is refused, in the words of who asked: each ends with the number that would do.
pub(super) struct Words {
    /// The tension is too low for the line's weight.
    pub sags: &'static str,
    /// It is more than the thrust has left; the largest follows.
    pub pulls: &'static str,
    /// No tension would do: the line is too long for its weight; a length follows.
    pub weighs: &'static str,
}

/// Of a move.
pub(super) const MOVE: Words = Words {
    sags: "Move refused: the line sags; needs",
    pulls: "Move refused: thrust leaves tension",
    weighs: "Move refused: line too heavy beyond",
};
/// Of a take-off.
pub(super) const TAKEOFF: Words = Words {
    sags: "Take-off refused: the line sags; needs",
    pulls: "Take-off refused: thrust leaves tension",
    weighs: "Take-off refused: line too heavy beyond",
};

/// Whether the vehicle can hold the line there with this tension at the station, N.
///
/// # Errors
/// The first that it cannot, with the number that would do.
pub(super) fn check<S: Scalar>(
    words: &Words,
    place: &SphericalPoint<f32>,
    tension: f32,
    cx: &Context<'_, S>,
) -> Result<(), Refusal> {
    let p = cx.params;
    if cx.config.constants.radial_control == RadialControl::Free {
        return Ok(());
    }
    let (line, weight) = (Line::<f32>::new(p), p.mass * crate::math::GRAVITY as f32);
    let thrust = THRUST_RESERVE * p.thrust_max;
    let least = line.least_tension(place);
    let most = line.most_tension(place, weight, thrust);
    if most < least {
        let length = longest(&line, place, p);
        return Err(denied(words.weighs).but_for(length, "m"));
    }
    if tension < least {
        // Rounded up, so that the number itself is accepted.
        return Err(denied(words.sags).but_for(up(least), "N"));
    }
    if tension > most {
        return Err(denied(words.pulls).but_for(-up(-most), "N"));
    }
    Ok(())
}

/// To the next tenth.
fn up(x: f32) -> f32 {
    libm::ceilf(x * 10.0) / 10.0
}

/// The longest line, m, that some tension holds in this direction.
fn longest(line: &Line<f32>, place: &SphericalPoint<f32>, p: &Params) -> f32 {
    let (weight, thrust) = (p.mass * crate::math::GRAVITY as f32, THRUST_RESERVE * p.thrust_max);
    let (mut fits, mut too_long) = (0.0_f32, place.length);
    for _ in 0..12 {
        let length = 0.5 * (fits + too_long);
        let at = SphericalPoint { length, ..*place };
        if line.most_tension(&at, weight, thrust) >= line.least_tension(&at) {
            fits = length;
        } else {
            too_long = length;
        }
    }
    libm::floorf(fits * 10.0) / 10.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::TEXT_MAX;

    #[test]
    fn every_refusal_has_room_for_its_number() {
        for words in [MOVE, TAKEOFF] {
            for text in [words.sags, words.pulls, words.weighs] {
                assert!(text.len() + " -1234.5 N".len() <= TEXT_MAX, "{text}");
            }
        }
    }

    #[test]
    fn the_longest_line_is_one_that_some_tension_holds() {
        let params = Params { line_density: 0.04, ..Params::default() };
        let line = Line::new(&params);
        let place = SphericalPoint { elevation: 0.8, azimuth: 0.0, length: 100.0 };
        let length = longest(&line, &place, &params);
        assert!(length > 5.0 && length < 60.0, "{length}");
        let (weight, thrust) = (params.mass * 9.81, THRUST_RESERVE * params.thrust_max);
        let holds = |length: f32| {
            let at = SphericalPoint { length, ..place };
            line.most_tension(&at, weight, thrust) >= line.least_tension(&at)
        };
        assert!(holds(length) && !holds(length + 0.3));
    }
}
