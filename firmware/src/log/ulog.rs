//! The ULog container, version 1: magic, definitions, data.

use crate::time::Micros;
use heapless::Vec;

/// Where bytes go.
pub type Sink<'a> = &'a mut dyn FnMut(&[u8]);

/// Longest message body.
const MAX_BODY: usize = 512;
/// Size and kind of a message.
pub(super) const HEAD: usize = 3;
/// The package's version as PX4 counts: a byte each for major, minor, patch, and 64 for an early version.
const RELEASE: u32 = u32::from_be_bytes([
    number(env!("CARGO_PKG_VERSION_MAJOR")),
    number(env!("CARGO_PKG_VERSION_MINOR")),
    number(env!("CARGO_PKG_VERSION_PATCH")),
    64,
]);
const MAGIC: [u8; 8] = [b'U', b'L', b'o', b'g', 0x01, 0x12, 0x35, 0x01];

const fn number(digits: &str) -> u8 {
    let (mut rest, mut n) = (digits.as_bytes(), 0);
    while let [digit, more @ ..] = rest {
        n = n * 10 + (*digit - b'0');
        rest = more;
    }
    n
}

/// A type that ULog knows.
pub trait Field {
    /// C name, without array brackets.
    const TYPE: &'static str;
    /// Array length; `None` for a single value.
    const LENGTH: Option<u8> = None;
    /// Little-endian bytes.
    fn put(&self, out: &mut Body);
}

/// Body of one message; what does not fit is cut, which no topic here comes near.
#[derive(Debug, Default)]
pub struct Body(Vec<u8, MAX_BODY>);

impl Body {
    // For size: every field of every topic comes through here.
    #[inline(never)]
    fn bytes(&mut self, bytes: &[u8]) {
        let room = MAX_BODY - self.0.len();
        let _ = self.0.extend_from_slice(bytes.get(..bytes.len().min(room)).unwrap_or(&[]));
    }
    /// Length, type and name, as before the value of an information or a parameter.
    fn keyed(&mut self, kind: &[u8], name: &str) {
        self.bytes(&[(kind.len() + 1 + name.len()) as u8]);
        self.bytes(kind);
        self.bytes(b" ");
        self.bytes(name.as_bytes());
    }
    /// A text with its key.
    fn words(&mut self, key: &str, value: &str) {
        let mut kind = Self::default();
        kind.bytes(b"char[");
        kind.digits(value.len() as u8);
        kind.bytes(b"]");
        self.keyed(&kind.0, key);
        self.bytes(value.as_bytes());
    }
    fn digits(&mut self, n: u8) {
        if n >= 10 {
            self.digits(n / 10);
        }
        self.bytes(&[b'0' + n % 10]);
    }
}

macro_rules! field {
    ($($t:ty, $name:literal;)+) => {$(
        impl Field for $t {
            const TYPE: &'static str = $name;
            fn put(&self, out: &mut Body) {
                out.bytes(&self.to_le_bytes());
            }
        }
    )+};
}
field! {
    u64, "uint64_t"; u32, "uint32_t"; u16, "uint16_t"; u8, "uint8_t"; i8, "int8_t"; i32, "int32_t"; f32, "float";
}

impl Field for bool {
    const TYPE: &'static str = "bool";
    fn put(&self, out: &mut Body) {
        out.bytes(&[u8::from(*self)]);
    }
}

impl<T: Field, const N: usize> Field for [T; N] {
    const TYPE: &'static str = T::TYPE;
    const LENGTH: Option<u8> = Some(N as u8);
    fn put(&self, out: &mut Body) {
        for value in self {
            value.put(out);
        }
    }
}

/// One field of a topic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FieldMeta {
    /// C name of its type, without array brackets.
    pub kind: &'static str,
    /// Array length; `None` for a single value.
    pub length: Option<u8>,
    /// Its name.
    pub name: &'static str,
}

/// What a topic is made of.
pub trait Record {
    /// Its fields, the time stamp first.
    const FIELDS: &'static [FieldMeta];
    /// What it is, in words. Not in an image: nothing there asks for them.
    const DOC: &'static str;
    /// Each field in words, with its unit.
    const FIELD_DOCS: &'static [&'static str];
    /// Of a message with one, head and topic included.
    const BYTES: usize;
    /// The fields in that order.
    fn encode(&self, out: &mut Body);
}

