//! The last values of something, to compare with a measurement that comes late.

/// A ring of `N` values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct History<T: Copy, const N: usize> {
    values: [T; N],
    /// Where the newest stands.
    newest: usize,
}

impl<T: Copy, const N: usize> History<T, N> {
    /// As if it had always been so.
    #[must_use]
    pub fn constant(value: T) -> Self {
        Self { values: [value; N], newest: 0 }
    }

    /// One more; the oldest is forgotten.
    pub fn push(&mut self, value: T) {
        self.newest = (self.newest + 1) % N.max(1);
        if let Some(slot) = self.values.get_mut(self.newest) {
            *slot = value;
        }
    }

    /// The value so many pushes ago; the oldest known where that is too long. `None` only for an empty ring.
    #[must_use]
    pub fn ago(&self, steps: usize) -> Option<&T> {
        let back = steps.min(N.saturating_sub(1));
        self.values.get((self.newest + N - back) % N.max(1))
    }

    /// All of them, in no order.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = &mut T> {
        self.values.iter_mut()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_remembers_as_far_back_as_it_is_long() {
        let mut history = History::<u32, 4>::constant(0);
        for x in 1..=10 {
            history.push(x);
        }
        assert_eq!(history.ago(0), Some(&10));
        assert_eq!(history.ago(3), Some(&7));
        assert_eq!(history.ago(30), Some(&7));
    }
}
