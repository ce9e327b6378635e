//! Parameter files as QGroundControl writes them: system, component, name, value and type, separated
//! by tabs; lines with `#` are comments.

use super::set_param;
use std::path::Path;
use tautline_firmware::param::{Kind, META, Params};

/// Applies a file.
///
/// # Errors
/// One line naming file, line and what is wrong; `params` may then hold the lines before it.
pub fn load(params: &mut Params, path: &Path) -> Result<(), String> {
    let name = path.display();
    let text = std::fs::read_to_string(path).map_err(|e| format!("{name}: {e}"))?;
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let at = |what: String| format!("{name}:{number}: {what}");
        let fields: Vec<_> = line.split_whitespace().collect();
        let [_, _, parameter, value, _] = fields.as_slice() else {
            return Err(at("expected: system, component, name, value, type".into()));
        };
        let value = value.parse().map_err(|_| at(format!("{value} is not a number")))?;
        set_param(params, parameter, value).map_err(at)?;
    }
    Ok(())
}

/// The same format, all parameters.
#[must_use]
pub fn to_text(params: &Params) -> String {
    let all: Vec<_> = META
        .iter()
        .enumerate()
        .map(|(index, meta)| (meta.name, f64::from(params.get(index).unwrap_or(meta.default))))
        .collect();
    some_to_text(&all)
}

/// The same format, some of them; names that are not parameters are left out.
#[must_use]
pub fn some_to_text(values: &[(&str, f64)]) -> String {
    let mut text = String::from("# Tautline parameters\n");
    for (name, value) in values {
        let Some(meta) = META.iter().find(|meta| meta.name == *name) else { continue };
        let kind = if meta.kind == Kind::Real { 9 } else { 6 };
        text.push_str(&format!("1\t1\t{name}\t{}\t{kind}\n", *value as f32));
    }
    text
}
