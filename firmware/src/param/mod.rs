//! Where is a setting declared? Once, in `tree.rs`.
//!
//! The table there yields the struct [`Params`], its default, the checked [`Params::set`] and
//! [`META`], from which MAVLink's parameter service, the parameter files and `docs/parameters.md`
//! follow. Names are written out, so that `grep RATE_P` finds the line. A name longer than 16 bytes
//! or a default out of range does not compile.

mod alias;
mod combination;
mod fence;
mod radio;
mod tree;

pub use alias::{ALIASES, Alias};
pub use combination::{COMBINATIONS, Combination, broken};
pub use tree::{DOCS, Group, META, Params};

/// How a value travels and is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A real number.
    Real,
    /// A whole number, MAVLink INT32.
    Int,
}

/// What is known of one parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meta {
    /// MAVLink name, at most 16 bytes.
    pub name: &'static str,
    /// What it belongs to.
    pub group: Group,
    /// Real or whole.
    pub kind: Kind,
    /// Value at first start.
    pub default: f32,
    /// Smallest value accepted.
    pub min: f32,
    /// Largest value accepted.
    pub max: f32,
}

/// What a reader wants to know of a parameter and a board does not: texts that no image shall carry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Doc {
    /// Unit, SI unless it says so; empty for a pure number.
    pub unit: &'static str,
    /// What it does.
    pub text: &'static str,
}

/// Why a value was refused; the stored one stays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParamError {
    /// No parameter of that name or index.
    Unknown,
    /// NaN, infinite, or a fraction where a whole number is wanted.
    NotANumber,
    /// Outside `[min, max]` of its [`Meta`].
    OutOfRange {
        /// Smallest value accepted.
        min: f32,
        /// Largest value accepted.
        max: f32,
    },
}

/// When a parameter may no longer be changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lock {
    /// It always may; in flight a gain by small steps.
    Never,
    /// In the air.
    InAir,
    /// From arming on.
    Armed,
}

impl Group {
    /// Of its parameters.
    #[must_use]
    pub const fn lock(self) -> Lock {
        match self {
            Self::Vehicle
            | Self::Motors
            | Self::AttitudeRateControl
            | Self::Radio
            | Self::GroundStation => Lock::Armed,
            Self::Sensors | Self::Tether | Self::Estimator => Lock::InAir,
            _ => Lock::Never,
        }
    }
}

impl Params {
    /// Number of parameters.
    pub const COUNT: usize = META.len();

    /// Index of a name.
    #[must_use]
    pub fn index_of(name: &[u8]) -> Option<usize> {
        META.iter().position(|meta| meta.name.as_bytes() == name)
    }

    /// Checks and stores a value.
    ///
    /// # Errors
    /// [`ParamError`]; nothing is changed.
    pub fn set(&mut self, index: usize, value: f32) -> Result<(), ParamError> {
        let meta = META.get(index).ok_or(ParamError::Unknown)?;
        let is_whole = || libm::truncf(value).total_cmp(&value).is_eq();
        if !value.is_finite() || (meta.kind == Kind::Int && !is_whole()) {
            return Err(ParamError::NotANumber);
        }
        if value < meta.min || value > meta.max {
            return Err(ParamError::OutOfRange { min: meta.min, max: meta.max });
        }
        *self.slot(index).ok_or(ParamError::Unknown)? = value;
        Ok(())
    }
}

const fn bytes_fit(name: &str) -> bool {
    !name.is_empty() && name.len() <= 16
}

/// Declares all parameters; see `tree.rs`.
macro_rules! params {
    ($( $group:ident $title:literal { $( $(#[doc = $doc:literal])+ $field:ident : $name:literal $kind:ident [$unit:literal] = $default:literal in $min:literal ..= $max:literal ; )+ } )+) => {
        /// Every setting of the vehicle, in SI units, as stored and sent.
        #[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
        #[repr(C)]
        pub struct Params {
            $($(
                $(#[doc = $doc])+
                #[doc = concat!("\n\n`", $name, "`, unit: ", $unit, ", range ", stringify!($min), " to ", stringify!($max), ".")]
                pub $field: f32,
            )+)+
        }

        impl Default for Params {
            fn default() -> Self {
                Self { $($( $field: $default, )+)+ }
            }
        }

        /// What a parameter belongs to: a heading in the documentation, and what is made anew when it changes.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Group {
            $(#[doc = $title] $group,)+
        }

        impl Group {
            /// All of them, in the order of the table.
            pub const ALL: &[Self] = &[$(Self::$group),+];

            /// Heading in the documentation.
            #[must_use]
            pub const fn title(self) -> &'static str {
                match self { $(Self::$group => $title,)+ }
            }
        }

        /// All parameters in the order of their MAVLink index.
        pub const META: &[$crate::param::Meta] = &[$($(
            $crate::param::Meta {
                name: $name,
                group: Group::$group,
                kind: $crate::param::Kind::$kind,
                default: $default,
                min: $min,
                max: $max,
            },
        )+)+];

        /// What each is, in the same order.
        pub const DOCS: &[$crate::param::Doc] = &[$($(
            $crate::param::Doc { unit: $unit, text: concat!($($doc),+) },
        )+)+];

        $($(
            const _: () = assert!($crate::param::bytes_fit($name), concat!("parameter name over 16 bytes: ", $name));
            const _: () = assert!($min <= $default && $default <= $max, concat!("default out of range: ", $name));
        )+)+

        impl Params {
            // All fields are `f32`, in the order of the table: a list of them by another name.
            pub(super) fn slot(&mut self, index: usize) -> Option<&mut f32> {
                let values: &mut [f32; META.len()] = bytemuck::cast_mut(self);
                values.get_mut(index)
            }

            /// The value at an index.
            #[must_use]
            pub fn get(&self, index: usize) -> Option<f32> {
                let values: &[f32; META.len()] = bytemuck::cast_ref(self);
                values.get(index).copied()
            }
        }
    };
}
use params;

#[cfg(test)]
#[path = "px4_names.rs"]
mod px4_names;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refused_value_leaves_the_stored_one() {
        let mut p = Params::default();
        let i = Params::index_of(b"VEH_MASS").unwrap();
        let before = p.mass;
        for bad in [f32::NAN, f32::INFINITY, -1.0, 1e9] {
            assert!(p.set(i, bad).is_err());
            assert!((p.mass - before).abs() < f32::EPSILON);
        }
        assert_eq!(p.set(usize::MAX, 1.0), Err(ParamError::Unknown));
        p.set(i, 2.0).unwrap();
        assert!((p.mass - 2.0).abs() < f32::EPSILON);
    }

    #[test]
    fn names_are_unique_and_slots_follow_the_table() {
        let mut p = Params::default();
        for (i, meta) in META.iter().enumerate() {
            assert_eq!(Params::index_of(meta.name.as_bytes()), Some(i), "{} twice", meta.name);
            assert_eq!(p.get(i), Some(meta.default));
            assert_eq!(p.slot(i).copied(), Some(meta.default));
            if meta.kind == Kind::Int {
                assert_eq!(p.set(i, meta.min + 0.5), Err(ParamError::NotANumber));
            }
        }
    }
}
