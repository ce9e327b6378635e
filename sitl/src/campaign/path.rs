//! Where in a scenario file does a value stand? `wind.speed`, `params.TET_TENSION`, `vehicle.inertia[0]`,
//! `fault[0].value`: as the scenario's own errors name it.

use toml::{Table, Value};

/// One step into the file.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Part {
    Key(String),
    Item(usize),
}

/// The way to a key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeyPath(Vec<Part>);

impl KeyPath {
    /// Reads `a.b[0].c`; `None` if it is not of that form.
    pub fn parse(text: &str) -> Option<Self> {
        let mut parts = Vec::new();
        for word in text.split('.') {
            let (key, items) = word.split_at(word.find('[').unwrap_or(word.len()));
            if key.is_empty() {
                return None;
            }
            parts.push(Part::Key(key.to_owned()));
            let mut rest = items;
            while !rest.is_empty() {
                let (item, after) = rest.strip_prefix('[')?.split_once(']')?;
                parts.push(Part::Item(item.parse().ok()?));
                rest = after;
            }
        }
        Some(Self(parts))
    }

    /// One is the other, or a part of it.
    pub fn overlaps(&self, other: &Self) -> bool {
        self.0.iter().zip(&other.0).all(|(a, b)| a == b)
    }

    /// Puts a value there. Sections that the file leaves out come into being; items of a list do not.
    ///
    /// # Errors
    /// There is no such item.
    pub fn put(&self, scenario: &mut Table, value: Value) -> Result<(), String> {
        let missing = || "the scenario file has no such item".to_owned();
        let mut parts = self.0.iter();
        let Some(Part::Key(first)) = parts.next() else { return Err(missing()) };
        let mut at = scenario.entry(first).or_insert_with(|| Value::Table(Table::new()));
        for part in parts {
            at = match (part, at) {
                (Part::Key(key), Value::Table(table)) => {
                    table.entry(key).or_insert_with(|| Value::Table(Table::new()))
                }
                (Part::Item(i), Value::Array(items)) => items.get_mut(*i).ok_or_else(missing)?,
                _ => return Err(missing()),
            };
        }
        *at = value;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn put(text: &str, path: &str, value: f64) -> Result<Table, String> {
        let mut table: Table = text.parse().unwrap();
        KeyPath::parse(path).unwrap().put(&mut table, value.into()).map(|()| table)
    }

    #[test]
    fn a_value_is_put_where_the_path_points_and_nothing_else_changes() {
        let text = "[[fault]]\nkind = \"gust\"\nvalue = 1.0\n[vehicle]\ninertia = [0.1, 0.2, 0.3]";
        let same =
            |path, want: &str| assert_eq!(put(text, path, 9.0).unwrap(), want.parse().unwrap());
        same("fault[0].value", &text.replace("1.0", "9.0"));
        same("vehicle.inertia[1]", &text.replace("0.2", "9.0"));
        same("wind.speed", &format!("{text}\n[wind]\nspeed = 9.0"));
        assert!(put(text, "fault[1].value", 9.0).is_err());
        assert!(put(text, "base.table[0]", 9.0).is_err());
    }

    #[test]
    fn what_is_no_path_is_refused() {
        for text in ["", ".", "a.", "a..b", "[0]", "a[", "a[x]", "a[0]b", "a[-1]"] {
            assert_eq!(KeyPath::parse(text), None, "{text}");
        }
    }
}
