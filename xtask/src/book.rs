//! The documentation as a book, by mdBook: `target/book/index.html`.

use crate::citations::{self, links, resolve};
use crate::{Outcome, install, root, run};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

const SUMMARY: &str = "docs/SUMMARY.md";
/// What mdBook reads: the pages, with links that leave them led to the repository.
const STAGE: &str = "target/book-source";
const REPOSITORY: &str = env!("CARGO_PKG_REPOSITORY");

/// Follows every link, wants every page in the summary, and builds.
pub fn build() -> Outcome {
    citations::check()?;
    let pages = files("docs")?;
    let summary = read(SUMMARY)?;
    let missing = missing(&summary, &pages);
    if !missing.is_empty() {
        return Err(format!("not in {SUMMARY}: {}", missing.join(", ")));
    }
    stage(&pages)?;
    let mdbook = install::mdbook()?;
    run(&mdbook, &["build", STAGE, "--dest-dir", "target/book"])?;
    println!("target/book/index.html: {} pages", links(&summary).len());
    Ok(())
}

fn read(path: &str) -> Result<String, String> {
    fs::read_to_string(root().join(path)).map_err(|e| format!("{path}: {e}"))
}

/// All files below a folder, from the root.
fn files(folder: &str) -> Result<Vec<String>, String> {
    let mut found = Vec::new();
    for entry in fs::read_dir(root().join(folder)).map_err(|e| format!("{folder}: {e}"))? {
        let entry = entry.map_err(|e| format!("{folder}: {e}"))?;
        let path = format!("{folder}/{}", entry.file_name().to_string_lossy());
        if entry.path().is_dir() {
            found.extend(files(&path)?);
        } else {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

/// Pages that the summary does not name.
fn missing<'a>(summary: &str, pages: &'a [String]) -> Vec<&'a str> {
    let named: BTreeSet<String> =
        links(summary).iter().filter_map(|(_, target)| resolve(SUMMARY, target)).collect();
    let is_page = |path: &&str| path.ends_with(".md") && *path != SUMMARY;
    pages.iter().map(String::as_str).filter(is_page).filter(|p| !named.contains(*p)).collect()
}

/// A page as the book wants it: what is no page of it leads to the repository, and a folder's README is its index.
fn led_out(path: &str, text: &str) -> String {
    let mut text = text.to_owned();
    for (_, target) in links(&text) {
        let (file, _) = target.split_once('#').unwrap_or((&target, ""));
        let Some(to) = resolve(path, file).filter(|_| !file.is_empty()) else { continue };
        let link = if !to.starts_with("docs/") || to == SUMMARY {
            format!("{REPOSITORY}/blob/main/{to}")
        } else if let Some(folder) = file.strip_suffix("README.md") {
            format!("{folder}index.md")
        } else {
            continue;
        };
        text = text.replace(&format!("]({file}"), &format!("]({link}"));
    }
    text
}

fn stage(pages: &[String]) -> Outcome {
    let stage = root().join(STAGE);
    if stage.exists() {
        fs::remove_dir_all(&stage).map_err(|e| format!("{STAGE}: {e}"))?;
    }
    let put = |path: &str, bytes: &[u8]| -> Outcome {
        let to = stage.join(path);
        fs::create_dir_all(to.parent().unwrap_or(Path::new(""))).map_err(|e| e.to_string())?;
        fs::write(&to, bytes).map_err(|e| format!("{}: {e}", to.display()))
    };
    put("book.toml", read("book.toml")?.as_bytes())?;
    for path in pages {
        if path.ends_with(".md") && path != SUMMARY {
            put(path, led_out(path, &read(path)?).as_bytes())?;
        } else {
            put(path, &fs::read(root().join(path)).map_err(|e| format!("{path}: {e}"))?)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_that_the_summary_lacks_is_named() {
        let pages = ["docs/a.md", "docs/adr/b.md", "docs/c.svg", SUMMARY].map(str::to_owned);
        assert_eq!(missing("- [A](a.md)\n", &pages), ["docs/adr/b.md"]);
        assert_eq!(missing("- [A](a.md)\n  - [B](adr/b.md)\n", &pages), [""; 0]);
    }

    #[test]
    fn a_link_out_of_the_pages_leads_to_the_repository() {
        let page = "[a](../README.md#figures), [b](adr/b.md), [c](#here), [d](https://e.f)\n";
        let url = format!("{REPOSITORY}/blob/main/README.md#figures");
        assert_eq!(led_out("docs/x.md", page), page.replace("../README.md#figures", &url));
        let summary = format!("[all]({REPOSITORY}/blob/main/docs/SUMMARY.md)\n");
        assert_eq!(led_out("docs/README.md", "[all](SUMMARY.md)\n"), summary);
    }

    #[test]
    fn the_readme_of_a_folder_is_its_index() {
        assert_eq!(led_out("docs/a.md", "[t](theory/README.md#b)\n"), "[t](theory/index.md#b)\n");
    }
}
