//! A file's messages, one after the other, over what is damaged.
//!
//! There are no checksums: a message counts if it is what it claims to be, by length, name and type, and a sample
//! only if a message follows it, or the end. Where that fails, the next place is sought where three follow each
//! other; the synchronisation messages of some loggers are not needed.

use super::body::{self, Message, SYNC};
use super::format::Formats;
use super::layout::Layout;
use super::notes::Notes;
use super::{Data, Fault};
use std::collections::{BTreeSet, HashMap};
use std::rc::Rc;

const MAGIC: [u8; 7] = [b'U', b'L', b'o', b'g', 0x01, 0x12, 0x35];
/// With version and timestamp.
const HEADER: usize = 16;
/// Length and type of a message.
const HEAD: usize = 3;
/// Messages in a row that end a search.
const CHAIN: usize = 3;
/// Incompatible flag that we understand: data appended after the end, as a crash dump.
const APPENDED: u8 = 1;

struct Topic<'a> {
    name: &'a str,
    instance: u8,
    /// Missing where the definition is of no use.
    layout: Option<Rc<Layout<'a>>>,
}

/// A log in memory. Iterating gives its messages; then [`Log::notes`] and [`Log::topics`] are complete.
pub struct Log<'a> {
    bytes: &'a [u8],
    at: usize,
    /// Ends of the sections, the last first: what is appended goes on where a section ends.
    ends: Vec<usize>,
    formats: Formats<'a>,
    topics: HashMap<u16, Topic<'a>>,
    notes: Notes,
}

/// A message's type and content, and where the next begins.
struct Raw<'a> {
    kind: u8,
    body: &'a [u8],
    next: usize,
}

impl<'a> Log<'a> {
    /// Looks at the header.
    ///
    /// # Errors
    /// Not a ULog file, or one that says that older readers would misread it.
    pub fn new(bytes: &'a [u8]) -> Result<Self, Fault> {
        let fault = |at: usize, what: &str| Fault { at, what: what.into() };
        if bytes.get(..MAGIC.len()).is_none_or(|magic| magic != MAGIC) {
            return Err(fault(0, "not a ULog file"));
        }
        if bytes.len() < HEADER {
            return Err(fault(bytes.len(), "the log ends in its header"));
        }
        let mut log = Self {
            bytes,
            at: HEADER,
            ends: vec![bytes.len()],
            formats: Formats::default(),
            topics: HashMap::new(),
            notes: Notes::default(),
        };
        if let Some(Raw { kind: b'B', body, next }) = log.peek(HEADER)
            && let Some((flags, offsets)) = body.split_at_checked(16)
        {
            let unknown = flags.iter().enumerate().skip(8).any(|(i, flag)| {
                let known = if i == 8 { APPENDED } else { 0 };
                flag & !known != 0
            });
            if unknown {
                return Err(fault(HEADER, "the log has flags that this reader does not know"));
            }
            let (offsets, _) = offsets.as_chunks::<8>();
            // Sections are in order; what is not is no section.
            let mut last = next;
            for offset in offsets.iter().take(3) {
                let offset = usize::try_from(u64::from_le_bytes(*offset)).unwrap_or(usize::MAX);
                if offset > last && offset < bytes.len() {
                    log.ends.insert(0, offset);
                    last = offset;
                }
            }
            log.ends.sort_unstable_by(|a, b| b.cmp(a));
            log.at = next;
        }
        Ok(log)
    }

    /// What was wrong so far.
    #[must_use]
    pub fn notes(&self) -> &Notes {
        &self.notes
    }

