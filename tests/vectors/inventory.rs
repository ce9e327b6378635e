//! What a folder of vectors holds, and what of it somebody checks.

use super::{
    full_state, fullstate, inertial, inertial_worlds, localization, localization_worlds, pendulum,
    pendulum_loops, planar, planar_loops, planar_observer, sysid,
};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Every file that may stand in a folder.
pub const FILES: [&str; 6] = [
    "planar.json",
    "inertial.json",
    "localization.json",
    "pendulum.json",
    "fullstate.json",
    "fullstate2.json",
];

/// Groups of one file by what becomes of them.
struct Known {
    checked: Vec<&'static str>,
    /// Text and parameters beside the groups.
    notes: &'static [&'static str],
    /// A part of a group that nobody would look at.
    unknown_part: fn(&str, &Value) -> Option<String>,
    /// The setting of a case that its check does not know.
    unknown_setting: fn(&str, &Value) -> Option<String>,
}

fn known(file: &str) -> Known {
    let none = Known {
        checked: Vec::new(),
        notes: &["meta"],
        unknown_part: |_, _| None,
        unknown_setting: |_, _| None,
    };
    match file {
        "planar.json" => Known {
            checked: planar::groups::<f64>()
                .into_iter()
                .map(|(name, ..)| name)
                .chain(["observer_streams", "closed_loop"])
                .collect(),
            unknown_setting: |group, case| match group {
                "observer_streams" => planar_observer::unknown_setting(case),
                "closed_loop" => planar_loops::unknown_setting(case),
                _ => None,
            },
            ..none
        },
        "inertial.json" => Known {
            checked: [&inertial::SINGLE[..], &inertial_worlds::WORLDS].concat(),
            unknown_setting: inertial_worlds::unknown_setting,
            ..none
        },
        "localization.json" => Known {
            checked: [&localization::SINGLE[..], &localization_worlds::WORLDS, &["sysid"]].concat(),
            unknown_part: |group, content| match group {
                "sweeps" => localization_worlds::unknown_part(content),
                "sysid" => sysid::unknown_part(content),
                _ => None,
            },
            ..none
        },
        "pendulum.json" => Known {
            checked: pendulum::GROUPS.to_vec(),
            notes: &["note", "seed"],
            unknown_setting: |group, case| match group {
                "closed_loop" => pendulum_loops::unknown_setting(case),
                _ => None,
            },
            ..none
        },
        "fullstate.json" => {
            Known { checked: [&fullstate::GROUPS[..], &full_state::GROUPS].concat(), ..none }
        }
        _ => Known { checked: full_state::GROUPS_2.to_vec(), ..none },
    }
}

/// What was found in one file.
#[derive(Debug, Default)]
pub struct Inventory {
    /// Group and number of cases.
    pub checked: Vec<(String, usize)>,
    /// One line for each group or case that nothing checks.
    pub skipped: Vec<String>,
}

/// An error unless one of the known files is in the folder.
pub fn folder_holds_vectors(folder: &Path) -> Result<(), String> {
    if FILES.iter().any(|file| folder.join(file).exists()) {
        return Ok(());
    }
    Err(format!("{}: none of {}", folder.display(), FILES.join(", ")))
}

/// The groups of a file; `planar.json` has most of its own one level down.
fn groups<'a>(file: &str, content: &'a Value) -> Result<Vec<(String, &'a Value)>, String> {
    let mut all = Vec::new();
    for (key, value) in content.as_object().ok_or_else(|| format!("{file}: not an object"))? {
        match (file, key.as_str()) {
            ("planar.json", "groups") => {
                let inner = value.as_object().ok_or_else(|| format!("{file}: groups"))?;
                all.extend(inner.iter().map(|(key, value)| (key.clone(), value)));
            }
            _ => all.push((key.clone(), value)),
        }
    }
    Ok(all)
}

/// Elements of a list; an object that is not empty is one case.
fn cases(group: &Value) -> Vec<&Value> {
    match group {
        Value::Array(list) => list.iter().collect(),
        Value::Object(map) => vec![group; usize::from(!map.is_empty())],
        _ => Vec::new(),
    }
}

/// Reads one file of a folder; `None` where it is absent.
///
/// `Err`: no known file in the folder, a group of an unknown name or without cases, or nothing in the file
/// that is checked.
pub fn inventory(folder: &Path, file: &str) -> Result<Option<Inventory>, String> {
    folder_holds_vectors(folder)?;
    if !folder.join(file).exists() {
        return Ok(None);
    }
    let text = fs::read_to_string(folder.join(file)).map_err(|e| format!("{file}: {e}"))?;
    let content: Value = serde_json::from_str(&text).map_err(|e| format!("{file}: {e}"))?;
    let known = known(file);
    let mut found = Inventory::default();
    for (name, group) in groups(file, &content)? {
        let is = |list: &[&str]| list.contains(&name.as_str());
        if is(known.notes) {
            continue;
        }
        if !is(&known.checked) {
            return Err(format!("{file}: unknown group {name}"));
        }
        if let Some(part) = (known.unknown_part)(&name, group) {
            return Err(format!("{file}: unknown {part} in group {name}"));
        }
        let cases = cases(group);
        if cases.is_empty() {
            return Err(format!("{file}: group {name} has no cases"));
        }
        let mut checked = 0;
        for (i, case) in cases.into_iter().enumerate() {
            match (known.unknown_setting)(&name, case) {
                None => checked += 1,
                Some(why) => found.skipped.push(format!("{name}[{i}]: unknown {why}")),
            }
        }
        if checked > 0 {
            found.checked.push((name, checked));
        }
    }
    if found.checked.is_empty() {
        return Err(format!("{file}: nothing is checked, skipped {:?}", found.skipped));
    }
    Ok(Some(found))
}

/// A key that is not among those read.
pub fn unread_key(settings: &Value, read: &[&str]) -> Option<String> {
    settings.as_object()?.keys().find(|key| !read.contains(&key.as_str())).cloned()
}
