//! All parameters in one file, as clients of ArduPilot read them: names share what they begin with.

use tautline_firmware::param::{ALIASES, Kind, META, Params};

/// First word of the file.
const MAGIC: u16 = 0x671B;
/// Kinds of value.
const INT32: u8 = 3;
const FLOAT: u8 = 4;

/// The file.
pub fn pack(params: &Params) -> Vec<u8> {
    let ours = META
        .iter()
        .zip(0..)
        .map(|(meta, index)| (meta.name, meta.kind, params.get(index).unwrap_or(meta.default)));
    let theirs = ALIASES.iter().map(|alias| (alias.name, alias.kind, alias.value(params)));
    let mut all: Vec<_> = ours.chain(theirs).collect();
    all.sort_by_key(|(name, ..)| *name);
    let count = u16::try_from(all.len()).unwrap_or(u16::MAX).to_le_bytes();
    let mut bytes: Vec<u8> = [MAGIC.to_le_bytes(), count, count].concat();
    let mut last = "";
    for (name, kind, value) in all {
        let alike = last.bytes().zip(name.bytes()).take_while(|(a, b)| a == b).count();
        // At least one byte of each name is written.
        let alike = alike.min(name.len().saturating_sub(1));
        let rest = name.get(alike..).unwrap_or(name);
        let lengths = alike as u8 | ((rest.len() as u8).saturating_sub(1) << 4);
        let (kind, value) = match kind {
            Kind::Int => (INT32, (value as i32).to_le_bytes()),
            Kind::Real => (FLOAT, value.to_le_bytes()),
        };
        bytes.extend([kind, lengths]);
        bytes.extend(rest.bytes());
        bytes.extend(value);
        last = name;
    }
    bytes
}
