//! Time is an argument: nothing in the core reads a clock. The schedule of the loops stands here.

/// Inertial samples, rate loop and mixer per second.
pub const INNER_HZ: f32 = 1000.0;
/// Inertial samples per step of estimator, guidance, position and attitude loop.
pub const DECIMATION: u8 = 4;
/// Period of the inner loop, s.
pub const INNER_DT: f64 = 1.0 / INNER_HZ as f64;
/// Period of the outer loop, s.
pub const OUTER_DT: f64 = INNER_DT * DECIMATION as f64;

/// Microseconds since boot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Micros(pub u64);

impl Micros {
    /// Elapsed microseconds since `earlier`; zero if `earlier` lies ahead.
    #[must_use]
    pub const fn since(self, earlier: Self) -> u64 {
        self.0.saturating_sub(earlier.0)
    }
    /// Elapsed seconds since `earlier`; zero if `earlier` lies ahead.
    #[must_use]
    pub fn seconds_since(self, earlier: Self) -> f32 {
        self.since(earlier) as f32 * 1e-6
    }
    /// Milliseconds since boot, as MAVLink counts them (wraps after 49 days).
    #[must_use]
    pub const fn boot_ms(self) -> u32 {
        (self.0 / 1000) as u32
    }
}

/// A value and when it was true.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sample<T> {
    /// When the sensor measured.
    pub at: Micros,
    /// What it measured.
    pub value: T,
}
