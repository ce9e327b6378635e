//! Does every source that code and documents name exist?
//!
//! Three kinds of reference are followed: a citation such as "`planar` section 7.4" to a heading with that number in
//! `docs/theory/`, a relative link of a Markdown document to a file and a heading in it, and the key of a paper in
//! brackets to its heading in `docs/papers.md`. And figures want a source at all: `claims.rs`.

use crate::{Outcome, claims, root};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};
use std::process::Command;

const THEORY: &str = "docs/theory/";
const PAPERS: &str = "docs/papers.md";
/// What is read for citations.
const KINDS: [&str; 4] = ["rs", "md", "toml", "py"];
/// Documents outside `docs/` whose links are followed.
const FRONT: [&str; 3] = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md"];

/// A file of the repository and what it says.
struct Source {
    path: String,
    text: String,
}

/// Reads the repository and says of each reference that leads nowhere where it stands.
pub fn check() -> Outcome {
    let (sources, paths) = repository()?;
    let (found, errors) = judge(&sources, &paths);
    for error in &errors {
        eprintln!("{error}");
    }
    if errors.is_empty() {
        println!("{found} citations, links and keys resolve");
        Ok(())
    } else {
        Err(format!("{} of {found} citations, links and keys do not resolve", errors.len()))
    }
}

/// The texts to read and the paths of all files, tracked or about to be.
fn repository() -> Result<(Vec<Source>, BTreeSet<String>), String> {
    let listed = Command::new("git")
        .args(["ls-files", "--cached", "--others", "--exclude-standard", "-z"])
        .current_dir(root())
        .output()
        .map_err(|e| format!("git: {e}"))?;
    if !listed.status.success() {
        return Err(format!("git ls-files: {}", String::from_utf8_lossy(&listed.stderr)));
    }
    let listing = String::from_utf8_lossy(&listed.stdout);
    let (mut sources, mut paths) = (Vec::new(), BTreeSet::new());
    for path in listing.split('\0').filter(|p| !p.is_empty()) {
        let file = root().join(path);
        // Deleted, but not yet from the index.
        if !file.exists() {
            continue;
        }
        paths.insert(path.to_owned());
        if KINDS.iter().any(|kind| path.ends_with(&format!(".{kind}"))) {
            let text = std::fs::read_to_string(&file).map_err(|e| format!("{path}: {e}"))?;
            sources.push(Source { path: path.to_owned(), text });
        }
    }
    Ok((sources, paths))
}

/// How many references there are, and those that do not resolve.
fn judge(sources: &[Source], paths: &BTreeSet<String>) -> (usize, Vec<String>) {
    let theory = Theory::read(sources);
    let keys = keys(sources);
    let anchors: BTreeMap<&str, BTreeSet<String>> = sources
        .iter()
        .filter(|s| s.path.ends_with(".md"))
        .map(|s| (s.path.as_str(), headings(&s.text).map(slug).collect()))
        .collect();
    let (mut found, mut errors) = (0, Vec::new());
    for source in sources {
        // The checker's own tests cite what does not exist.
        if source.path == "xtask/src/citations.rs" {
            continue;
        }
        let mut say = |line: usize, why: Option<String>| {
            found += 1;
            if let Some(why) = why {
                errors.push(format!("{}:{line}: {why}", source.path));
            }
        };
        let flat = Flat::new(source);
        for citation in citations(&flat, source) {
            for section in &citation.sections {
                say(citation.line, theory.lacks(&citation.name, section));
            }
        }
        for (line, key) in cited_keys(&flat) {
            let why = format!("{PAPERS} has no paper [{key}]");
            say(line, (!keys.contains(&key)).then_some(why));
        }
        let is_document = source.path.starts_with("docs/") && source.path.ends_with(".md");
        if source.path == FRONT[0] {
            for (line, words) in claims::unsourced(&source.text) {
                say(line, Some(format!("figures without a command or a link: {words}")));
            }
        }
        // The theory's tables are the specification itself.
        if is_document && !source.path.starts_with(THEORY) {
            for (line, heading) in claims::unsourced_sections(&source.text) {
                say(line, Some(format!("figures without a source under \"{heading}\"")));
            }
        }
        if is_document || FRONT.contains(&source.path.as_str()) {
            for (line, target) in links(&source.text) {
                say(line, broken(&source.path, &target, paths, &anchors));
            }
        }
    }
    (found, errors)
}

/// The numbered sections of each theory page. A page may be continued: `fullstate-excitation.md` belongs to
/// `fullstate`.
struct Theory {
    sections: BTreeMap<String, BTreeSet<String>>,
}

