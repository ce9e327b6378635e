//! How does the sensor sit on the board? Sensor axes to body axes (FRD), numbered as MAVLink and PX4 number
//! sensor orientations.

/// One of MAVLink's orientations at right angles, as a matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mounting([[i32; 3]; 3]);

/// `MAV_SENSOR_ORIENTATION`, and its roll, pitch and yaw in quarter turns, applied in that order. Those of 45° are left
/// out: counts are rotated before they are converted, and fixed point has no room for halves of them.
const ORIENTATIONS: [(u8, [u8; 3]); 26] = [
    (0, [0, 0, 0]),
    (2, [0, 0, 1]),
    (4, [0, 0, 2]),
    (6, [0, 0, 3]),
    (8, [2, 0, 0]),
    (10, [2, 0, 1]),
    (12, [0, 2, 0]),
    (14, [2, 0, 3]),
    (16, [1, 0, 0]),
    (18, [1, 0, 1]),
    (20, [3, 0, 0]),
    (22, [3, 0, 1]),
    (24, [0, 1, 0]),
    (25, [0, 3, 0]),
    (26, [0, 2, 1]),
    (27, [0, 2, 3]),
    (28, [1, 1, 0]),
    (29, [2, 1, 0]),
    (30, [3, 1, 0]),
    (31, [1, 2, 0]),
    (32, [3, 2, 0]),
    (33, [1, 3, 0]),
    (34, [2, 3, 0]),
    (35, [3, 3, 0]),
    (36, [1, 2, 1]),
    (37, [1, 0, 3]),
];

/// A quarter turn about the nose, right-hand and down axis.
fn turn(axis: usize, [x, y, z]: [i32; 3]) -> [i32; 3] {
    match axis {
        0 => [x, -z, y],
        1 => [z, y, -x],
        _ => [-y, x, z],
    }
}

impl Mounting {
    /// Body = sensor.
    pub const ALIGNED: Self = Self([[1, 0, 0], [0, 1, 0], [0, 0, 1]]);

    /// From `SENS_BOARD_ROT`; `None` for an orientation that is not at right angles.
    #[must_use]
    pub fn from_parameter(value: f32) -> Option<Self> {
        let (_, turns) = ORIENTATIONS.iter().find(|(code, _)| i32::from(*code) == value as i32)?;
        let rotated = |mut unit: [i32; 3]| {
            for (axis, count) in turns.iter().enumerate() {
                for _ in 0..*count {
                    unit = turn(axis, unit);
                }
            }
            unit
        };
        let Self([x, y, z]) = Self::ALIGNED;
        let ([a, b, c], [d, e, f], [g, h, i]) = (rotated(x), rotated(y), rotated(z));
        Some(Self([[a, d, g], [b, e, h], [c, f, i]]))
    }

    /// Counts in body axes. Wider than the sensor's, since -(-32768) needs the room.
    #[must_use]
    #[inline]
    pub fn to_body(self, counts: [i16; 3]) -> [i32; 3] {
        let [x, y, z] = counts.map(i32::from);
        self.0.map(|[a, b, c]| a * x + b * y + c * z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_orientation_is_a_rotation_and_none_at_45_degrees_is_known() {
        let known = (0..=40_u8).filter(|code| Mounting::from_parameter(f32::from(*code)).is_some());
        assert_eq!(known.count(), ORIENTATIONS.len());
        for (code, _) in ORIENTATIONS {
            let m = Mounting::from_parameter(f32::from(code)).unwrap();
            let [a, b, c] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map(|axis| m.to_body(axis));
            let det = a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
                + a[2] * (b[0] * c[1] - b[1] * c[0]);
            assert_eq!(det, 1, "{m:?} mirrors");
        }
    }

    #[test]
    fn the_boards_that_fly_sit_as_they_are_wired() {
        let seen = |code: f32| Mounting::from_parameter(code).unwrap().to_body([1, 2, 3]);
        assert_eq!(seen(10.0), [2, 1, -3]);
        assert_eq!(seen(2.0), [-2, 1, 3]);
        assert_eq!(seen(4.0), [-1, -2, 3]);
        assert_eq!(seen(6.0), [2, -1, 3]);
        let lowest = Mounting::from_parameter(10.0).unwrap().to_body([0, 0, i16::MIN]);
        assert_eq!(lowest, [0, 0, 32768]);
    }
}