    /// Names of all topics so far.
    #[must_use]
    pub fn topics(&self) -> BTreeSet<&'a str> {
        self.topics.values().map(|topic| topic.name).collect()
    }

    fn end(&self) -> usize {
        self.ends.last().copied().unwrap_or(self.bytes.len())
    }

    /// Whatever claims to be a message at `at` and ends in this section.
    fn peek(&self, at: usize) -> Option<Raw<'a>> {
        let [low, high, kind] = *self.bytes.get(at..)?.first_chunk::<HEAD>()?;
        let start = at + HEAD;
        let next = start + usize::from(u16::from_le_bytes([low, high]));
        let body = self.bytes.get(start..next).filter(|_| next <= self.end())?;
        Some(Raw { kind, body, next })
    }

    /// Whether a message is what it claims to be.
    fn is_sound(&self, raw: &Raw) -> bool {
        let body = raw.body;
        match raw.kind {
            // Longer ones may come, but not by much: chance makes one of any length.
            b'B' => (40..=64).contains(&body.len()),
            b'F' => body::plain(body).is_some_and(|text| text.contains(':')),
            b'I' => body::keyed(body).is_some(),
            b'M' | b'Q' => body.split_first().is_some_and(|(_, rest)| body::keyed(rest).is_some()),
            b'P' => body::parameter(body).is_some(),
            b'A' => body::subscription(body).is_some_and(|(_, _, name)| self.formats.knows(name)),
            b'R' | b'O' => body.len() == 2,
            b'L' => body::text(body, false).is_some(),
            b'C' => body::text(body, true).is_some(),
            b'S' => body == SYNC,
            b'D' => body::data(body).is_some_and(|(id, sample)| {
                self.topics.get(&id).is_some_and(|topic| match &topic.layout {
                    Some(layout) => layout.fits(sample.len()),
                    None => true,
                })
            }),
            _ => false,
        }
    }

    fn sound(&self, at: usize) -> Option<Raw<'a>> {
        self.peek(at).filter(|raw| self.is_sound(raw))
    }

    /// Whether so many messages follow each other from `at`, or fewer to the section's end.
    fn chain(&self, mut at: usize, count: usize) -> bool {
        for _ in 0..count {
            if at == self.end() {
                return true;
            }
            let Some(raw) = self.sound(at) else { return false };
            at = raw.next;
        }
        true
    }

    /// Over a message of a type, topic or form that this reader does not know, if all is well behind it.
    fn over_unknown(&self, at: usize) -> Option<usize> {
        let raw = self.peek(at)?;
        let is_message = raw.kind.is_ascii_uppercase() && !raw.body.is_empty();
        (is_message && raw.next < self.end() && self.chain(raw.next, CHAIN)).then_some(raw.next)
    }

    /// The next place from `at` where messages follow each other.
    fn recover(&self, at: usize) -> Option<usize> {
        (at..self.end()).find(|at| self.chain(*at, CHAIN))
    }

    /// Understands a message that is sound.
    fn take(&mut self, at: usize, raw: &Raw<'a>) -> Option<Message<'a>> {
        match raw.kind {
            b'F' => {
                if let Some(text) = body::plain(raw.body) {
                    self.formats.define(at, text);
                }
                None
            }
            b'A' => {
                let (instance, id, name) = body::subscription(raw.body)?;
                let layout = self.formats.layout(name, at);
                let layout = layout.map_err(|fault| self.notes.fault(fault)).ok();
                self.topics.insert(id, Topic { name, instance, layout });
                None
            }
            b'I' => body::keyed(raw.body).map(|(_, key, value)| Message::Info(key, value)),
            b'P' => body::parameter(raw.body).map(|(key, value)| Message::Parameter(key, value)),
            b'L' | b'C' => body::text(raw.body, raw.kind == b'C').map(Message::Text),
            b'O' => raw.body.first_chunk().map(|ms| Message::Dropout(u16::from_le_bytes(*ms))),
            b'D' => {
                let (id, bytes) = body::data(raw.body)?;
                let topic = self.topics.get(&id)?;
                let layout = Rc::clone(topic.layout.as_ref()?);
                let (topic, instance) = (topic.name, topic.instance);
                Some(Message::Data(Data { topic, instance, bytes, layout }))
            }
            // Parameters' defaults, longer facts, ends of topics, synchronisation.
            _ => None,
        }
    }

    fn skip_damage(&mut self, from: usize, search: usize) {
        match self.recover(search) {
            Some(to) => {
                self.notes.damage(from, to);
                self.at = to;
            }
            None => {
                // A section that is appended to may end anywhere.
                if self.ends.len() <= 1 {
                    self.notes.cut_at = Some(from);
                }
                self.at = self.end();
            }
        }
    }
}

impl<'a> Iterator for Log<'a> {
    type Item = Message<'a>;

    fn next(&mut self) -> Option<Message<'a>> {
        loop {
            let at = self.at;
            if at >= self.end() {
                if self.ends.len() <= 1 {
                    return None;
                }
                self.ends.pop();
                continue;
            }
            let Some(raw) = self.sound(at) else {
                match self.over_unknown(at) {
                    Some(next) => self.at = next,
                    None => self.skip_damage(at, at + 1),
                }
                continue;
            };
            // A cut message swallows the beginning of the next: then nothing sound follows it.
            let next = raw.next;
            if raw.kind == b'D'
                && next < self.end()
                && self.sound(next).is_none()
                && self.over_unknown(next).is_none()
                && self.recover(next).is_some()
            {
                self.skip_damage(at, at + 1);
                continue;
            }
            self.at = next;
            if let Some(message) = self.take(at, &raw) {
                return Some(message);
            }
        }
    }
}
