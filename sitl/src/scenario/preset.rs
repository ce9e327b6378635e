//! `preset` in a section: many keys by one name, from `presets.toml`. The file's own keys come first.

use std::sync::LazyLock;
use toml::{Table, Value};

static PRESETS: LazyLock<Table> =
    LazyLock::new(|| include_str!("presets.toml").parse().unwrap_or_default());

fn of_section(section: &str) -> impl Iterator<Item = (&str, &Value)> {
    PRESETS.get(section).and_then(Value::as_table).into_iter().flatten().map(|(k, v)| (&**k, v))
}

/// Whether a section knows a preset; the empty name is none.
///
/// # Errors
/// A line with the names it knows.
pub(super) fn check(section: &str, name: &str) -> Result<(), String> {
    if name.is_empty() || of_section(section).any(|(known, _)| known == name) {
        return Ok(());
    }
    let known: Vec<_> = of_section(section).map(|(known, _)| known).collect();
    Err(format!("{section}.preset = {name:?} is none of {}", known.join(", ")))
}

/// Writes out the presets that a scenario names; `false`: it names none that exists.
pub(super) fn write_out(scenario: &mut Table) -> bool {
    let mut has_preset = false;
    for (name, section) in scenario {
        let Some(section) = section.as_table_mut() else { continue };
        let Some(wanted) = section.get("preset").and_then(Value::as_str).map(str::to_owned) else {
            continue;
        };
        let found = of_section(name).find(|(known, _)| *known == wanted);
        let keys = found.and_then(|(_, keys)| keys.as_table()).into_iter().flatten();
        has_preset |= found.is_some();
        for (key, value) in keys {
            section.entry(key).or_insert_with(|| value.clone());
        }
    }
    has_preset
}
