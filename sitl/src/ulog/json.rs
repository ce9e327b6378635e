//! A sample as JSON, and what its fields are as JSON Schema: nested and in arrays as the log declares them.

use super::Data;
use super::layout::{Field, Kind, Layout};
use super::scalar::Scalar;
use serde::ser::{Error, Serialize, SerializeMap, SerializeSeq, Serializer};
use serde_json::{Map, Value, json};

/// Fields that say something.
fn told<'a, 'l>(layout: &'l Layout<'a>) -> impl Iterator<Item = &'l Field<'a>> {
    layout.fields.iter().filter(|field| !field.is_padding())
}

struct Struct<'a>(&'a Layout<'a>, &'a [u8]);

impl Serialize for Struct<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let mut map = to.serialize_map(None)?;
        for field in told(self.0) {
            let bytes = self.1.get(field.offset..).unwrap_or(&[]);
            match (field.count, &field.kind) {
                (Some(count), Kind::Scalar(Scalar::Char)) => {
                    map.serialize_entry(field.name, &text(bytes.get(..count).unwrap_or(bytes)))?;
                }
                (Some(count), kind) => {
                    map.serialize_entry(field.name, &Array(kind, count, bytes))?
                }
                (None, kind) => map.serialize_entry(field.name, &One(kind, bytes))?,
            }
        }
        map.end()
    }
}

/// Up to its end, or the array's.
fn text(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len());
    String::from_utf8_lossy(bytes.get(..end).unwrap_or(bytes)).into_owned()
}

struct Array<'a>(&'a Kind<'a>, usize, &'a [u8]);

impl Serialize for Array<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let mut list = to.serialize_seq(Some(self.1))?;
        for index in 0..self.1 {
            let bytes = self.2.get(index * self.0.size()..).unwrap_or(&[]);
            list.serialize_element(&One(self.0, bytes))?;
        }
        list.end()
    }
}

struct One<'a>(&'a Kind<'a>, &'a [u8]);

impl Serialize for One<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let Self(kind, bytes) = self;
        let scalar = match kind {
            Kind::Nested(layout) => return Struct(layout, bytes).serialize(to),
            Kind::Scalar(scalar) => *scalar,
        };
        let number = scalar.number(bytes).ok_or_else(|| S::Error::custom("a sample too short"))?;
        match scalar {
            // As `f32`, 0.1 keeps its one digit.
            Scalar::F32 => to.serialize_f32(number as f32),
            Scalar::F64 => to.serialize_f64(number),
            Scalar::Bool => to.serialize_bool(number != 0.0),
            // Times and counters stay below 2^53.
            Scalar::U64 => to.serialize_u64(number as u64),
            _ => to.serialize_i64(number as i64),
        }
    }
}

fn schema(layout: &Layout) -> Value {
    let mut properties = Map::new();
    for field in told(layout) {
        let one = match &field.kind {
            Kind::Nested(layout) => schema(layout),
            Kind::Scalar(Scalar::Bool) => json!({ "type": "boolean" }),
            Kind::Scalar(Scalar::F32 | Scalar::F64) => json!({ "type": "number" }),
            Kind::Scalar(Scalar::Char) if field.count.is_some() => json!({ "type": "string" }),
            Kind::Scalar(_) => json!({ "type": "integer" }),
        };
        let all = match (field.count, &field.kind) {
            (None, _) | (_, Kind::Scalar(Scalar::Char)) => one,
            (Some(_), _) => json!({ "type": "array", "items": one }),
        };
        properties.insert(field.name.to_owned(), all);
    }
    json!({ "type": "object", "properties": properties })
}

impl Data<'_> {
    /// The sample as a JSON object; what is no number is `null`.
    ///
    /// # Errors
    /// A sample shorter than its fields.
    pub fn json(&self) -> serde_json::Result<Vec<u8>> {
        serde_json::to_vec(&Struct(&self.layout, self.bytes))
    }

    /// JSON Schema of [`Self::json`].
    #[must_use]
    pub fn json_schema(&self) -> Value {
        schema(&self.layout)
    }
}
