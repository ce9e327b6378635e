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

/// Where our own figure lies if it differs from the published one: one that drifts out of it fails.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    low: f64,
    high: f64,
}

impl Band {
    /// A run that is lost, shown as infinite.
    pub const LOST: Self = Self { low: f64::INFINITY, high: f64::INFINITY };

    /// From and to, both included.
    #[must_use]
    pub const fn new(low: f64, high: f64) -> Self {
        Self { low, high }
    }

    /// This share of the value to either side.
    #[must_use]
    pub fn around(value: f64, share: f64) -> Self {
        let slack = share * value.abs();
        Self { low: value - slack, high: value + slack }
    }

    fn contains(self, ours: f64) -> bool {
        (self.low..=self.high).contains(&ours)
    }

    fn text(self) -> String {
        if self == Self::LOST {
            return "ours is lost".into();
        }
        format!("ours is {} to {}", number(self.low), number(self.high))
    }
}

/// Whose figure another is compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// Printed in one of the papers.
    Paper,
    /// Of the theory's tables: another implementation of the same equations.
    Specification,
}

impl Source {
    const fn name(self) -> &'static str {
        match self {
            Self::Paper => "published",
            Self::Specification => "specification",
        }
    }
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
        /// Whose.
        from: Source,
        /// Expected.
        value: f64,
        /// Relative.
        share: f64,
        /// Absolute.
        slack: f64,
    },
    /// A published claim in words, and whether it holds.
    Claim(&'static str, bool),
    /// A published claim that we know not to hold here.
    Refuted {
        /// The claim.
        claim: &'static str,
        /// Ours.
        ours: Band,
    },
    /// Differs from the reference, and we know why.
    Explained {
        /// Whose.
        from: Source,
        /// Expected.
        value: f64,
        /// Why it differs.
        why: &'static str,
        /// Ours.
        ours: Band,
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
            Compare::Alone => true,
            Compare::Refuted { ours, .. } | Compare::Explained { ours, .. } => {
                ours.contains(self.ours)
            }
            Compare::AtMost(limit) => self.ours <= limit,
            Compare::Near { value, share, slack, .. } => {
                let off = (self.ours - value).abs();
                off <= share * value.abs() || off <= slack
            }
            Compare::Claim(_, holds) => holds,
        }
    }

    /// The figure that this source has for it.
    fn expected(&self, source: Source) -> Option<f64> {
        match self.compare {
            Compare::Near { from, value, .. } | Compare::Explained { from, value, .. } => {
                Some(value).filter(|_| from == source)
            }
            _ => None,
        }
    }

    const fn limit(&self) -> Option<f64> {
        match self.compare {
            Compare::AtMost(limit) => Some(limit),
            _ => None,
        }
    }

    const fn claim(&self) -> Option<&'static str> {
        match self.compare {
            Compare::Claim(claim, _) | Compare::Refuted { claim, .. } => Some(claim),
            _ => None,
        }
    }

    /// Nothing to compare with, as it should be, other than theirs and we know why, or wrong.
    fn verdict(&self) -> Option<&'static str> {
        match self.compare {
            Compare::Alone => None,
            _ if !self.passes() => Some("fails"),
            Compare::Refuted { .. } | Compare::Explained { .. } => Some("differs"),
            _ => Some("ok"),
        }
    }

    /// As an object: words and unit apart, and whatever it stands against under a name of its own.
    fn json(&self) -> Value {
        let (name, unit) = self.name.rsplit_once(", ").unwrap_or((&self.name, ""));
        let why = match self.compare {
            Compare::Explained { why, .. } => Some(why),
            _ => None,
        };
        json!({
            "name": name,
            "unit": unit,
            "metric": identifier(&self.name),
            "value": self.ours,
            "published": self.expected(Source::Paper),
            "specification": self.expected(Source::Specification),
            "limit": self.limit(),
            "claim": self.claim(),
            "why": why,
            "verdict": self.verdict(),
        })
    }

    /// One line of the table.
    #[must_use]
    pub fn text(&self) -> String {
        let theirs = match self.compare {
            Compare::Alone => String::new(),
            Compare::AtMost(limit) => format!("limit {}", number(limit)),
            Compare::Near { from, value, .. } => format!("{} {}", from.name(), number(value)),
            Compare::Explained { from, value, why, ours } => {
                format!("{} {}; {why}; {}", from.name(), number(value), ours.text())
            }
            Compare::Claim(claim, _) => format!("claimed: {claim}"),
            Compare::Refuted { claim, ours } => {
                format!("claimed: {claim}; not reproduced, {}", ours.text())
            }
        };
        let verdict = match self.verdict() {
            None => String::new(),
            Some("ok") => "ok".into(),
            Some(other) => other.to_uppercase(),
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

    /// One JSON object: all figures by name, those that the papers print, and each as a row with what it stands against
    /// and its verdict. A figure that is not finite is null.
    #[must_use]
    pub fn json(&self, key: &str, seed: u64, sets: &[(String, String)]) -> Value {
        let settings: Map<String, Value> =
            sets.iter().map(|(path, value)| (path.clone(), json!(value))).collect();
        let metrics: Map<String, Value> =
            self.lines.iter().map(|l| (identifier(&l.name), json!(l.ours))).collect();
        let published: Map<String, Value> = self
            .lines
            .iter()
            .filter_map(|l| Some((identifier(&l.name), json!(l.expected(Source::Paper)?))))
            .collect();
        json!({
            "experiment": key,
            "seed": seed,
            "settings": settings,
            "metrics": metrics,
            "published": published,
            "rows": self.lines.iter().map(Line::json).collect::<Vec<_>>(),
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
    fn a_figure_that_differs_from_the_published_one_fails_outside_its_own_band() {
        let passes = |ours: f64, band| {
            let refuted = Compare::Refuted { claim: "stable", ours: band };
            let explained = Compare::Explained {
                from: Source::Paper,
                value: 9.0,
                why: "another record",
                ours: band,
            };
            let lines =
                [refuted, explained].map(|compare| Line { name: "x".into(), ours, compare });
            let [a, b] = lines.each_ref().map(Line::passes);
            assert_eq!(a, b);
            assert!(lines.iter().all(|l| l.text().contains(if a { "DIFFERS" } else { "FAILS" })));
            a
        };
        assert!(passes(2.0, Band::new(1.0, 2.0)) && passes(1.0, Band::around(1.1, 0.1)));
        assert!(!passes(2.1, Band::new(1.0, 2.0)) && !passes(0.9, Band::new(1.0, 2.0)));
        assert!(!passes(f64::NAN, Band::new(1.0, 2.0)) && !passes(f64::NAN, Band::LOST));
        assert!(passes(f64::INFINITY, Band::LOST) && !passes(3.0, Band::LOST));
        assert!(!passes(f64::INFINITY, Band::new(1.0, 2.0)));
    }

    #[test]
    fn a_row_tells_published_specified_and_limit_apart() {
        let near = |from| Compare::Near { from, value: 2.0, share: 0.1, slack: 0.0 };
        let mut report = Report::default();
        report.add("calm: elevation rms, rad", 2.1, near(Source::Paper));
        report.add("lost of 6, 1", 3.0, near(Source::Specification));
        report.add("tension rms, N", 0.5, Compare::AtMost(1.0));
        report.add("thrust, N", 5.0, Compare::Alone);
        let json = report.json("k", 1, &[]);
        let row = |i: usize, key: &str| json["rows"][i][key].clone();
        assert_eq!([row(0, "name"), row(0, "unit")], ["calm: elevation rms", "rad"]);
        assert_eq!(row(0, "metric"), "calm_elevation_rms_rad");
        assert_eq!(
            [row(0, "published"), row(1, "specification"), row(2, "limit")],
            [2.0, 2.0, 1.0]
        );
        assert_eq!(
            [row(0, "verdict"), row(1, "verdict"), row(2, "verdict")],
            ["ok", "fails", "ok"]
        );
        let none =
            [row(0, "specification"), row(0, "limit"), row(1, "published"), row(3, "verdict")];
        assert!(none.iter().all(Value::is_null));
        assert_eq!(json["published"].as_object().unwrap().len(), 1);
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