impl Theory {
    fn read(sources: &[Source]) -> Self {
        let mut sections: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
        for source in sources {
            if let Some(name) = theory_name(&source.path) {
                let numbers = headings(&source.text).filter_map(|h| number(h).map(|(n, _)| n));
                sections.entry(name.to_owned()).or_default().extend(numbers);
            }
        }
        Self { sections }
    }

    fn lacks(&self, name: &str, section: &str) -> Option<String> {
        match self.sections.get(name) {
            None => Some(format!("{THEORY}{name}.md does not exist")),
            Some(all) if all.contains(section) => None,
            Some(_) => Some(format!("{THEORY}{name}.md has no section {section}")),
        }
    }
}

/// What a file under `docs/theory/` is cited as.
fn theory_name(path: &str) -> Option<&str> {
    let stem = path.strip_prefix(THEORY)?.strip_suffix(".md")?;
    stem.split('-').next().filter(|name| name.bytes().all(|b| b.is_ascii_lowercase()))
}

/// The papers that have a heading: `## [KEY] …`.
fn keys(sources: &[Source]) -> BTreeSet<String> {
    let papers = sources.iter().find(|s| s.path == PAPERS);
    papers
        .into_iter()
        .flat_map(|s| headings(&s.text))
        .filter_map(|h| h.strip_prefix('[')?.split(']').next().map(str::to_owned))
        .collect()
}

/// Lines outside fenced code, with their numbers.
fn prose(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut is_code = false;
    (1..).zip(text.lines()).filter(move |(_, line)| {
        let is_fence = line.trim_start().starts_with("```");
        is_code ^= is_fence;
        !is_code && !is_fence
    })
}

fn headings(text: &str) -> impl Iterator<Item = &str> {
    prose(text).filter_map(|(_, line)| {
        let title = line.trim_start_matches('#');
        (title.len() < line.len() && title.starts_with(' ')).then_some(title.trim())
    })
}

/// A heading's anchor on GitHub.
fn slug(heading: &str) -> String {
    heading
        .chars()
        .filter_map(|c| match c {
            ' ' | '-' => Some('-'),
            '_' => Some('_'),
            c if c.is_alphanumeric() => Some(c),
            _ => None,
        })
        .flat_map(char::to_lowercase)
        .collect()
}

/// A text in one line: breaks, indents and comment marks are one space each.
struct Flat {
    text: String,
    /// Where each line begins in it.
    starts: Vec<usize>,
}

impl Flat {
    fn new(source: &Source) -> Self {
        let is_code = !source.path.ends_with(".md");
        let (mut text, mut starts) = (String::new(), Vec::new());
        for line in source.text.lines() {
            starts.push(text.len());
            let line = line.trim_end_matches('\\').trim();
            let line = if is_code {
                line.trim_start_matches(['/', '!', '#', '*'])
            } else {
                line.trim_start_matches(['>', '#'])
            };
            text.push_str(line.trim());
            text.push(' ');
        }
        Self { text, starts }
    }

    fn line(&self, at: usize) -> usize {
        self.starts.partition_point(|&start| start <= at)
    }
}

#[derive(Debug, PartialEq)]
struct Citation {
    line: usize,
    name: String,
    sections: Vec<String>,
}

/// Citations by name; within the theory, sections without a name are the page's own.
fn citations(flat: &Flat, source: &Source) -> Vec<Citation> {
    let own = theory_name(&source.path);
    let mut found = Vec::new();
    for (at, _) in flat.text.match_indices("ection") {
        let Some((before, after)) = flat.text.split_at_checked(at) else { continue };
        let Some(before) = before.strip_suffix(['s', 'S']) else { continue };
        let after = after.trim_start_matches("ection");
        let (is_plural, after) = after.strip_prefix('s').map_or((false, after), |a| (true, a));
        let Some(list) = after.strip_prefix(' ') else { continue };
        let sections = numbers(list, is_plural);
        if let Some(name) = cited_name(before).or(own)
            && !sections.is_empty()
        {
            found.push(Citation { line: flat.line(at), name: name.to_owned(), sections });
        }
    }
    found
}

/// The name in backticks, or linked, that a text ends with.
fn cited_name(before: &str) -> Option<&str> {
    let before = before.trim_end().trim_end_matches(',').trim_end_matches("'s");
    // [`planar`](theory/planar.md) section 4
    let before = match before.strip_suffix(')') {
        Some(link) => link.rsplit_once("](")?.0,
        None => before,
    };
    let name = before.strip_suffix('`')?.rsplit('`').next()?;
    let name = name.strip_suffix(".md").unwrap_or(name);
    (!name.is_empty() && name.bytes().all(|b| b.is_ascii_lowercase())).then_some(name)
}

