//! Where is a scenario key declared? Once, in `sections.rs`.
//!
//! The table there yields each section's struct with its defaults and its reader, the check of its ranges,
//! and [`keys`]: what a template or a reader wants to know of every key.

use super::check::within;
use crate::plant::Hub;
use tautline_firmware::signal::MAX_ROTORS;

/// What is known of one key.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// Section that it stands in.
    pub section: &'static str,
    /// Its name there.
    pub name: &'static str,
    /// Unit; empty for a pure number, a word or a switch.
    pub unit: &'static str,
    /// Its value when the file leaves it out; `None`: it has none then.
    pub default: fn() -> Option<toml::Value>,
    /// Smallest and largest value accepted; `None`: its type decides.
    pub range: Option<(f64, f64)>,
    /// What it does.
    pub doc: &'static str,
}

/// A type that a key may have.
pub(super) trait KeyValue {
    /// Checks against a range; `path` names the key in the error.
    fn check(&self, path: &str, range: Option<(f64, f64)>) -> Result<(), String>;
}

impl KeyValue for f64 {
    fn check(&self, path: &str, range: Option<(f64, f64)>) -> Result<(), String> {
        range.map_or(Ok(()), |(min, max)| within(path, *self, min, max))
    }
}

impl<const N: usize> KeyValue for [f64; N] {
    fn check(&self, path: &str, range: Option<(f64, f64)>) -> Result<(), String> {
        self.iter().enumerate().try_for_each(|(i, x)| x.check(&format!("{path}[{i}]"), range))
    }
}

impl KeyValue for Option<f64> {
    fn check(&self, path: &str, range: Option<(f64, f64)>) -> Result<(), String> {
        self.map_or(Ok(()), |x| x.check(path, range))
    }
}

impl KeyValue for u64 {
    fn check(&self, path: &str, range: Option<(f64, f64)>) -> Result<(), String> {
        range.map_or(Ok(()), |(min, max)| within(path, *self as f64, min, max))
    }
}

impl KeyValue for Vec<[f64; 4]> {
    fn check(&self, path: &str, _: Option<(f64, f64)>) -> Result<(), String> {
        rows_in_order(path, self.iter())
    }
}

/// Numbers within reason, their times one after the other.
pub(super) fn rows_in_order<'a>(
    path: &str,
    rows: impl Iterator<Item = &'a [f64; 4]>,
) -> Result<(), String> {
    let mut last = f64::NEG_INFINITY;
    for (i, row) in rows.enumerate() {
        row.check(&format!("{path}[{i}]"), Some((-1e5, 1e5)))?;
        if row[0] <= last {
            return Err(format!("{path}[{i}][0] = {} is not after {last}", row[0]));
        }
        last = row[0];
    }
    Ok(())
}

/// A frame has as many rotors as there are motor outputs at most.
impl KeyValue for Vec<Hub> {
    fn check(&self, path: &str, _: Option<(f64, f64)>) -> Result<(), String> {
        if !self.is_empty() {
            within(&format!("{path}.length"), self.len() as f64, 3.0, MAX_ROTORS as f64)?;
        }
        for (i, hub) in self.iter().enumerate() {
            within(&format!("{path}[{i}].x"), hub.x, -10.0, 10.0)?;
            within(&format!("{path}[{i}].y"), hub.y, -10.0, 10.0)?;
            within(&format!("{path}[{i}].spin"), hub.spin, -1.0, 1.0)?;
        }
        Ok(())
    }
}

/// Types whose every value is accepted.
macro_rules! unlimited {
    ($($type:ty),+) => {
        $(impl KeyValue for $type {
            fn check(&self, _: &str, _: Option<(f64, f64)>) -> Result<(), String> {
                Ok(())
            }
        })+
    };
}
unlimited!(bool, String, super::LineModel, super::TetherKind, super::DisturbanceKind);

/// Declares all sections; see `sections.rs`.
macro_rules! sections {
    ($(
        $(#[doc = $about:literal])+ $section:literal $struct:ident {
            $( $(#[doc = $doc:literal])+ $key:ident : $type:ty [$unit:literal] = $default:expr $(, in $min:literal ..= $max:literal)? ; )+
        }
    )+) => {
        $(
            $(#[doc = $about])+
            #[derive(Clone, Debug, serde::Deserialize, serde::Serialize, PartialEq)]
            #[serde(default, deny_unknown_fields)]
            pub struct $struct {
                $(
                    $(#[doc = $doc])+
                    #[doc = concat!("\n\nUnit: ", $unit, $("; range ", stringify!($min), " to ", stringify!($max),)? ".")]
                    pub $key: $type,
                )+
            }

            impl Default for $struct {
                fn default() -> Self {
                    Self { $( $key: $default, )+ }
                }
            }

            impl $struct {
                /// Its keys, in the order of the file.
                pub const KEYS: &[$crate::scenario::Key] = &[$(
                    $crate::scenario::Key {
                        section: $section,
                        name: stringify!($key),
                        unit: $unit,
                        default: || toml::Value::try_from({ let value: $type = $default; value }).ok(),
                        range: $crate::scenario::key::sections!(@range $($min, $max)?),
                        doc: concat!($($doc),+),
                    },
                )+];

                /// Every value within its range.
                pub(super) fn check(&self) -> Result<(), String> {
                    $(
                        $crate::scenario::key::KeyValue::check(
                            &self.$key,
                            concat!($section, ".", stringify!($key)),
                            $crate::scenario::key::sections!(@range $($min, $max)?),
                        )?;
                    )+
                    Ok(())
                }
            }
        )+

        /// The keys of all sections.
        pub fn keys() -> impl Iterator<Item = &'static $crate::scenario::Key> {
            [$( $struct::KEYS, )+].into_iter().flatten()
        }
    };
    (@range $min:literal, $max:literal) => { Some(($min, $max)) };
    (@range) => { None };
}
pub(super) use sections;
