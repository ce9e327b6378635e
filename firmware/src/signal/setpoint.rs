//! Set-points that a program streams in Offboard.

/// One of them; `None` for an axis that is not asked.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Setpoint {
    /// A place, world axes from the anchor; a velocity, fed forward or alone; a heading.
    Place {
        /// North, east, down, m.
        ned: [Option<f32>; 3],
        /// m/s; `None` where none was given at all.
        velocity: Option<[f32; 3]>,
        /// From North, rad.
        yaw: Option<f32>,
    },
    /// An attitude and a thrust.
    Attitude {
        /// Body to world, `[w, x, y, z]`, of any length but zero.
        quaternion: [f32; 4],
        /// Share of TPC_THR_MAX, 0..1.
        thrust: f32,
    },
    /// Body rates and a thrust.
    Rates {
        /// rad/s.
        rate: [f32; 3],
        /// Share of TPC_THR_MAX, 0..1.
        thrust: f32,
    },
}
