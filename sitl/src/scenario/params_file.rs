//! Parameter files, from here and from elsewhere: as QGroundControl writes them (vehicle, component, name, value and
//! type), and as Mission Planner (`name,value`) and MAVProxy (`name value`) do; what stands behind `#` is a comment.
//!
//! A file from another vehicle has names that this one does not know: what exists is loaded, and the rest is told. What
//! exists must be right: one bad value refuses the file, and nothing of it counts. PX4's names for what is ours under
//! another are views of it here as they are for a ground station.

use super::set_param;
use std::collections::BTreeMap;
use std::path::Path;
use tautline_firmware::param::{ALIASES, Alias, Kind, META, Params};

/// The component whose parameters these are: the autopilot.
const AUTOPILOT: u32 = 1;
/// Of a line that is no parameter, so much is shown.
const SHOWN: usize = 40;

/// Applies a file. Gives warnings, a line each.
///
/// # Errors
/// One line naming file, line and what is wrong; `params` is as before.
pub fn load(params: &mut Params, path: &Path) -> Result<Vec<String>, String> {
    let name = path.display().to_string();
    let bytes = std::fs::read(path).map_err(|e| format!("{name}: {e}"))?;
    load_bytes(params, &bytes, &name)
}

/// The same from memory; `name` stands in what is said.
///
/// # Errors
/// See [`load`].
pub fn load_bytes(params: &mut Params, bytes: &[u8], name: &str) -> Result<Vec<String>, String> {
    let mut file = File { params: *params, ..File::default() };
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    if bytes.starts_with(b"\xFF\xFE") || bytes.starts_with(b"\xFE\xFF") {
        return Err(format!("{name}: this is UTF-16; parameters come in ASCII or UTF-8"));
    }
    for (number, line) in (1..).zip(bytes.split(|&b| b == b'\n')) {
        file.take(number, line).map_err(|what| format!("{name}:{number}: {what}"))?;
    }
    file.set_aliases().map_err(|what| format!("{name}:{what}"))?;
    let warnings = file.warnings().map_err(|what| format!("{name}:{what}"))?;
    *params = file.params;
    Ok(warnings.into_iter().map(|what| format!("{name}:{what}")).collect())
}

/// What was read so far.
#[derive(Default)]
struct File<'a> {
    params: Params,
    /// Lines in which each known name stands.
    seen: BTreeMap<&'a str, Vec<usize>>,
    /// Set after all others: what they come to may depend on them.
    aliases: Vec<(usize, &'static Alias, f32)>,
    unknown: Vec<&'a str>,
    read_only: Vec<&'a str>,
    /// Lines of components other than the autopilot.
    others: usize,
}

impl<'a> File<'a> {
    fn take(&mut self, number: usize, line: &'a [u8]) -> Result<(), String> {
        let line = line.split(|&b| b == b'#').next().unwrap_or(line);
        // Comments are in whatever encoding; names and numbers are ASCII in all of them.
        let Ok(line) = std::str::from_utf8(line) else { return Err(strange(line)) };
        let line = line.trim();
        if line.is_empty() {
            return Ok(());
        }
        let Some((component, name, value)) = fields(line) else {
            return Err(strange(line.as_bytes()));
        };
        if component != AUTOPILOT {
            self.others += 1;
            return Ok(());
        }
        let Ok(value) = value.parse::<f32>() else {
            return Err(format!("{name} = {value} is not a number"));
        };
        if Params::index_of(name.as_bytes()).is_some() {
            set_param(&mut self.params, name, value)?;
        } else if let Some(alias) = alias(name) {
            if !value.is_finite() {
                return Err(format!("{name} = {value} is not a whole or finite number"));
            }
            self.aliases.push((number, alias, value));
        } else {
            self.unknown.push(name);
            return Ok(());
        }
        self.seen.entry(name).or_default().push(number);
        Ok(())
    }

    /// What is a view of a parameter, unless that stands there by its own name.
    fn set_aliases(&mut self) -> Result<(), String> {
        for (number, alias, value) in &self.aliases {
            let Some((index, ours)) = alias.write(&self.params, *value) else {
                // As it is everywhere: nothing is lost.
                let is_same = (alias.value(&self.params) - value).abs() < 1e-6;
                if !is_same && !self.read_only.contains(&alias.name) {
                    self.read_only.push(alias.name);
                }
                continue;
            };
            let target = META.get(index).map_or(alias.name, |meta| meta.name);
            if !self.seen.contains_key(target) {
                set_param(&mut self.params, target, ours)
                    .map_err(|e| format!("{number}: {} = {value}: {e}", alias.name))?;
            }
        }
        Ok(())
    }

    fn warnings(&self) -> Result<Vec<String>, String> {
        let others = lines(self.others);
        if self.seen.is_empty() {
            return match (self.unknown.as_slice(), self.others) {
                ([], 0) => Ok(vec![" no parameters in it".into()]),
                ([], _) => Err(format!(" {others} of other components, none of the autopilot")),
                (names, _) => Err(format!(" none of its names is known: {}", names.join(", "))),
            };
        }
        let mut warnings = Vec::new();
        for (names, what) in [(&self.unknown, "unknown"), (&self.read_only, "not to be set here")] {
            if !names.is_empty() {
                let (count, names) = (names.len(), names.join(", "));
                warnings.push(format!(" {count} {what}, passed over: {names}"));
            }
        }
        if self.others > 0 {
            warnings.push(format!(" {others} of other components passed over"));
        }
        for (name, at) in &self.seen {
            if let [_, .., last] = at.as_slice() {
                let count = at.len();
                warnings.push(format!("{last}: {name} for the {count}. time, and this one counts"));
            }
        }
        Ok(warnings)
    }
}

fn alias(name: &str) -> Option<&'static Alias> {
    ALIASES.get(Alias::index_of(name.as_bytes())?)
}

/// Component, name and value of a line in one of the formats.
fn fields(line: &str) -> Option<(u32, &str, &str)> {
    let words: Vec<_> = line.split_whitespace().collect();
    let (component, name, value) = match (line.split_once(','), words.as_slice()) {
        (_, [vehicle, component, name, value, kind]) => {
            let is_number = |word: &str| word.parse::<u32>().is_ok();
            if !is_number(vehicle) || !is_number(kind) {
                return None;
            }
            (component.parse().ok()?, *name, *value)
        }
        (_, [name, value]) if !name.contains(',') => (AUTOPILOT, *name, *value),
        (Some((name, value)), _) => (AUTOPILOT, name.trim(), value.trim()),
        _ => return None,
    };
    // Another file's words are no names, and its commas no columns.
    let is_name = name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_')
        && name.len() <= 16;
    let is_value = value.starts_with(|c: char| c.is_ascii_digit() || "+-.nNiI".contains(c))
        && !value.contains(char::is_whitespace);
    (is_name && is_value).then_some((component, name, value))
}

fn strange(line: &[u8]) -> String {
    let text = String::from_utf8_lossy(line);
    let text: String = text.trim().chars().map(|c| if c.is_control() { '?' } else { c }).collect();
    let shown: String = text.chars().take(SHOWN).collect();
    let dots = if shown.len() < text.len() { "…" } else { "" };
    format!(
        "`{shown}{dots}` is no parameter; known are QGroundControl's format (vehicle, component, name, value, type), \
         `name,value` and `name value`"
    )
}

fn lines(count: usize) -> String {
    if count == 1 { "1 line".into() } else { format!("{count} lines") }
}

/// The same format as QGroundControl's, all parameters.
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
