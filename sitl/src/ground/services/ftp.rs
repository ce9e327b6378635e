//! MAVLink FTP, to read: what would write is refused as protected.

use super::files::{Entry, Open};
use super::{Answers, Host};
use mavlink::dialects::common::FILE_TRANSFER_PROTOCOL_DATA;
use tautline_firmware::mavlink::{Frame, crc32};
use tautline_firmware::time::Micros;

/// Head and data of a payload, bytes.
const HEAD: usize = 12;
const DATA: usize = 239;
const PAYLOAD: usize = HEAD + DATA;
/// Where the payload begins in the message.
const START: usize = 3;
/// Packets of a burst before the client asks again, and in a millisecond.
const BURST: u32 = 200;
const AT_ONCE: usize = 4;

/// Operations.
const NONE: u8 = 0;
const TERMINATE: u8 = 1;
const RESET: u8 = 2;
const LIST: u8 = 3;
const OPEN: u8 = 4;
const READ: u8 = 5;
const CREATE: u8 = 6;
const RENAME: u8 = 13;
const CRC: u8 = 14;
const BURST_READ: u8 = 15;
const ACK: u8 = 128;
const NAK: u8 = 129;

/// A session that its client has not used for so long is given to another, µs.
const IDLE_US: u64 = 10_000_000;

/// Why not.
#[derive(Clone, Copy, Debug)]
#[repr(u8)]
enum Wrong {
    Failed = 1,
    InvalidSize = 3,
    InvalidSession = 4,
    NoSessions = 5,
    EndOfFile = 6,
    UnknownCommand = 7,
    Protected = 9,
    NotFound = 10,
}

/// A request as it came.
#[derive(Clone, Copy, Debug)]
struct Request {
    sequence: u16,
    session: u8,
    opcode: u8,
    offset: u32,
    /// Who asked.
    system: u8,
    component: u8,
}

/// A burst under way.
#[derive(Clone, Copy, Debug)]
struct Burst {
    request: Request,
    /// Bytes in a packet.
    size: usize,
    left: u32,
}

/// The one session of an address, behind which there may be several clients.
#[derive(Debug, Default)]
pub struct Ftp {
    session: Option<Session>,
}

/// An open file.
#[derive(Debug)]
struct Session {
    /// As its client calls it.
    number: u8,
    /// System and component.
    client: [u8; 2],
    used_at: Micros,
    open: Open,
    burst: Option<Burst>,
}

impl Request {
    fn of(frame: &Frame) -> Self {
        let at = |offset: usize| START + offset;
        Self {
            sequence: frame.word(at(0)),
            session: frame.byte(at(2)),
            opcode: frame.byte(at(3)),
            offset: frame.int(at(8)) as u32,
            system: frame.system,
            component: frame.component,
        }
    }

    fn client(&self) -> [u8; 2] {
        [self.system, self.component]
    }

    fn answer(&self, code: u8, is_last: bool, data: &[u8], answers: &mut Answers) {
        let mut payload = [0; PAYLOAD];
        let [low, high] = self.sequence.wrapping_add(1).to_le_bytes();
        let size = u8::try_from(data.len()).unwrap_or(u8::MAX);
        let head = [low, high, self.session, code, size, self.opcode, u8::from(is_last), 0];
        let bytes = head.into_iter().chain(self.offset.to_le_bytes());
        for (to, from) in payload.iter_mut().zip(bytes.chain(data.iter().copied())) {
            *to = from;
        }
        answers.send(&FILE_TRANSFER_PROTOCOL_DATA {
            target_network: 0,
            target_system: self.system,
            target_component: self.component,
            payload,
        });
    }
}

