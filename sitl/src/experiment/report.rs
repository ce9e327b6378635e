//! What an experiment found, ready to print.

use serde_json::{Map, Value, json};
use std::error::Error;
use std::path::Path;

/// Draws a file.
pub type Draw = Box<dyn Fn(&Path) -> Result<(), Box<dyn Error>>>;

/// A picture that `--plot` writes.
pub struct Picture {
    /// Without folder.
    pub name: &'static str,
    /// How.
    pub draw: Draw,
}

/// Against what a figure stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Compare {
    /// Nothing published.
    Alone,
    /// Must not exceed.
    AtMost(f64),
    /// Must be within this share of the value, or this far from it.
    Near {
        /// Expected.
        value: f64,
        /// Relative.
        share: f64,
        /// Absolute.
        slack: f64,
    },
    /// A published claim in words, and whether it holds.
    Claim(&'static str, bool),
    /// A published claim that we know not to hold here; does not fail the experiment.
    Refuted(&'static str),
    /// Differs from the reference, and we know why.
    Explained {
        /// Expected.
        value: f64,
        /// Why it differs.
        why: &'static str,
    },
}

/// One figure.
#[derive(Clone, Debug)]
pub struct Line {
    /// With the unit at its end.
    pub name: String,
    /// Ours.
    pub ours: f64,
    /// Theirs.
    pub compare: Compare,
}

impl Line {
    /// Whether it is as it should be.
    #[must_use]
    pub fn passes(&self) -> bool {
        match self.compare {
            Compare::Alone | Compare::Refuted(_) | Compare::Explained { .. } => true,
            Compare::AtMost(limit) => self.ours <= limit,
            Compare::Near { value, share, slack } => {
                let off = (self.ours - value).abs();
                off <= share * value.abs() || off <= slack
            }
            Compare::Claim(_, holds) => holds,
        }
    }

    fn published(&self) -> Option<f64> {
        match self.compare {
            Compare::AtMost(value)
            | Compare::Near { value, .. }
            | Compare::Explained { value, .. } => Some(value),
            _ => None,
        }
    }

    /// One line of the table.
    #[must_use]
    pub fn text(&self) -> String {
        let theirs = match self.compare {
            Compare::Alone => String::new(),
            Compare::AtMost(limit) => format!("limit {}", number(limit)),
            Compare::Near { value, .. } => format!("reference {}", number(value)),
            Compare::Explained { value, why } => format!("reference {}; {why}", number(value)),
            Compare::Claim(claim, _) => format!("claimed: {claim}"),
            Compare::Refuted(claim) => format!("claimed: {claim}; not reproduced"),
        };
        let verdict = match self.compare {
            Compare::Alone => "",
            Compare::Refuted(_) | Compare::Explained { .. } => "DIFFERS",
            _ if self.passes() => "ok",
            _ => "FAILS",
        };
        format!("{:<58} {:>10}  {verdict:<7} {theirs}", self.name, number(self.ours))
    }
}

fn number(x: f64) -> String {
    if x == 0.0 || (x.abs() >= 0.01 && x.abs() < 1e5) {
        format!("{x:.3}")
    } else {
        format!("{x:.1e}")
    }
}

/// All figures, notes and pictures of an experiment.
#[derive(Default)]
pub struct Report {
    /// Figures.
    pub lines: Vec<Line>,
    /// Sentences below the table.
    pub notes: Vec<String>,
    /// Pictures.
    pub pictures: Vec<Picture>,
}

impl Report {
    /// One more figure.
    pub fn add(&mut self, name: impl Into<String>, ours: f64, compare: Compare) {
        self.lines.push(Line { name: name.into(), ours, compare });
    }

    /// One more picture.
    pub fn picture(
        &mut self,
        name: &'static str,
        draw: impl Fn(&Path) -> Result<(), Box<dyn Error>> + 'static,
    ) {
        self.pictures.push(Picture { name, draw: Box::new(draw) });
    }

    /// Every figure as it should be.
    #[must_use]
    pub fn passes(&self) -> bool {
        self.lines.iter().all(Line::passes)
    }

    /// As the contract's JSON object. A figure that is not finite is null.
    #[must_use]
    pub fn json(&self, key: &str, seed: u64, sets: &[(String, String)]) -> Value {
        let settings: Map<String, Value> =
            sets.iter().map(|(path, value)| (path.clone(), json!(value))).collect();
        let metrics: Map<String, Value> =
            self.lines.iter().map(|l| (identifier(&l.name), json!(l.ours))).collect();
        let published: Map<String, Value> = self
            .lines
            .iter()
            .filter_map(|l| Some((identifier(&l.name), json!(l.published()?))))
            .collect();
        json!({
            "experiment": key,
            "seed": seed,
            "settings": settings,
            "metrics": metrics,
            "published": published,
            "pass": self.passes(),
        })
    }
}

/// `Γb T5, elevation rms, rad` → `gamma_b_t5_elevation_rms_rad`.
fn identifier(name: &str) -> String {
    let plain = name
        .replace('Γ', "gamma_")
        .replace('ε', "epsilon")
        .replace("a'", "a_prime")
        .replace('%', "percent")
        .replace('+', "plus")
        .replace('-', "minus")
        .replace("m/s²", "mps2");
    let mut id = String::new();
    for c in plain.to_lowercase().chars() {
        if c.is_ascii_alphanumeric() {
            id.push(c);
        } else if c == '.' {
            id.push('p');
        } else if !id.ends_with('_') {
            id.push('_');
        }
    }
    id.trim_matches('_').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_identifiers_that_end_in_their_unit() {
        assert_eq!(
            identifier("Γa' T5, mass -15 %, elevation rms, rad"),
            "gamma_a_prime_t5_mass_minus15_percent_elevation_rms_rad"
        );
    }

    #[test]
    fn a_figure_over_its_limit_or_not_finite_fails() {
        let mut report = Report::default();
        report.add("good, rad", 1.0, Compare::AtMost(2.0));
        assert!(report.passes());
        report.add("bad, rad", f64::NAN, Compare::AtMost(2.0));
        assert!(!report.passes());
        assert_eq!(report.json("k", 1, &[])["metrics"]["bad_rad"], serde_json::Value::Null);
    }
}
