//! Does every figure of the README say how it was had?
//!
//! In its section "Figures" each row of a table and each paragraph with a number wants a command, a link or, in a row,
//! "the same" as above. What `cargo xtask figures` writes between its marks has its commands there.

const SECTION: &str = "## Figures";

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
    fn a_command_a_link_the_row_above_or_a_made_table_will_do() {
        let page = "## Figures\n\nThe hold is 0.2 m:\n`cargo sitl`.\n\n<!-- figures:a -->\n\n| 4 m | 5 m |\n\n<!-- /figures -->\n\n\
                    | 1 m | [how](a.md) |\n| 2 m | the same |\n| 3 m | `cargo xtask cost` |\n";
        assert_eq!(unsourced(page), []);
    }
}
