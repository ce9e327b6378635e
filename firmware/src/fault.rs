//! Why a block refuses: in flight a [`Fault`], at construction an [`Invalid`] that names the field.

use crate::scalar::Scalar;
use core::fmt;

/// Why a block refused to step. Its state is untouched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// An input is NaN or infinite.
    NotFinite,
    /// The result would be.
    Degenerate,
}

/// A setting that no block can work with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Invalid {
    /// Its name.
    pub field: &'static str,
    /// What it must be.
    pub must: &'static str,
}

impl fmt::Display for Invalid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} must be {}", self.field, self.must)
    }
}

impl core::error::Error for Invalid {}

/// `value` if it is finite and satisfies `holds`.
pub(crate) fn require<S: Scalar>(
    field: &'static str,
    must: &'static str,
    value: S,
    holds: impl Fn(S) -> bool,
) -> Result<S, Invalid> {
    if value.is_finite() && holds(value) { Ok(value) } else { Err(Invalid { field, must }) }
}

/// `value` if it is finite and greater than zero.
pub(crate) fn positive<S: Scalar>(field: &'static str, value: S) -> Result<S, Invalid> {
    require(field, "finite and greater than zero", value, |x| x > S::zero())
}

/// `value` if it is finite and not negative.
pub(crate) fn not_negative<S: Scalar>(field: &'static str, value: S) -> Result<S, Invalid> {
    require(field, "finite and not negative", value, |x| x >= S::zero())
}

/// Refuses when any of the values is NaN or infinite.
pub(crate) fn all_finite<S: Scalar>(values: &[S]) -> Result<(), Fault> {
    if values.iter().all(|x| x.is_finite()) { Ok(()) } else { Err(Fault::NotFinite) }
}