/// The section numbers that a text begins with. A list with commas wants the plural before it.
fn numbers(text: &str, is_plural: bool) -> Vec<String> {
    let Some((first, mut rest)) = number(text) else { return Vec::new() };
    let mut all = vec![first];
    loop {
        let follow = |mark: &str| rest.strip_prefix(mark).and_then(number);
        let range = [" to ", "–", "-"].into_iter().find_map(follow);
        let list = [", and ", " and "].into_iter().find_map(follow);
        let commas = if is_plural { follow(", ") } else { None };
        let Some((next, after)) = range.clone().or(list).or(commas) else { return all };
        if range.is_some() {
            let from = all.last().and_then(|n| n.parse::<u32>().ok());
            if let (Some(from), Ok(to)) = (from, next.parse::<u32>()) {
                all.extend((from + 1..to).map(|n| n.to_string()));
            }
        }
        all.push(next);
        rest = after;
    }
}

/// A number such as 4, 7.2 or 13b at the start of a text, and what comes after it.
fn number(text: &str) -> Option<(String, &str)> {
    let is_digit = |c: char| c.is_ascii_digit();
    let mut end = text.len() - text.trim_start_matches(is_digit).len();
    if end == 0 {
        return None;
    }
    while let Some(deeper) = text.get(end..)?.strip_prefix('.') {
        let digits = deeper.len() - deeper.trim_start_matches(is_digit).len();
        if digits == 0 {
            break;
        }
        end += 1 + digits;
    }
    let mut letters = text.get(end..)?.chars();
    let (letter, beyond) = (letters.next(), letters.next());
    let is_suffixed = letter.is_some_and(|c| c.is_ascii_lowercase())
        && !beyond.is_some_and(char::is_alphanumeric);
    if letter.is_some_and(char::is_alphanumeric) && !is_suffixed {
        return None;
    }
    end += usize::from(is_suffixed);
    Some((text.get(..end)?.to_owned(), text.get(end..)?))
}

/// Keys in brackets: two capitals or more, two digits, as in `[AB12]`.
fn cited_keys(flat: &Flat) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    for (at, _) in flat.text.match_indices('[') {
        let Some(inside) = flat.text.get(at + 1..).and_then(|t| t.split(']').next()) else {
            continue;
        };
        // Rustdoc wants the bracket escaped.
        let key = inside.trim_end_matches('\\');
        let digits = key.trim_start_matches(|c: char| c.is_ascii_uppercase());
        let capitals = key.len() - digits.len();
        if capitals >= 2 && digits.len() == 2 && digits.bytes().all(|b| b.is_ascii_digit()) {
            found.push((flat.line(at), key.to_owned()));
        }
    }
    found
}

/// Targets of a document's links and pictures, without those to the web.
pub fn links(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    for (line, words) in prose(text) {
        // Every second piece is code.
        let words: String = words.split('`').step_by(2).collect();
        for piece in words.split("](").skip(1) {
            let Some(target) = piece.split([')', ' ']).next() else { continue };
            if !target.contains("://") && !target.starts_with("mailto:") {
                found.push((line, target.to_owned()));
            }
        }
    }
    found
}

/// Why a link of the document at `from` leads nowhere.
fn broken(
    from: &str,
    target: &str,
    paths: &BTreeSet<String>,
    anchors: &BTreeMap<&str, BTreeSet<String>>,
) -> Option<String> {
    let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
    let path = if file.is_empty() { Some(from.to_owned()) } else { resolve(from, file) };
    let Some(path) = path else { return Some(format!("{target} leads out of the repository")) };
    let is_folder = paths
        .range(format!("{path}/")..)
        .next()
        .is_some_and(|p| p.strip_prefix(path.as_str()).is_some_and(|below| below.starts_with('/')));
    if !paths.contains(&path) && !is_folder && !path.is_empty() {
        return Some(format!("{path} does not exist"));
    }
    let is_there = anchor.is_empty() || anchors.get(path.as_str())?.contains(anchor);
    (!is_there).then(|| format!("{path} has no heading #{anchor}"))
}

