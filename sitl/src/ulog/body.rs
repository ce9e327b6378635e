//! One message's bytes → what it says.

use super::Data;

/// What a reader may want of a log.
#[derive(Clone, Debug)]
pub enum Message<'a> {
    /// A parameter at the start, or changed in flight.
    Parameter(&'a str, Value),
    /// A fact about the vehicle or its firmware: key and bytes.
    Info(&'a str, &'a [u8]),
    /// What the vehicle said.
    Text(Text<'a>),
    /// So many ms were not recorded.
    Dropout(u16),
    /// A sample.
    Data(Data<'a>),
}

/// A parameter's value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// `int32_t`
    Int(i32),
    /// `float`
    Float(f32),
}

/// A logged text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Text<'a> {
    /// As syslog has it: 0 is worst.
    pub level: u8,
    /// Who says it, where the log tells.
    pub tag: Option<u16>,
    /// µs.
    pub timestamp: u64,
    /// May be cut within a character.
    pub bytes: &'a [u8],
}

pub const SYNC: [u8; 8] = [0x2F, 0x73, 0x13, 0x20, 0x25, 0x0C, 0xBB, 0x12];

/// Names and definitions are printable.
pub fn plain(bytes: &[u8]) -> Option<&str> {
    let is_plain = !bytes.is_empty() && bytes.iter().all(|b| (b' '..=b'~').contains(b));
    std::str::from_utf8(bytes).ok().filter(|_| is_plain)
}

/// Length, `type name`, value.
pub fn keyed(body: &[u8]) -> Option<(&str, &str, &[u8])> {
    let (&length, rest) = body.split_first()?;
    let (key, value) = rest.split_at_checked(length.into())?;
    let (kind, name) = plain(key)?.split_once(' ')?;
    Some((kind, name, value))
}

pub fn parameter(body: &[u8]) -> Option<(&str, Value)> {
    let (kind, name, value) = keyed(body)?;
    let bytes = value.try_into().ok()?;
    let value = match kind {
        "int32_t" => Value::Int(i32::from_le_bytes(bytes)),
        "float" => Value::Float(f32::from_le_bytes(bytes)),
        _ => return None,
    };
    Some((name, value))
}

/// The levels are digits, and what is said has no control characters: chance would else make texts of any length of a
/// stream of bytes.
pub fn text(body: &[u8], is_tagged: bool) -> Option<Text<'_>> {
    let (&level, mut rest) = body.split_first()?;
    let level = level.checked_sub(b'0').filter(|level| *level < 8)?;
    let mut tag = None;
    if is_tagged {
        let (bytes, after) = rest.split_first_chunk()?;
        (tag, rest) = (Some(u16::from_le_bytes(*bytes)), after);
    }
    let (timestamp, bytes) = rest.split_first_chunk()?;
    let is_said = bytes.iter().all(|byte| !byte.is_ascii_control() || byte.is_ascii_whitespace());
    is_said.then(|| Text { level, tag, timestamp: u64::from_le_bytes(*timestamp), bytes })
}

/// Multi-id, message id and topic.
pub fn subscription(body: &[u8]) -> Option<(u8, u16, &str)> {
    let [instance, low, high, name @ ..] = body else { return None };
    Some((*instance, u16::from_le_bytes([*low, *high]), plain(name)?))
}

/// Message id and sample.
pub fn data(body: &[u8]) -> Option<(u16, &[u8])> {
    let (id, bytes) = body.split_first_chunk()?;
    Some((u16::from_le_bytes(*id), bytes))
}