impl Ftp {
    /// Answers a request, and begins a burst.
    pub fn take(&mut self, frame: &Frame, host: &Host, answers: &mut Answers) {
        let request = Request::of(frame);
        let size = usize::from(frame.byte(START + 4));
        let data: Vec<u8> = (0..size.min(DATA)).map(|at| frame.byte(START + HEAD + at)).collect();
        let name = String::from_utf8_lossy(&data);
        let name = name.split('\0').next().unwrap_or("");
        let own = self.session.as_mut().filter(|session| session.client == request.client());
        if let Some(session) = own {
            session.used_at = host.out.now;
        }
        let done = match request.opcode {
            _ if size > DATA => Err(Wrong::InvalidSize),
            NONE => Ok(Vec::new()),
            TERMINATE | RESET => {
                self.session.take_if(|session| session.client == request.client());
                Ok(Vec::new())
            }
            LIST => list(host, name, request.offset),
            OPEN => self.open(&request, name, host),
            READ => self.session(&request).and_then(|session| session.read(request.offset, size)),
            BURST_READ => match self.session(&request) {
                Ok(session) => {
                    let size = if size == 0 { DATA } else { size };
                    session.burst = Some(Burst { request, size, left: BURST });
                    return;
                }
                Err(wrong) => Err(wrong),
            },
            CRC => match host.files.open(name, host.params) {
                Some(mut open) => sum(&mut open).map(|crc| crc.to_le_bytes().to_vec()),
                None => Err(Wrong::NotFound),
            },
            CREATE..=RENAME => Err(Wrong::Protected),
            _ => Err(Wrong::UnknownCommand),
        };
        match done {
            Ok(data) => request.answer(ACK, false, &data, answers),
            Err(wrong) => request.answer(NAK, false, &[wrong as u8], answers),
        }
    }

    /// Begins a session in the place of the client's own, or of one that nobody uses any more.
    fn open(&mut self, request: &Request, name: &str, host: &Host) -> Result<Vec<u8>, Wrong> {
        let (client, now) = (request.client(), host.out.now);
        let is_taken =
            |session: &Session| session.client != client && now.since(session.used_at) < IDLE_US;
        if self.session.as_ref().is_some_and(is_taken) {
            return Err(Wrong::NoSessions);
        }
        let open = host.files.open(name, host.params).ok_or(Wrong::NotFound)?;
        let size = open.size().to_le_bytes().to_vec();
        let number = request.session;
        self.session = Some(Session { number, client, used_at: now, open, burst: None });
        Ok(size)
    }

    /// The one that a request is about.
    fn session(&mut self, request: &Request) -> Result<&mut Session, Wrong> {
        let is_its = |session: &&mut Session| {
            session.number == request.session && session.client == request.client()
        };
        self.session.as_mut().filter(is_its).ok_or(Wrong::InvalidSession)
    }

    /// Some packets of a burst.
    pub fn step(&mut self, now: Micros, answers: &mut Answers) {
        let Some(session) = &mut self.session else { return };
        for _ in 0..AT_ONCE {
            let Some(mut burst) = session.burst.take() else { return };
            session.used_at = now;
            let request = burst.request;
            match session.read(request.offset, burst.size) {
                Ok(data) => {
                    burst.left -= 1;
                    request.answer(ACK, burst.left == 0, &data, answers);
                    burst.request.sequence = request.sequence.wrapping_add(1);
                    burst.request.offset += data.len() as u32;
                    session.burst = (burst.left > 0).then_some(burst);
                }
                Err(wrong) => request.answer(NAK, true, &[wrong as u8], answers),
            }
        }
    }
}

impl Session {
    fn read(&mut self, offset: u32, size: usize) -> Result<Vec<u8>, Wrong> {
        let mut data = vec![0; size.min(DATA)];
        let count = self.open.read(offset, &mut data).map_err(|_| Wrong::Failed)?;
        if count == 0 {
            return Err(Wrong::EndOfFile);
        }
        data.truncate(count);
        Ok(data)
    }
}

/// From an entry on, as many as fit.
fn list(host: &Host, name: &str, offset: u32) -> Result<Vec<u8>, Wrong> {
    let entries = host.files.list(name).ok_or(Wrong::NotFound)?;
    let mut data = Vec::new();
    for entry in entries.iter().skip(offset as usize) {
        let line = match entry {
            Entry::Folder(name) => format!("D{name}\0"),
            Entry::File(name, size) => format!("F{name}\t{size}\0"),
        };
        if data.len() + line.len() > DATA {
            break;
        }
        data.extend(line.bytes());
    }
    if data.is_empty() { Err(Wrong::EndOfFile) } else { Ok(data) }
}

fn sum(open: &mut Open) -> Result<u32, Wrong> {
    let (mut crc, mut offset, mut block) = (0, 0, vec![0; 1 << 16]);
    loop {
        let count = open.read(offset, &mut block).map_err(|_| Wrong::Failed)?;
        if count == 0 {
            return Ok(crc);
        }
        crc = crc32(crc, block.get(..count).unwrap_or(&[]));
        offset += count as u32;
    }
}
