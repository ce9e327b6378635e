//! Measured figures: one file of values, and the tables that say them.
//!
//! [`FILE`] holds every figure under the command that measures it. `xtask/figures/NAME.md` is a table with a
//! `{command; metric; format}` in the place of each; filled, it stands between `<!-- figures:NAME -->` and
//! `<!-- /figures -->` of a page. Figures in other places of a page are written by hand, with the command beside them.

mod measure;
mod template;

use crate::{Outcome, root};
use measure::measure;
pub use measure::sitl;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use template::{Place, fill, places};

const FILE: &str = "docs/figures.json";
const TEMPLATES: &str = "xtask/figures";
const README: &str = "README.md";
/// What the thin check measures anew, in half a minute.
const QUICK: [&str; 2] = ["sitl campaign calm", "sitl experiment thrust-flight"];

/// Metric → value.
pub type Figures = BTreeMap<String, f64>;
/// Command without its `cargo` → what it measures.
pub type All = BTreeMap<String, Figures>;

/// A table: its name, and its text with places for figures.
struct Template {
    name: String,
    text: String,
}

/// Measures and rewrites file and pages: all, or what one command measures.
pub fn write(only: Option<&str>) -> Outcome {
    let templates = templates()?;
    let mut all = if only.is_some() { read()? } else { All::new() };
    let sources = sources(&templates)?;
    let wanted = sources.iter().filter(|(source, _)| only.is_none_or(|only| only == *source));
    let mut found = false;
    for (source, wanted) in wanted {
        found = true;
        all.insert(source.clone(), measured(source, wanted)?);
    }
    if let Some(only) = only.filter(|_| !found) {
        let known: Vec<_> = sources.keys().map(String::as_str).collect();
        return Err(format!("no figure of `{only}`; there are {}", known.join(", ")));
    }
    let text = serde_json::to_string_pretty(&all).map_err(|e| e.to_string())? + "\n";
    save(Path::new(FILE), &text)?;
    fill_pages(&templates, &all)
}

/// Fills the tables from the file as it stands.
pub fn fill_again() -> Outcome {
    fill_pages(&templates()?, &read()?)
}

fn fill_pages(templates: &[Template], all: &All) -> Outcome {
    for page in pages()? {
        let text = load(&page)?;
        save(&page, &renewed(&page, &text, templates, all)?)?;
    }
    Ok(())
}

/// Do the pages say what the file says, and is that what is measured, of little ([`QUICK`]) or of all?
pub fn check(full: bool) -> Outcome {
    let templates = templates()?;
    let mut all = read()?;
    compare(&templates, &all)?;
    for (source, wanted) in sources(&templates)? {
        if full || QUICK.contains(&source.as_str()) {
            all.insert(source.clone(), measured(&source, &wanted)?);
        }
    }
    compare(&templates, &all)
}

fn compare(templates: &[Template], all: &All) -> Outcome {
    let mut used = BTreeSet::new();
    for page in pages()? {
        let text = load(&page)?;
        let new = renewed(&page, &text, templates, all)?;
        used.extend(marked(&text).into_iter().map(str::to_owned));
        if new == text {
            continue;
        }
        for line in new.lines().filter(|line| !text.lines().any(|old| old == *line)) {
            println!("+ {line}");
        }
        return Err(format!("{} is stale: cargo xtask figures", page.display()));
    }
    match templates.iter().find(|template| !used.contains(&template.name)) {
        Some(unused) => Err(format!("{TEMPLATES}/{}.md: no page has it", unused.name)),
        None => Ok(()),
    }
}

/// What the templates want of a command.
fn measured(source: &str, wanted: &[Place]) -> Result<Figures, String> {
    let found = measure(source)?;
    let mut kept = Figures::new();
    for place in wanted {
        let matching = found.iter().filter(|(name, _)| place.takes(name));
        let before = kept.len();
        // Six digits: the last ones of a double say nothing.
        kept.extend(matching.map(|(name, value)| (name.clone(), rounded(*value))));
        if kept.len() == before && !kept.keys().any(|name| place.takes(name)) {
            return Err(format!("{source}: no metric {}", place.metric));
        }
    }
    Ok(kept)
}

fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

