//! How far a quantity strays.

/// Root mean square and largest value.
#[derive(Clone, Copy, Debug, Default)]
pub struct Spread {
    sum: f64,
    count: u64,
    /// Largest magnitude.
    pub max: f64,
}

impl Spread {
    /// One more value.
    pub fn add(&mut self, value: f64) {
        self.sum += value * value;
        self.count += 1;
        self.max = self.max.max(value.abs());
    }

    /// Root mean square; `None` without values.
    #[must_use]
    pub fn rms(&self) -> Option<f64> {
        (self.count > 0).then(|| (self.sum / self.count as f64).sqrt())
    }
}
