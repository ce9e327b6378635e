//! From what is a key drawn? Uniform, normal or each of a list.

use serde::Deserialize;
use statrs::distribution::{ContinuousCDF, Normal};
use toml::{Table, Value};

/// Values of one key over the flights.
#[derive(Clone, Debug, PartialEq)]
pub enum Distribution {
    /// `{ uniform = [low, high] }`.
    Uniform {
        /// Smallest.
        low: f64,
        /// Largest.
        high: f64,
    },
    /// `{ normal = [mean, sd], clip = [low, high] }`; what is drawn beyond `clip` becomes the bound.
    Normal {
        /// Mean.
        mean: f64,
        /// Standard deviation.
        sd: f64,
        /// Bounds; infinite without.
        clip: [f64; 2],
    },
    /// `{ grid = [a, b, …] }`: every one is flown with every seed.
    Grid(Vec<Value>),
}

/// As it stands in the file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    uniform: Option<[f64; 2]>,
    normal: Option<[f64; 2]>,
    clip: Option<[f64; 2]>,
    grid: Option<Vec<Value>>,
}

impl Distribution {
    /// Whether a table of `[vary]` is meant as a distribution, not as a section with keys.
    pub(super) fn is_meant(table: &Table) -> bool {
        table.values().any(|value| !value.is_table())
    }

    /// Reads and checks it.
    ///
    /// # Errors
    /// What is wrong, without the key.
    pub fn parse(value: Value) -> Result<Self, String> {
        let written: Written =
            value.try_into().map_err(|e: toml::de::Error| e.message().replace('\n', " "))?;
        match (written.uniform, written.normal, written.grid) {
            (Some([low, high]), None, None) if written.clip.is_none() => {
                finite("uniform", &[low, high])?;
                ordered("uniform", low, high)?;
                Ok(Self::Uniform { low, high })
            }
            (None, Some([mean, sd]), None) => {
                finite("normal", &[mean, sd])?;
                if sd <= 0.0 {
                    return Err(format!("normal: the standard deviation {sd} is not above 0"));
                }
                let clip = written.clip.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
                let [low, high] = clip;
                if written.clip.is_some() {
                    finite("clip", &clip)?;
                }
                ordered("clip", low, high)?;
                Ok(Self::Normal { mean, sd, clip })
            }
            (None, None, Some(values)) if written.clip.is_none() => {
                if values.is_empty() {
                    return Err("grid is empty".into());
                }
                for value in &values {
                    finite("grid", value.as_float().as_slice())?;
                }
                Ok(Self::Grid(values))
            }
            _ if written.clip.is_some() && written.normal.is_none() => {
                Err("clip goes with normal alone".into())
            }
            _ => {
                Err("expected one of uniform = [low, high], normal = [mean, sd], grid = [...]"
                    .into())
            }
        }
    }

    /// The value below which a share of all draws lies, with nine digits: a last bit that another machine
    /// rounds otherwise does not reach the flight. `None` for a grid.
    pub(super) fn quantile(&self, share: f64) -> Option<f64> {
        match self {
            Self::Uniform { low, high } => {
                Some(nine_digits(low + (high - low) * share).clamp(*low, *high))
            }
            Self::Normal { mean, sd, clip: [low, high] } => {
                let z = Normal::standard().inverse_cdf(share);
                Some(nine_digits(mean + sd * z).clamp(*low, *high))
            }
            Self::Grid(_) => None,
        }
    }

    /// Values that must be accepted for the file to make sense: the extremes, or the mean where there are none.
    pub(super) fn extremes(&self) -> Vec<Value> {
        match self {
            Self::Uniform { low, high } => vec![(*low).into(), (*high).into()],
            Self::Normal { mean, clip: [low, high], .. } => [mean, low, high]
                .into_iter()
                .filter(|x| x.is_finite())
                .map(|x| (*x).into())
                .collect(),
            Self::Grid(values) => values.clone(),
        }
    }
}

fn nine_digits(x: f64) -> f64 {
    format!("{x:.8e}").parse().unwrap_or(x)
}

fn finite(what: &str, values: &[f64]) -> Result<(), String> {
    match values.iter().find(|x| !x.is_finite()) {
        Some(x) => Err(format!("{what}: {x} is not a finite number")),
        None => Ok(()),
    }
}

fn ordered(what: &str, low: f64, high: f64) -> Result<(), String> {
    if low > high { Err(format!("{what}: {low} is above {high}")) } else { Ok(()) }
}
