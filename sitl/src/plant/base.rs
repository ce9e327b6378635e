//! Where the station stands: still, on a vehicle that drives a table of places, on a boat in a swell.

use super::V3;
use crate::scenario::BaseSection;
use std::f64::consts::TAU;

/// How the base moves.
#[derive(Clone, Debug)]
pub struct Motion {
    /// Time, s, and place, NED, m, in the order of the times.
    table: Vec<[f64; 4]>,
    /// Amplitude, m, and period, s: North, East, down.
    swell: [(f64, f64); 3],
    /// Amplitude, rad, and period, s: about North, East.
    rocking: [(f64, f64); 2],
}

/// Significant height of the waves of each sea state, m.
const WAVES: [f64; 7] = [0.0, 0.1, 0.5, 1.25, 2.5, 4.0, 6.0];
/// Of a sine with the same energy, per significant height; period, s, per its square root; roll and pitch of a
/// vessel of 20 to 40 m, rad per metre.
const SINE: f64 = 0.354;
const PERIOD: f64 = 4.5;
const ROLL: f64 = 0.05;
const PITCH: f64 = 0.02;

/// A swell grows from nothing over this time, s.
const GROWS: f64 = 5.0;

impl Motion {
    /// As the scenario describes it; `None`: it stands still.
    #[must_use]
    pub fn new(base: &BaseSection) -> Option<Self> {
        let waves = WAVES.get(base.sea_state as usize).copied().unwrap_or(0.0);
        let period = (PERIOD * waves.sqrt()).max(3.0);
        // What the file says itself comes first.
        let or_sea = |own: f64, own_period: f64, sea: f64| {
            if own == 0.0 && sea > 0.0 { (sea, period) } else { (own, own_period) }
        };
        let swell = [
            (base.surge, base.surge_period),
            // Across, so that it is no line that the base moves on.
            (0.5 * base.surge, 1.3 * base.surge_period),
            or_sea(base.heave, base.heave_period, SINE * waves),
        ];
        let rocking = [
            or_sea(base.roll, base.roll_period, ROLL * waves),
            or_sea(base.pitch, base.pitch_period, PITCH * waves),
        ];
        let is_still = |(amplitude, _): &(f64, f64)| *amplitude == 0.0;
        let rests =
            base.table.is_empty() && swell.iter().all(is_still) && rocking.iter().all(is_still);
        (!rests).then(|| Self { table: base.table.clone(), swell, rocking })
    }

    /// Turn about North and East, rad, and its rate, rad/s, at `time` s.
    #[must_use]
    pub fn tilt(&self, time: f64) -> (V3, V3) {
        let (mut tilt, mut turns) = (V3::zeros(), V3::zeros());
        let grown = (time / GROWS).min(1.0);
        for (i, (amplitude, period)) in self.rocking.into_iter().enumerate() {
            let rate = TAU / period;
            let (sin, cos) = (rate * time).sin_cos();
            if let (Some(angle), Some(speed)) = (tilt.get_mut(i), turns.get_mut(i)) {
                *angle = amplitude * grown * sin;
                *speed = amplitude * grown * rate * cos;
            }
        }
        (tilt, turns)
    }

    /// Place and velocity at `time` s, NED.
    #[must_use]
    pub fn at(&self, time: f64) -> (V3, V3) {
        let (mut place, mut velocity) = self.along_table(time);
        let grown = (time / GROWS).min(1.0);
        let growing = if time < GROWS { 1.0 / GROWS } else { 0.0 };
        for (i, (amplitude, period)) in self.swell.into_iter().enumerate() {
            let rate = TAU / period;
            let (sin, cos) = (rate * time).sin_cos();
            if let (Some(p), Some(v)) = (place.get_mut(i), velocity.get_mut(i)) {
                *p += amplitude * grown * sin;
                *v += amplitude * (grown * rate * cos + growing * sin);
            }
        }
        (place, velocity)
    }

    /// Smooth through the table's places; still before the first and after the last.
    fn along_table(&self, time: f64) -> (V3, V3) {
        let place = |row: &[f64; 4]| V3::new(row[1], row[2], row[3]);
        let still = |row: Option<&[f64; 4]>| (row.map_or(V3::zeros(), place), V3::zeros());
        let next = self.table.partition_point(|row| row[0] <= time);
        let row = |i: usize| self.table.get(i);
        let (Some(a), Some(b)) = (next.checked_sub(1).and_then(row), row(next)) else {
            return still(if next == 0 { self.table.first() } else { self.table.last() });
        };
        // Cubic, with the slope through the neighbours at inner places and none at the ends.
        let slope = |before: Option<&[f64; 4]>, after: Option<&[f64; 4]>| match (before, after) {
            (Some(p), Some(q)) if q[0] > p[0] => (place(q) - place(p)) / (q[0] - p[0]),
            _ => V3::zeros(),
        };
        let at_a = slope(next.checked_sub(2).and_then(row), Some(b));
        let at_b = slope(Some(a), row(next + 1));
        let span = (b[0] - a[0]).max(1e-6);
        let s = (time - a[0]) / span;
        let (pa, way) = (place(a), place(b) - place(a));
        let (ma, mb) = (at_a * span, at_b * span);
        let position = pa
            + ma * s
            + (way * 3.0 - ma * 2.0 - mb) * (s * s)
            + (ma + mb - way * 2.0) * (s * s * s);
        let velocity =
            ma + (way * 3.0 - ma * 2.0 - mb) * (2.0 * s) + (ma + mb - way * 2.0) * (3.0 * s * s);
        (position, velocity / span)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_moving_base_never_jumps_and_its_velocity_is_the_change_of_its_place() {
        let base = BaseSection {
            table: vec![[5.0, 0.0, 0.0, 0.0], [15.0, 10.0, 2.0, 0.0], [25.0, 10.0, 12.0, -1.0]],
            heave: 0.5,
            surge: 0.3,
            ..BaseSection::default()
        };
        let motion = Motion::new(&base).unwrap();
        let dt = 1e-3;
        let (mut last, _) = motion.at(0.0);
        for step in 1..40_000 {
            let time = f64::from(step) * dt;
            let (place, velocity) = motion.at(time);
            let (_, middle) = motion.at(time - 0.5 * dt);
            assert!(((place - last) / dt - middle).norm() < 2e-3, "{time}");
            assert!(velocity.norm() < 4.0);
            last = place;
        }
        let flat = BaseSection { heave: 0.0, surge: 0.0, ..base };
        let (end, rest) = Motion::new(&flat).unwrap().at(30.0);
        assert!((end - V3::new(10.0, 12.0, -1.0)).norm() < 1e-12 && rest.norm() < 1e-12);
        assert!(Motion::new(&BaseSection::default()).is_none());
    }
}
