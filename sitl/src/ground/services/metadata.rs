//! Component metadata: what each parameter means, from the firmware's own table.

use serde_json::{Value, json};
use std::sync::OnceLock;
use tautline_firmware::mavlink::crc32;
use tautline_firmware::param::{ALIASES, DOCS, Kind, META};

const GENERAL: &str = "component_general.json";
const PARAMETERS: &str = "parameters.json";
/// Files there are.
pub const NAMES: [&str; 2] = [GENERAL, PARAMETERS];
/// `COMP_METADATA_TYPE_PARAMETER`.
const PARAMETER: u8 = 1;

/// Of the file that a ground station asks for first, as COMPONENT_METADATA tells it.
#[must_use]
pub fn general_crc() -> u32 {
    file(GENERAL).map_or(0, |bytes| crc32(0, &bytes))
}

/// A file by its name.
pub fn file(name: &str) -> Option<Vec<u8>> {
    match name {
        GENERAL => Some(general()),
        PARAMETERS => Some(parameters().to_vec()),
        _ => None,
    }
}

fn general() -> Vec<u8> {
    let text = json!({
        "version": 1,
        "metadataTypes": [{
            "type": PARAMETER,
            "uri": format!("mftp://etc/extras/{PARAMETERS}"),
            "fileCrc": crc32(0, parameters()),
        }],
    });
    text.to_string().into_bytes()
}

fn kind(kind: Kind) -> &'static str {
    match kind {
        Kind::Real => "Float",
        Kind::Int => "Int32",
    }
}

/// The shortest decimal of a single, as the table writes it.
fn number(x: f32) -> Value {
    x.to_string().parse::<f64>().map_or(Value::Null, Value::from)
}

fn parameters() -> &'static [u8] {
    static TEXT: OnceLock<Vec<u8>> = OnceLock::new();
    TEXT.get_or_init(|| {
        let ours = META.iter().zip(DOCS).map(|(meta, doc)| {
            let text = doc.text.trim();
            let short = text.split(['.', ';', ':']).next().unwrap_or(text);
            json!({
                "name": meta.name,
                "type": kind(meta.kind),
                "group": meta.group.title(),
                "category": "Standard",
                "shortDesc": short,
                "longDesc": text,
                "units": doc.unit,
                "default": number(meta.default),
                "min": number(meta.min),
                "max": number(meta.max),
                "decimalPlaces": 4,
                "rebootRequired": false,
            })
        });
        let theirs = ALIASES.iter().map(|alias| {
            json!({
                "name": alias.name,
                "type": kind(alias.kind),
                "group": "Ground station",
                "category": "System",
                "shortDesc": "For set-up pages that read it",
            })
        });
        let all: Vec<_> = ours.chain(theirs).collect();
        json!({ "version": 1, "parameters": all }).to_string().into_bytes()
    })
}
