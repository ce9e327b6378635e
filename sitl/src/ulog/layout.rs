//! Where in a sample its fields stand.

use super::scalar::Scalar;
use std::rc::Rc;

/// A message's length is two bytes.
pub const LONGEST: usize = u16::MAX as usize;

/// One format's fields.
#[derive(Debug, Default)]
pub struct Layout<'a> {
    pub fields: Vec<Field<'a>>,
    pub size: usize,
    /// Bytes at the end that a logger may leave out.
    pub padding: usize,
}

#[derive(Debug)]
pub struct Field<'a> {
    pub name: &'a str,
    pub kind: Kind<'a>,
    /// Of an array.
    pub count: Option<usize>,
    pub offset: usize,
}

#[derive(Debug)]
pub enum Kind<'a> {
    Scalar(Scalar),
    Nested(Rc<Layout<'a>>),
}

impl Field<'_> {
    /// Room that only brings the next field into line.
    pub fn is_padding(&self) -> bool {
        self.name.starts_with("_padding")
    }
}

impl Kind<'_> {
    pub fn size(&self) -> usize {
        match self {
            Self::Scalar(scalar) => scalar.size(),
            Self::Nested(layout) => layout.size,
        }
    }
}

impl Layout<'_> {
    /// Whether a sample may be so long.
    pub fn fits(&self, length: usize) -> bool {
        (self.size - self.padding..=self.size).contains(&length)
    }

    fn field(&self, name: &str) -> Option<&Field<'_>> {
        self.fields.iter().find(|field| field.name == name)
    }

    /// Offset and type of a number.
    pub fn find(&self, path: &str) -> Option<(usize, Scalar)> {
        let (first, rest) = match path.split_once('.') {
            Some((first, rest)) => (first, Some(rest)),
            None => (path, None),
        };
        let (name, index) = match first.split_once('[') {
            Some((name, index)) => (name, Some(index.strip_suffix(']')?.parse::<usize>().ok()?)),
            None => (first, None),
        };
        let field = self.field(name)?;
        let index = match (field.count, index) {
            (None, None) => 0,
            (Some(count), Some(index)) if index < count => index,
            _ => return None,
        };
        let at = field.offset + index * field.kind.size();
        match (&field.kind, rest) {
            (Kind::Scalar(scalar), None) => Some((at, *scalar)),
            (Kind::Nested(layout), Some(rest)) => {
                let (within, scalar) = layout.find(rest)?;
                Some((at + within, scalar))
            }
            _ => None,
        }
    }

    /// All its numbers: path, offset and type, in the order of the bytes. Padding is none of them.
    pub fn numbers(&self) -> Vec<(String, usize, Scalar)> {
        let mut all = Vec::new();
        for field in self.fields.iter().filter(|field| !field.is_padding()) {
            for index in 0..field.count.unwrap_or(1) {
                let at = field.offset + index * field.kind.size();
                let name = match field.count {
                    Some(_) => format!("{}[{index}]", field.name),
                    None => field.name.to_owned(),
                };
                match &field.kind {
                    Kind::Scalar(scalar) => all.push((name, at, *scalar)),
                    Kind::Nested(layout) => {
                        all.extend(layout.numbers().into_iter().map(|(path, within, scalar)| {
                            (format!("{name}.{path}"), at + within, scalar)
                        }))
                    }
                }
            }
        }
        all
    }

    /// Offset, type and length of an array of numbers.
    pub fn array(&self, name: &str) -> Option<(usize, Scalar, usize)> {
        let field = self.field(name)?;
        match field.kind {
            Kind::Scalar(scalar) => Some((field.offset, scalar, field.count?)),
            Kind::Nested(_) => None,
        }
    }
}
