//! Does every figure say how it was had?
//!
//! In the README's section "Figures" each row of a table and each paragraph with a number wants a command, a link or, in a
//! row, "the same" as above. What `cargo xtask figures` writes between its marks has its commands there. In a document each
//! section with a number and a unit wants a command, a link, or the file, parameter or listing that it speaks of.

const SECTION: &str = "## Figures";
/// What makes a number a figure.
const UNITS: [&str; 18] = [
    "m",
    "m/s",
    "m/s²",
    "cm",
    "N",
    "V",
    "g",
    "kg",
    "s",
    "ms",
    "°",
    "%",
    "Hz",
    "kHz",
    "kB",
    "KiB",
    "MB",
    "instructions",
];

/// Line and heading of a document's sections that have figures and no source.
pub fn unsourced_sections(text: &str) -> Vec<(usize, String)> {
    let mut sections: Vec<(usize, String, String)> = vec![(1, String::new(), String::new())];
    let (mut is_listing, mut is_made) = (false, false);
    for (number, line) in (1..).zip(text.lines()) {
        is_listing ^= line.starts_with("```");
        // What a task writes between its marks has its command there.
        is_made = line.starts_with("<!-- table:") || is_made && !line.starts_with("<!-- /table");
        if is_made {
            continue;
        }
        if line.starts_with('#') && !is_listing {
            sections.push((number, line.to_owned(), String::new()));
        } else if let Some((_, _, words)) = sections.last_mut() {
            words.push_str(line);
            words.push('\n');
        }
    }
    let is_bare = |(_, _, words): &&(usize, String, String)| {
        has_figure(words)
            && !["`", "](", "<!-- figures:"].iter().any(|source| words.contains(source))
    };
    let found = sections.iter().filter(is_bare);
    found.map(|(line, heading, _)| (*line, heading.clone())).collect()
}

/// A number with a unit behind it.
fn has_figure(words: &str) -> bool {
    let is_number = |word: &str| word.starts_with(|c: char| c.is_ascii_digit());
    let words: Vec<&str> = words.split_whitespace().collect();
    let pairs = words.iter().zip(words.iter().skip(1));
    let is_unit = |word: &str| UNITS.contains(&word.trim_end_matches(['.', ',', ';', ':', ')']));
    words.iter().any(|word| is_number(word) && word.contains('°'))
        || pairs.into_iter().any(|(number, unit)| is_number(number) && is_unit(unit))
}

/// Line and words of what has a number and no source.
pub fn unsourced(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    for (line, words) in blocks(text) {
        if words.contains(|c: char| c.is_ascii_digit()) && !has_source(&words) {
            found.push((line, words));
        }
    }
    found
}

/// Rows and paragraphs of the section that a hand wrote.
fn blocks(text: &str) -> Vec<(usize, String)> {
    let section = (1..)
        .zip(text.lines())
        .skip_while(|(_, line)| *line != SECTION)
        .skip(1)
        .take_while(|(_, line)| !line.starts_with("## "));
    let (mut blocks, mut is_open, mut is_made) = (Vec::<(usize, String)>::new(), false, false);
    for (number, line) in section {
        if line.starts_with("<!--") {
            is_made = line.starts_with("<!-- figures:");
        }
        let is_prose = !line.trim().is_empty() && !line.starts_with(['|', '<', '!']);
        match blocks.last_mut() {
            Some((_, words)) if is_prose && is_open => {
                words.push(' ');
                words.push_str(line);
            }
            _ if !is_made && (is_prose || line.starts_with('|')) => {
                blocks.push((number, line.to_owned()));
            }
            _ => {}
        }
        is_open = is_prose;
    }
    blocks
}

fn has_source(words: &str) -> bool {
    ["`cargo ", "](", "| the same |"].iter().any(|source| words.contains(source))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_without_a_command_is_found_in_prose_and_in_a_table() {
        let page = "9 m elsewhere\n\n## Figures\n\nWords.\n\nThe hold is\n0.2 m.\n\n| | how |\n|---|---|\n| 3 m | somehow |\n\n## More\n\n5 m\n";
        let lines: Vec<usize> = unsourced(page).into_iter().map(|(line, _)| line).collect();
        assert_eq!(lines, [7, 12]);
    }

    #[test]
    fn a_section_with_figures_wants_a_source_and_one_without_does_not() {
        let page = "# A\n\nTwo of 3 rotors.\n\n## B\n\nIt holds to 0.2 m.\n\n## C\n\n5 N by `TET_TENSION`.\n\n```\n# no heading\n```\n";
        assert_eq!(unsourced_sections(page), [(5, "## B".to_owned())]);
    }

    #[test]
    fn a_command_a_link_the_row_above_or_a_made_table_will_do() {
        let page = "## Figures\n\nThe hold is 0.2 m:\n`cargo sitl`.\n\n<!-- figures:a -->\n\n| 4 m | 5 m |\n\n<!-- /figures -->\n\n\
                    | 1 m | [how](a.md) |\n| 2 m | the same |\n| 3 m | `cargo xtask cost` |\n";
        assert_eq!(unsourced(page), []);
    }
}
