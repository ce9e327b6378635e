//! `--set PATH=VALUE` on anything that is written as TOML.

use serde::{Serialize, de::DeserializeOwned};
use toml::{Table, Value};

/// Tables whose keys are not fixed.
const OPEN: &str = "params";

/// A copy with one setting changed. `value` is TOML; a bare word is a string.
///
/// # Errors
/// One line naming path or value.
pub fn set<T: Serialize + DeserializeOwned>(of: &T, path: &str, value: &str) -> Result<T, String> {
    let mut root = Value::try_from(of).map_err(|e| e.to_string())?;
    let parse = |text: String| toml::from_str::<Table>(&text).ok().and_then(|mut t| t.remove("x"));
    let value = parse(format!("x = {value}"))
        .or_else(|| parse(format!("x = {value:?}")))
        .ok_or_else(|| format!("{path} = {value}: not a value"))?;
    let unknown = || format!("{path}: no such setting");
    let (parents, leaf) = match path.rsplit_once('.') {
        Some((parents, leaf)) => (Some(parents), leaf),
        None => (None, path),
    };
    let mut at = &mut root;
    for key in parents.into_iter().flat_map(|p| p.split('.')) {
        at = at.get_mut(key).ok_or_else(unknown)?;
    }
    let table = at.as_table_mut().ok_or_else(unknown)?;
    let value = match (table.get(leaf), value) {
        (None, _) if parents != Some(OPEN) => return Err(unknown()),
        (Some(Value::Float(_)), Value::Integer(i)) => Value::Float(i as f64),
        (_, value) => value,
    };
    table.insert(leaf.to_owned(), value);
    root.try_into()
        .map_err(|e: toml::de::Error| format!("{path}: {}", e.message().replace('\n', " ")))
}