/// Declares a record, and where it is given name, period and source also the vehicle's topic of it: see
/// `topics.rs`.
macro_rules! record {
    (
        $(#[doc = $doc:literal])+
        $name:ident { $($(#[doc = $field_doc:literal])+ $field:ident : $t:ty,)+ }
        $(topic $topic:literal every $every:expr $(, on change $change:literal)?;
        of |$out:ident $(, $scale:ident)?| $of:expr)?
    ) => {
        $(#[doc = $doc])+
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $name {
            /// µs since boot.
            pub timestamp: u64,
            $($(#[doc = $field_doc])+ pub $field: $t,)+
        }
        impl $crate::log::Record for $name {
            const FIELDS: &'static [$crate::log::FieldMeta] = &[
                $crate::log::FieldMeta { kind: "uint64_t", length: None, name: "timestamp" },
                $($crate::log::FieldMeta {
                    kind: <$t as $crate::log::Field>::TYPE,
                    length: <$t as $crate::log::Field>::LENGTH,
                    name: stringify!($field),
                },)+
            ];
            const DOC: &'static str = concat!($($doc),+);
            const FIELD_DOCS: &'static [&'static str] =
                &[" µs since boot.", $(concat!($($field_doc),+),)+];
            const BYTES: usize = $crate::log::ulog::HEAD + 2 + 8 $(+ size_of::<$t>())+;
            fn encode(&self, out: &mut $crate::log::ulog::Body) {
                $crate::log::Field::put(&self.timestamp, out);
                $($crate::log::Field::put(&self.$field, out);)+
            }
        }
        $(impl $crate::log::FlightTopic for $name {
            const NAME: &'static str = $topic;
            const EVERY: $crate::log::Period = $every;
            $(const ON_CHANGE: bool = $change;)?
            fn of($out: &$crate::vehicle::StepOutput, scale: &$crate::log::Scale) -> Option<Self> {
                $(let $scale = scale;)?
                let _ = scale;
                $of
            }
        })?
    };
}
pub(crate) use record;

/// Handle of a topic that may be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Topic(u16);

/// Writer. Call [`Self::start`], then [`Self::define`] and [`Self::parameter`], then
/// [`Self::subscribe`], then write.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ulog {
    topics: u16,
    /// Bytes written.
    pub bytes: u64,
}

impl Ulog {
    /// File header, flag bits and who wrote it.
    pub fn start(&mut self, now: Micros, system: &str, sink: Sink) {
        let mut header = Body::default();
        header.bytes(&MAGIC);
        header.bytes(&now.0.to_le_bytes());
        sink(&header.0);
        self.bytes += 16;
        self.message(b'B', sink, &mut |body| body.bytes(&[0; 40]));
        self.info("sys_name", system, sink);
        self.info("ver_sw", env!("CARGO_PKG_VERSION"), sink);
        self.info_number("ver_sw_release", RELEASE, sink);
    }

    /// A fact about the vehicle or its firmware, in words.
    pub fn info(&mut self, key: &str, value: &str, sink: Sink) {
        self.message(b'I', sink, &mut |body| body.words(key, value));
    }

    /// A fact in more words than one message holds.
    pub fn long_info(&mut self, key: &str, value: &str, sink: Sink) {
        const PART: usize = 200;
        let (mut rest, mut is_more) = (value, false);
        while !rest.is_empty() {
            let (part, after) = rest.split_at(rest.floor_char_boundary(PART));
            self.message(b'M', sink, &mut |body| {
                body.bytes(&[u8::from(is_more)]);
                body.words(key, part);
            });
            (rest, is_more) = (after, true);
        }
    }

    /// A fact in numbers.
    pub fn info_number<T: Field>(&mut self, key: &str, value: T, sink: Sink) {
        self.message(b'I', sink, &mut |body| {
            body.keyed(T::TYPE.as_bytes(), key);
            value.put(body);
        });
    }

    /// Defines a topic of this name.
    pub fn define<R: Record>(&mut self, name: &str, sink: Sink) {
        self.define_fields(name, R::FIELDS, sink);
    }

    /// See [`Self::define`].
    pub fn define_fields(&mut self, name: &str, fields: &[FieldMeta], sink: Sink) {
        self.message(b'F', sink, &mut |body| {
            body.bytes(name.as_bytes());
            body.bytes(b":");
            for field in fields {
                body.bytes(field.kind.as_bytes());
                if let Some(length) = field.length {
                    body.bytes(b"[");
                    body.digits(length);
                    body.bytes(b"]");
                }
                body.bytes(b" ");
                body.bytes(field.name.as_bytes());
                body.bytes(b";");
            }
        });
    }

    /// Records a parameter's value.
    pub fn parameter<T: Field>(&mut self, name: &str, value: T, sink: Sink) {
        self.message(b'P', sink, &mut |body| {
            body.keyed(T::TYPE.as_bytes(), name);
            value.put(body);
        });
    }

    /// Ends the definitions; the topic may be written from now on.
    pub fn subscribe(&mut self, name: &str, sink: Sink) -> Topic {
        let id = self.topics;
        self.topics += 1;
        self.message(b'A', sink, &mut |body| {
            body.bytes(&[0]);
            body.bytes(&id.to_le_bytes());
            body.bytes(name.as_bytes());
        });
        Topic(id)
    }

    /// One record.
    pub fn write<R: Record>(&mut self, topic: Topic, record: &R, sink: Sink) {
        self.message(b'D', sink, &mut |body| {
            body.bytes(&topic.0.to_le_bytes());
            record.encode(body);
        });
    }

    /// Says that messages were left out for want of room, for so long, ms.
    pub fn dropout(&mut self, duration_ms: u16, sink: Sink) {
        self.message(b'O', sink, &mut |body| body.bytes(&duration_ms.to_le_bytes()));
    }

    /// One line of text with a syslog level (0 emergency to 7 debug).
    pub fn text(&mut self, now: Micros, level: u8, text: &str, sink: Sink) {
        self.message(b'L', sink, &mut |body| {
            body.bytes(&[b'0' + level.min(7)]);
            body.bytes(&now.0.to_le_bytes());
            body.bytes(text.as_bytes());
        });
    }

    /// One call of the sink per message, so that one that finds no room can be left out whole.
    fn message(&mut self, kind: u8, sink: Sink, fill: &mut dyn FnMut(&mut Body)) {
        let mut message = Body::default();
        message.bytes(&[0, 0, kind]);
        fill(&mut message);
        let [low, high] = (message.0.len().saturating_sub(HEAD) as u16).to_le_bytes();
        for (slot, byte) in message.0.iter_mut().zip([low, high]) {
            *slot = byte;
        }
        sink(&message.0);
        self.bytes += message.0.len() as u64;
    }
}
