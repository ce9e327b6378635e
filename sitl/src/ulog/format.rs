//! Formats as a file defines them, and what their fields come to.

use super::Fault;
use super::layout::{Field, Kind, LONGEST, Layout};
use super::scalar::Scalar;
use std::collections::HashMap;
use std::rc::Rc;

/// Formats within formats. PX4's go two deep.
const DEEPEST: usize = 8;

struct Definition<'a> {
    at: usize,
    fields: &'a str,
}

/// All definitions so far, and the layouts made of them.
#[derive(Default)]
pub struct Formats<'a> {
    definitions: HashMap<&'a str, Definition<'a>>,
    layouts: HashMap<&'a str, Result<Rc<Layout<'a>>, Fault>>,
}

impl<'a> Formats<'a> {
    /// Takes `name:type field;type field;`.
    pub fn define(&mut self, at: usize, text: &'a str) {
        if let Some((name, fields)) = text.split_once(':') {
            self.definitions.entry(name).or_insert(Definition { at, fields });
        }
    }

    pub fn knows(&self, name: &str) -> bool {
        self.definitions.contains_key(name)
    }

    /// Where the fields of `name` stand. `from`: who asks for it.
    pub fn layout(&mut self, name: &'a str, from: usize) -> Result<Rc<Layout<'a>>, Fault> {
        let layout = self.resolve(name, from, &mut Vec::new());
        // A refusal too is found once, however often the file asks.
        self.layouts.entry(name).or_insert(layout).clone()
    }

    fn resolve(
        &mut self,
        name: &'a str,
        from: usize,
        within: &mut Vec<&'a str>,
    ) -> Result<Rc<Layout<'a>>, Fault> {
        if let Some(known) = self.layouts.get(name) {
            return known.clone();
        }
        let Some(&Definition { at, fields }) = self.definitions.get(name) else {
            return Err(Fault { at: from, what: format!("`{name}` is no type or format") });
        };
        let fault = |what: String| Fault { at, what: format!("format `{name}` {what}") };
        if within.contains(&name) {
            return Err(fault("contains itself".into()));
        }
        if within.len() >= DEEPEST {
            return Err(fault(format!("is nested more than {DEEPEST} deep")));
        }
        within.push(name);
        let mut layout = Layout::default();
        for text in fields.split(';').filter(|text| !text.is_empty()) {
            let (kind, field) = text
                .split_once(' ')
                .ok_or_else(|| fault(format!("has `{text}`, expected a type and a name")))?;
            let (kind, count) = array(kind)
                .ok_or_else(|| fault(format!("has `{text}`, expected a length in brackets")))?;
            let kind = match Scalar::named(kind) {
                Some(scalar) => Kind::Scalar(scalar),
                None => Kind::Nested(self.resolve(kind, at, within)?),
            };
            let size = kind.size().saturating_mul(count.unwrap_or(1));
            let offset = layout.size;
            layout.size = offset.saturating_add(size);
            if layout.size > LONGEST {
                return Err(fault(format!("is longer than a message can be, {LONGEST} bytes")));
            }
            layout.padding = if field.starts_with("_padding") { size } else { 0 };
            layout.fields.push(Field { name: field, kind, count, offset });
        }
        within.pop();
        let layout = Rc::new(layout);
        self.layouts.insert(name, Ok(Rc::clone(&layout)));
        Ok(layout)
    }
}

/// `float[3]` → `float` and 3.
fn array(kind: &str) -> Option<(&str, Option<usize>)> {
    let Some((kind, rest)) = kind.split_once('[') else { return Some((kind, None)) };
    Some((kind, Some(rest.strip_suffix(']')?.parse().ok()?)))
}