fn templates() -> Result<Vec<Template>, String> {
    let folder = root().join(TEMPLATES);
    let listed = fs::read_dir(&folder).map_err(|e| format!("{TEMPLATES}: {e}"))?;
    let mut templates = Vec::new();
    for entry in listed.filter_map(Result::ok) {
        let path = entry.path();
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        templates.push(Template { name, text: load(&path)? });
    }
    templates.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(templates)
}

/// Command → the places that it fills.
fn sources(templates: &[Template]) -> Result<BTreeMap<String, Vec<Place>>, String> {
    let mut sources: BTreeMap<String, Vec<Place>> = BTreeMap::new();
    for template in templates {
        for place in places(&template.text).map_err(|e| format!("{}: {e}", template.name))? {
            sources.entry(place.source.clone()).or_default().push(place);
        }
    }
    Ok(sources)
}

/// The front page and the documents.
fn pages() -> Result<Vec<PathBuf>, String> {
    let listed = fs::read_dir(root().join("docs")).map_err(|e| format!("docs: {e}"))?;
    let names =
        listed.filter_map(Result::ok).map(|entry| Path::new("docs").join(entry.file_name()));
    let mut pages: Vec<_> = names.filter(|path| path.extension() == Some("md".as_ref())).collect();
    pages.sort();
    pages.insert(0, README.into());
    Ok(pages)
}

fn read() -> Result<All, String> {
    let text = load(Path::new(FILE))?;
    serde_json::from_str(&text).map_err(|e| format!("{FILE}: {e}"))
}

fn load(path: &Path) -> Result<String, String> {
    fs::read_to_string(root().join(path)).map_err(|e| format!("{}: {e}", path.display()))
}

fn save(path: &Path, text: &str) -> Outcome {
    fs::write(root().join(path), text).map_err(|e| format!("{}: {e}", path.display()))
}

/// Names of the tables in a page.
fn marked(text: &str) -> Vec<&str> {
    let marks = text.split("<!-- figures:").skip(1);
    marks.filter_map(|rest| Some(rest.split_once(" -->")?.0)).collect()
}

fn renewed(page: &Path, text: &str, templates: &[Template], all: &All) -> Result<String, String> {
    let mut new = text.to_owned();
    for name in marked(text) {
        let named = |e: String| format!("{}: {name}: {e}", page.display());
        let template = templates.iter().find(|template| template.name == name);
        let template = template.ok_or_else(|| named("no such table".into()))?;
        let table = fill(&template.text, all).map_err(named)?;
        new = replaced(&new, "figures", name, &table).map_err(named)?;
    }
    Ok(new)
}

/// The text with another table between the marks `<!-- KIND:NAME -->` and `<!-- /KIND -->`.
pub fn replaced(text: &str, kind: &str, name: &str, table: &str) -> Result<String, String> {
    let (begin, end) = (format!("<!-- {kind}:{name} -->\n"), format!("<!-- /{kind} -->"));
    let missing = || format!("no {} … {end}", begin.trim());
    let (before, rest) = text.split_once(&begin).ok_or_else(missing)?;
    let (_, after) = rest.split_once(&end).ok_or_else(missing)?;
    Ok(format!("{before}{begin}\n{}\n\n{end}{after}", table.trim_end()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_stands_between_the_markers_is_replaced() {
        let text = "a\n<!-- figures:x -->\nold\n<!-- /figures -->\nb\n";
        let new = replaced(text, "figures", "x", "new\n").unwrap_or_default();
        assert_eq!(new, "a\n<!-- figures:x -->\n\nnew\n\n<!-- /figures -->\nb\n");
        assert_eq!(replaced(&new, "figures", "x", "new\n").as_deref(), Ok(new.as_str()));
        assert!(replaced(text, "figures", "y", "new").is_err());
        assert_eq!(marked(text), ["x"]);
    }

    #[test]
    fn pages_and_file_agree_and_no_table_is_left_over() {
        let (templates, all) = (templates().unwrap_or_default(), read().unwrap_or_default());
        assert!(templates.len() > 2 && all.len() > 5);
        assert_eq!(compare(&templates, &all), Ok(()));
        let wanted = sources(&templates).unwrap_or_default();
        assert!(
            wanted.keys().eq(all.keys()),
            "a figure that nobody says, or one that nobody measured"
        );
    }
}