/// A path that is relative to a document, from the root.
pub fn resolve(from: &str, file: &str) -> Option<String> {
    let mut path = PathBuf::new();
    for part in Path::new(from).parent()?.join(file).components() {
        match part {
            Component::Normal(name) => path.push(name),
            Component::ParentDir => path.pop().then_some(())?,
            _ => {}
        }
    }
    Some(path.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLANAR: &str = "# Planar\n\n## 4. Maps\n\n### 6.2 Law\n\n```\n# 9 is code\n```\n\n## 13 Results\n\n### 13b Again\n";

    /// What is said of the texts, beside a page of theory and a list of papers.
    fn errors(texts: &[(&str, &str)]) -> Vec<String> {
        let given = [
            ("docs/theory/planar.md", PLANAR),
            ("docs/theory/fullstate.md", "## 1 Frames\n"),
            ("docs/theory/fullstate-more.md", "## 17 More\n\nFrom section 1.\n"),
            ("docs/papers.md", "# Papers\n\n## [AB12] A title\n"),
        ];
        let sources: Vec<Source> = given
            .iter()
            .chain(texts)
            .map(|&(path, text)| Source { path: path.to_owned(), text: text.to_owned() })
            .collect();
        let paths = sources.iter().map(|s| s.path.clone()).collect();
        judge(&sources, &paths).1
    }

    #[test]
    fn what_exists_resolves() {
        let code = "//! Law. `planar` sections 4, 6.2 and 13b; `fullstate` section 17.\n\
                    //! After `planar`\n//! sections 4 and\n    /// 13. From `planar`, \\[AB12\\], to `fullstate` section 1, 20 seeds.\n";
        assert_eq!(errors(&[("a.rs", code)]), [""; 0]);
        let page = "See [`planar`](theory/planar.md) section 4, [maps](theory/planar.md#4-maps),\n\
                    [both](theory), [AB12], [front](../README.md), [below](#here) and [web](https://a.b/c).\n\n\
                    `[code](nowhere.md)`\n\n```\n[code](nowhere.md)\n```\n\n## Here\n";
        assert_eq!(errors(&[("docs/a.md", page), ("README.md", "")]), [""; 0]);
    }

    #[test]
    fn a_missing_section_is_found_at_its_line() {
        assert_eq!(
            errors(&[("a.rs", "//! Good.\n//!\n//! `planar` section 5.\n")]),
            ["a.rs:3: docs/theory/planar.md has no section 5"]
        );
        assert_eq!(
            errors(&[("a.toml", "# `planar` sections 4, 6.2 and\n# 99\n")]),
            ["a.toml:1: docs/theory/planar.md has no section 99"]
        );
        assert_eq!(errors(&[("a.py", "# `planar` section 9\n")]).len(), 1, "a comment in code");
    }

    #[test]
    fn a_range_stands_for_all_between() {
        assert_eq!(
            errors(&[("a.md", "`planar` sections 4 to 6\n")]),
            [
                "a.md:1: docs/theory/planar.md has no section 5",
                "a.md:1: docs/theory/planar.md has no section 6"
            ]
        );
    }

    #[test]
    fn a_page_that_does_not_exist_is_found() {
        assert_eq!(
            errors(&[("a.rs", "/// `planer` section 4\n")]),
            ["a.rs:1: docs/theory/planer.md does not exist"]
        );
    }

    #[test]
    fn a_name_alone_cites_nothing() {
        assert_eq!(errors(&[("a.rs", "//! `planar`, and the section 99 of another.\n")]), [""; 0]);
    }

    #[test]
    fn within_the_theory_a_section_without_a_name_is_its_own() {
        assert_eq!(
            errors(&[(
                "docs/theory/inertial.md",
                "## 1 A\n\nSection 1, `planar` section 4, section 2.\n"
            )]),
            ["docs/theory/inertial.md:3: docs/theory/inertial.md has no section 2"]
        );
    }

    #[test]
    fn broken_links_and_keys_are_found() {
        assert_eq!(
            errors(&[(
                "docs/a.md",
                "[x](b.md)\n[y](theory/planar.md#5-no)\n\n[CD34] and [z](../../c)\n"
            )]),
            [
                "docs/a.md:4: docs/papers.md has no paper [CD34]",
                "docs/a.md:1: docs/b.md does not exist",
                "docs/a.md:2: docs/theory/planar.md has no heading #5-no",
                "docs/a.md:4: ../../c leads out of the repository",
            ]
        );
    }

    #[test]
    fn numbers_end_where_the_list_ends() {
        assert_eq!(numbers("6.1, 6.2.", true), ["6.1", "6.2"]);
        assert_eq!(numbers("7, 20 seeds", false), ["7"]);
        assert_eq!(numbers("13b and 4", false), ["13b", "4"]);
        assert_eq!(numbers("6 step 1", false), ["6"]);
        assert_eq!(numbers("2nd", false), [""; 0]);
    }

    #[test]
    fn anchors_are_those_of_github() {
        assert_eq!(slug("7.2 Coordinates: `z` and ζ"), "72-coordinates-z-and-ζ");
    }
}
