/// Of what came so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct Mean {
    sum: f64,
    count: f64,
}

impl Mean {
    /// One more.
    pub fn add(&mut self, x: f64) {
        self.sum += x;
        self.count += 1.0;
    }

    /// `None` of nothing.
    #[must_use]
    pub fn get(&self) -> Option<f64> {
        (self.count > 0.0).then(|| self.sum / self.count)
    }
}
