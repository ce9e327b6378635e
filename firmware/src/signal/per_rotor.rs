//! A value for each rotor, in the order of the table of rotors.

use core::ops::{Deref, DerefMut};

/// Rotors that a vehicle may have.
pub const MAX_ROTORS: usize = 8;

/// As many values as the vehicle has rotors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PerRotor<T> {
    values: [T; MAX_ROTORS],
    count: u8,
}

impl<T: Copy + Default> PerRotor<T> {
    /// The same for each of so many, at most [`MAX_ROTORS`].
    #[must_use]
    pub fn all(count: usize, value: T) -> Self {
        Self { values: [value; MAX_ROTORS], count: count.min(MAX_ROTORS) as u8 }
    }

    /// Another value for each.
    #[must_use]
    pub fn map<U: Copy + Default>(&self, mut f: impl FnMut(T) -> U) -> PerRotor<U> {
        let mut mapped = PerRotor::all(self.len(), U::default());
        for (to, from) in mapped.iter_mut().zip(self.iter()) {
            *to = f(*from);
        }
        mapped
    }

    /// For a record of fixed size; the default beyond the last rotor.
    #[must_use]
    pub fn padded(&self) -> [T; MAX_ROTORS] {
        let mut padded = [T::default(); MAX_ROTORS];
        for (to, from) in padded.iter_mut().zip(self.iter()) {
            *to = *from;
        }
        padded
    }
}

impl<T> Deref for PerRotor<T> {
    type Target = [T];
    fn deref(&self) -> &[T] {
        self.values.get(..usize::from(self.count)).unwrap_or(&[])
    }
}

impl<T> DerefMut for PerRotor<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        self.values.get_mut(..usize::from(self.count)).unwrap_or(&mut [])
    }
}
