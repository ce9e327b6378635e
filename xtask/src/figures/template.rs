//! `{command; metric; format}` → a number.
//!
//! A metric may be `max NAME`, `min NAME` or `sum NAME` with a `*` in the name that stands for anything. A format is `.N` for so
//! many decimals or `,` for a whole number with commas, with `deg` behind it from radians, `%` from a share.

use super::All;

/// A place for a figure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The command, without its `cargo`.
    pub source: String,
    /// As it stands there.
    pub metric: String,
    format: String,
}

impl Place {
    fn parse(text: &str) -> Result<Self, String> {
        let mut parts = text.split(';').map(|part| part.trim().to_owned());
        match (parts.next(), parts.next(), parts.next(), parts.next()) {
            (Some(source), Some(metric), Some(format), None) => Ok(Self { source, metric, format }),
            _ => Err(format!("{{{text}}}: not {{command; metric; format}}")),
        }
    }

    fn name(&self) -> &str {
        self.metric
            .split_once(' ')
            .filter(|(what, _)| is_sum(what))
            .map_or(&self.metric, |(_, n)| n)
    }

    /// Whether a metric counts here.
    pub fn takes(&self, metric: &str) -> bool {
        match self.name().split_once('*') {
            Some((head, tail)) => {
                metric.len() >= head.len() + tail.len()
                    && metric.starts_with(head)
                    && metric.ends_with(tail)
            }
            None => metric == self.name(),
        }
    }

    fn value(&self, all: &All) -> Result<f64, String> {
        let missing = || format!("cargo {} was not measured: no {}", self.source, self.metric);
        let figures = all.get(&self.source).ok_or_else(missing)?;
        let values = figures.iter().filter(|(name, _)| self.takes(name)).map(|(_, value)| *value);
        let value = match self.metric.split_once(' ') {
            Some(("min", _)) => values.reduce(f64::min),
            Some(("sum", _)) => values.reduce(|a, b| a + b),
            _ => values.reduce(f64::max),
        };
        value.ok_or_else(missing)
    }

    fn text(&self, all: &All) -> Result<String, String> {
        let value = self.value(all)?;
        let (format, factor) = match &self.format {
            f if f.ends_with("deg") => (f.trim_end_matches("deg"), 1_f64.to_degrees()),
            f if f.ends_with('%') => (f.trim_end_matches('%'), 100.0),
            f => (f.as_str(), 1.0),
        };
        let value = value * factor;
        if format == "," {
            return Ok(grouped(value));
        }
        let decimals = format.strip_prefix('.').and_then(|digits| digits.parse().ok());
        let decimals: usize = decimals.ok_or_else(|| format!("{}: no format", self.format))?;
        Ok(format!("{value:.decimals$}"))
    }
}

fn is_sum(what: &str) -> bool {
    ["max", "min", "sum"].contains(&what)
}

/// 12345.6 → 12,346.
fn grouped(value: f64) -> String {
    let digits = format!("{:.0}", value.abs());
    let mut text = String::from(if value < -0.5 { "-" } else { "" });
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// Pieces of a text: what stands as it is, and what is in braces.
fn pieces(text: &str) -> impl Iterator<Item = (&str, Option<&str>)> {
    text.split_inclusive('}').map(|piece| match piece.split_once('{') {
        Some((plain, inside)) => (plain, inside.strip_suffix('}')),
        None => (piece, None),
    })
}

/// All places of a table.
///
/// # Errors
/// One that is none.
pub fn places(text: &str) -> Result<Vec<Place>, String> {
    pieces(text).filter_map(|(_, inside)| inside).map(Place::parse).collect()
}

/// The table with its figures.
///
/// # Errors
/// One that was not measured, or is written otherwise.
pub fn fill(text: &str, all: &All) -> Result<String, String> {
    let mut filled = String::new();
    for (plain, inside) in pieces(text) {
        filled.push_str(plain);
        if let Some(inside) = inside {
            filled.push_str(&Place::parse(inside)?.text(all)?);
        }
    }
    Ok(filled)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    fn all() -> All {
        let figures =
            [("a_m", 0.126), ("b_lost", 1.0), ("c_lost", 2.0), ("n", 12345.4), ("r", 0.5)];
        let figures = figures.map(|(name, value)| (name.to_owned(), value));
        BTreeMap::from([("sitl experiment x".to_owned(), BTreeMap::from(figures))])
    }

    fn filled(text: &str) -> Result<String, String> {
        fill(text, &all())
    }

    #[test]
    fn a_place_becomes_its_figure_in_its_format() {
        let text = "| {sitl experiment x; a_m; .2} m, {sitl experiment x; n; ,}; {sitl experiment x; r; .0deg}° |";
        assert_eq!(filled(text).as_deref(), Ok("| 0.13 m, 12,345; 29° |"));
        assert_eq!(filled("{sitl experiment x; r; .0%} %").as_deref(), Ok("50 %"));
        assert_eq!(filled("nothing").as_deref(), Ok("nothing"));
    }

    #[test]
    fn several_metrics_are_summed_up() {
        let of = |what: &str| filled(&format!("{{sitl experiment x; {what} *_lost; .0}}"));
        assert_eq!(of("sum").as_deref(), Ok("3"));
        assert_eq!(of("min").as_deref(), Ok("1"));
        assert_eq!(of("max").as_deref(), Ok("2"));
    }

    #[test]
    fn what_was_not_measured_is_an_error() {
        assert!(filled("{sitl experiment x; z; .2}").is_err());
        assert!(filled("{sitl experiment y; a_m; .2}").is_err());
        assert!(filled("{sitl experiment x; a_m; 2}").is_err());
        assert!(filled("{a_m}").is_err());
        assert_eq!(grouped(-1_234.0), "-1,234");
    }
}
