//! How does the sensor sit on the board? Sensor axes to body axes (FRD).

/// The right-angle mountings of the supported boards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mounting {
    /// Body = sensor.
    Aligned,
    /// Body = (y, x, -z): SpeedyBee F405 V4.
    SpeedyBeeF405V4,
    /// Body = (-y, x, z): Matek F405-TE.
    MatekF405Te,
    /// Body = (-x, -y, z): Matek H743-SLIM V3, first sensor.
    MatekH743First,
    /// Body = (y, -x, z): Matek H743-SLIM V3, second sensor.
    MatekH743Second,
}

impl Mounting {
    /// From `SENS_BOARD_ROT`, whose range the parameter table guards.
    #[must_use]
    pub fn from_parameter(value: f32) -> Self {
        match value as i32 {
            1 => Self::SpeedyBeeF405V4,
            2 => Self::MatekF405Te,
            3 => Self::MatekH743First,
            4 => Self::MatekH743Second,
            _ => Self::Aligned,
        }
    }

    /// Counts in body axes. Wider than the sensor's, since -(-32768) needs the room.
    #[must_use]
    pub fn to_body(self, [x, y, z]: [i16; 3]) -> [i32; 3] {
        let (x, y, z) = (i32::from(x), i32::from(y), i32::from(z));
        match self {
            Self::Aligned => [x, y, z],
            Self::SpeedyBeeF405V4 => [y, x, -z],
            Self::MatekF405Te => [-y, x, z],
            Self::MatekH743First => [-x, -y, z],
            Self::MatekH743Second => [y, -x, z],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_mounting_is_a_rotation() {
        for code in 0..=4_u8 {
            let m = Mounting::from_parameter(f32::from(code));
            let [a, b, c] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map(|axis| m.to_body(axis));
            let det = a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
                + a[2] * (b[0] * c[1] - b[1] * c[0]);
            assert_eq!(det, 1, "{m:?} mirrors");
        }
        assert_eq!(Mounting::SpeedyBeeF405V4.to_body([0, 0, i16::MIN]), [0, 0, 32768]);
    }
}
