//! MAVLink 2: bytes in, bytes out.
//!
//! A connection owns the parser, the telemetry schedule and the parameter service; it turns what it receives
//! into [`Request`]s for the next step and tells what the step said. It never touches the vehicle.
//! Messages are matched by id and decoded one by one: the crate's enum over all messages costs 80 KB
//! on the board.
//!
//! Per tick of the host: [`Connection::receive`] with whatever arrived, [`Connection::next_request`] into the
//! step's input, [`Connection::transmit`] with the step's output.

mod admission;
mod budget;
mod capture;
mod checksum;
mod command;
mod frame;
mod global;
mod params;
mod receive;
mod schedule;
mod services;
mod signing;
mod telemetry;

pub use checksum::crc32;
pub use frame::{Frame, Losses, MAX_FRAME, Parser, Signature};
pub use signing::{KEY, Kept, NewKey, RESERVE, Sender, Signing};

use crate::param::Params;
use crate::sense::RawSensors;
use crate::signal::{Action, Event, Outcome, Reply, Request, Severity, Sticks, Ticket};
use crate::time::{Micros, Sample};
use crate::vehicle::StepOutput;
use admission::Told;
use budget::Budget;
use command::Calibration;
use heapless::Deque;
use mavlink::{MavlinkVersion, MessageData};
use schedule::Streams;
use telemetry::Outgoing;

/// Standard gravity by which MAVLink's tension in kg is meant, m/s².
const KG_TO_N: f32 = 9.806_65;

/// Where frames go.
pub type Sink<'a> = &'a mut dyn FnMut(&[u8]);

/// What somebody sends wrong again and again is told again after this time, µs.
const TOLD_AGAIN_US: u64 = 5_000_000;

/// Component id of the autopilot.
pub const COMPONENT_AUTOPILOT: u8 = 1;

/// Whether the vehicle presents itself as a PX4 (`MAV_AUTOPILOT_PX4`), with PX4's way to send integers.
fn speaks_px4(params: &Params) -> bool {
    const MAV_AUTOPILOT_PX4: u8 = 12;
    params.autopilot_type as u8 == MAV_AUTOPILOT_PX4
}

/// Which vehicle this is, and what it runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Identity {
    /// Of the hardware, or of the simulated vehicle.
    pub uid: u64,
    /// First eight bytes of the commit, as AUTOPILOT_VERSION has it; zeros where it is not known.
    pub revision: [u8; 8],
}

impl Identity {
    /// With the sixteen digits of a commit; any other text is none.
    #[must_use]
    pub fn new(uid: u64, revision: &str) -> Self {
        let number = u64::from_str_radix(revision, 16).ok().filter(|_| revision.len() == 16);
        Self { uid, revision: number.unwrap_or(0).to_le_bytes() }
    }
}

/// The vehicle has agreed to start anew: its host does it.
#[must_use]
pub fn is_to_reboot(out: &StepOutput) -> bool {
    let agreed = |reply: Reply| {
        reply.ticket.command == command::REBOOT && reply.outcome == Outcome::Accepted
    };
    out.reply.is_some_and(agreed)
}

/// What was received, and what was dropped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ConnectionCounters {
    /// Valid frames for us.
    pub received: u32,
    /// Valid frames that nobody here reads.
    pub ignored: u32,
    /// Bytes that belong to no valid frame.
    pub garbage_bytes: u32,
    /// Frames with a wrong checksum or an unknown id.
    pub bad_frames: u32,
    /// Valid frames whose content makes no sense (NaN set-points, unknown names or enum values).
    pub refused: u32,
    /// Frames that only the holder of the key may send, and that were not signed, or wrongly, or heard before.
    pub unsigned: u32,
    /// Requests that found the queue full.
    pub overflowed: u32,
    /// Frames sent.
    pub sent: u32,
}

impl ConnectionCounters {
    /// Of both.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self {
            received: self.received.wrapping_add(other.received),
            ignored: self.ignored.wrapping_add(other.ignored),
            garbage_bytes: self.garbage_bytes.wrapping_add(other.garbage_bytes),
            bad_frames: self.bad_frames.wrapping_add(other.bad_frames),
            refused: self.refused.wrapping_add(other.refused),
            unsigned: self.unsigned.wrapping_add(other.unsigned),
            overflowed: self.overflowed.wrapping_add(other.overflowed),
            sent: self.sent.wrapping_add(other.sent),
        }
    }
}

/// One MAVLink connection.
#[derive(Debug, Default)]
pub struct Connection {
    parser: Parser,
    session: Session,
}

/// A message that somebody asked for, with its argument.
#[derive(Clone, Copy, Debug)]
struct Wanted {
    id: u32,
    argument: u16,
    /// For the acknowledgement, if one is due.
    ticket: Option<Ticket>,
}

/// A connection but for the frames that come in, which borrow the parser while they are handled.
#[derive(Debug)]
struct Session {
    /// Of this connection, as the host counts them.
    link: u8,
    system: u8,
    sequence: u8,
    /// Ground station that has the command, while the vehicle is armed.
    commander: Option<u8>,
    /// The host answers for files, logs and a shell itself.
    is_served: bool,
    metadata_crc: Option<u32>,
    identity: Identity,
    budget: Budget,
    /// Its other end is a cable in its owner's hand.
    is_local: bool,
    /// As the last step said.
    is_armed: bool,
    signing: Option<Signing>,
    new_key: Option<NewKey>,
    told: Told,
    calibration: Calibration,
    /// When it was last told that a stream is wrong.
    told_at: Option<Micros>,
    counters: ConnectionCounters,
    heartbeat_at: Option<Micros>,
    sticks: Option<Sample<Sticks>>,
    /// Measured by others and told over MAVLink.
    sensors: RawSensors,
    requests: Deque<Request, 8>,
    events: Deque<Event, 16>,
    streams: Streams,
    /// Next parameter of a running list.
    listing: Option<u16>,
    /// Single parameters to tell.
    echoes: Deque<u16, 16>,
    /// Messages asked for once.
    once: Deque<Wanted, 16>,
}

impl Connection {
    /// Nothing received yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// One of several: `link` tells their requests, and the answers to them, apart.
    #[must_use]
    pub fn of_link(link: u8) -> Self {
        Self { session: Session { link, ..Session::default() }, ..Self::default() }
    }

    /// The host answers for files, logs, a shell and injected failures itself; this is the checksum of the file that
    /// describes the component.
    pub fn leave_services(&mut self, metadata_crc: u32) {
        self.session.is_served = true;
        self.session.metadata_crc = Some(metadata_crc);
    }

    /// As AUTOPILOT_VERSION tells it.
    pub fn identify(&mut self, identity: Identity) {
        self.session.identity = identity;
    }

    /// With a key the connection believes only who holds it, and signs what it says; others may look. Several
    /// connections of one vehicle share it: each has it while it listens or speaks.
    pub fn with_key(&mut self, signing: &mut Option<Signing>, then: impl FnOnce(&mut Self)) {
        core::mem::swap(signing, &mut self.session.signing);
        then(self);
        core::mem::swap(signing, &mut self.session.signing);
    }

    /// A cable in its owner's hand, USB: who holds it is believed unsigned, and sets the key.
    #[must_use]
    pub fn local(mut self) -> Self {
        self.session.is_local = true;
        self
    }

    /// A key that was set over the cable, once. Its host keeps it and then tells.
    pub fn take_new_key(&mut self) -> Option<NewKey> {
        self.session.new_key.take()
    }

    /// For whoever is at the other end, in its turn.
    pub fn tell(&mut self, event: Event) {
        self.session.queue_event(event);
    }

    /// A link that carries no more than a line of 57,600 baud, whatever rates are asked for.
    #[must_use]
    pub fn narrow(mut self) -> Self {
        self.session.budget.fix();
        self
    }

    /// Whether what a datagram may ask for finds room. A host that can wait does.
    #[must_use]
    pub fn has_room(&self) -> bool {
        let Session { requests, echoes, once, .. } = &self.session;
        requests.len() < requests.capacity() / 2
            && echoes.len() < echoes.capacity() / 2
            && once.len() < once.capacity() / 2
    }

    /// Takes bytes in chunks of any size. Answers that need nothing from the vehicle go to `sink` at once.
    pub fn receive(&mut self, now: Micros, bytes: &[u8], params: &Params, sink: Sink) {
        let Self { parser, session } = self;
        session.system = params.system_id as u8;
        parser.push(bytes, |frame| session.handle(now, frame, params, sink));
    }

    /// Takes one whole datagram.
    pub fn receive_datagram(&mut self, now: Micros, bytes: &[u8], params: &Params, sink: Sink) {
        self.receive(now, bytes, params, sink);
        let Self { parser, session } = self;
        parser.flush(|frame| session.handle(now, frame, params, sink));
    }

    /// The next request for the vehicle.
    pub fn next_request(&mut self) -> Option<Request> {
        self.session.requests.pop_front()
    }

    /// When a ground station last spoke.
    #[must_use]
    pub fn heartbeat_at(&self) -> Option<Micros> {
        self.session.heartbeat_at
    }

    /// The last joystick message.
    #[must_use]
    pub fn sticks(&self) -> Option<Sample<Sticks>> {
        self.session.sticks
    }

    /// What others measured and told, once.
    pub fn take_sensors(&mut self) -> RawSensors {
        core::mem::take(&mut self.session.sensors)
    }

    /// What was received and dropped.
    #[must_use]
    pub fn counters(&self) -> ConnectionCounters {
        let Losses { garbage_bytes, bad_frames } = self.parser.losses();
        ConnectionCounters { garbage_bytes, bad_frames, ..self.session.counters }
    }

    /// Answers, events and whatever telemetry is due.
    pub fn transmit(&mut self, out: &StepOutput, params: &Params, sink: Sink) {
        self.session.transmit(out, params, sink);
    }

    /// A STATUSTEXT; what is beyond 50 bytes is cut.
    pub fn say(&mut self, severity: Severity, text: &str, sink: Sink) {
        self.session.say(severity, text, sink);
    }
}

impl Default for Session {
    fn default() -> Self {
        Self {
            link: 0,
            system: 1,
            sequence: 0,
            commander: None,
            is_served: false,
            metadata_crc: None,
            identity: Identity::default(),
            budget: Budget::default(),
            is_local: false,
            is_armed: false,
            signing: None,
            new_key: None,
            told: Told::default(),
            calibration: Calibration::default(),
            told_at: None,
            counters: ConnectionCounters::default(),
            heartbeat_at: None,
            sticks: None,
            sensors: RawSensors::default(),
            requests: Deque::new(),
            events: Deque::new(),
            streams: Streams::default(),
            listing: None,
            echoes: Deque::new(),
            once: Deque::new(),
        }
    }
}

impl Session {
    fn transmit(&mut self, out: &StepOutput, params: &Params, sink: Sink) {
        self.system = params.system_id as u8;
        self.commander = out.commander;
        self.is_armed = out.is_armed;
        out.events.iter().for_each(|event| self.queue_event(*event));
        if let Some(reply) = &out.reply {
            self.answer(reply, sink);
        }
        if let Some(event) = self.events.pop_front() {
            self.send_text(&event, sink);
        }
        self.report_calibration(out, sink);
        self.send_echoes(params, sink);
        self.budget.refill(out.now);
        if let Some(signing) = &mut self.signing {
            signing.tick(out.now);
        }
        if self.budget.has_room() {
            self.send_list(out.now, params, sink);
        }
        while let Some(wanted) = self.once.pop_front() {
            self.send_wanted(&wanted, out, params, sink);
        }
        // Acknowledgements and texts always go; the rest waits for its share of the link, and behind a list.
        while self.has_turn(out.now)
            && let Some(id) = self.streams.next_due(out.now)
        {
            self.send_message(id, &Outgoing { out, params, argument: 0 }, sink);
        }
    }

    /// The oldest makes room.
    fn queue_event(&mut self, event: Event) {
        if self.events.is_full() {
            self.events.pop_front();
        }
        let _ = self.events.push_back(event);
    }

    /// Whether what goes out by itself may go now. A list of parameters on a narrow link is soon over.
    fn has_turn(&self, now: Micros) -> bool {
        const TURN_MS: u64 = 16;
        let waits = self.listing.is_some() && !self.budget.is_wide();
        self.budget.has_room() && (!waits || (now.0 / 1000).is_multiple_of(TURN_MS))
    }

    /// For the vehicle; nobody waits for an acknowledgement.
    fn queue(&mut self, frame: &Frame, action: Action) {
        let ticket = Ticket { link: self.link, ..frame.ticket(0) };
        if self.requests.push_back(Request { ticket, action }).is_err() {
            self.overflow();
        }
    }

    fn overflow(&mut self) {
        self.counters.overflowed = self.counters.overflowed.wrapping_add(1);
    }

    /// Whether this sender may say anything that concerns the flight.
    fn has_command(&self, frame: &Frame) -> bool {
        frame.system == self.system || self.commander.is_none_or(|system| system == frame.system)
    }

    fn refuse(&mut self) {
        self.counters.refused = self.counters.refused.wrapping_add(1);
    }

    /// Serialises one message of the crate.
    fn send<D: MessageData>(&mut self, message: &D, sink: Sink) {
        let mut payload = [0_u8; 255];
        let length = message.ser(MavlinkVersion::V2, &mut payload);
        self.send_raw(D::ID, D::EXTRA_CRC, payload.get(..length).unwrap_or(&[]), sink);
    }

    fn send_raw(&mut self, id: u32, extra_crc: u8, payload: &[u8], sink: Sink) {
        let mut bytes = [0_u8; MAX_FRAME];
        let header = frame::Header {
            sequence: self.sequence,
            system: self.system,
            component: COMPONENT_AUTOPILOT,
        };
        let to = (header, self.signing.is_some());
        let length = frame::encode(to, id, extra_crc, payload, &mut bytes).map(<[u8]>::len);
        let length = length.map(|length| match &mut self.signing {
            Some(signing) => signing.sign(self.link, &mut bytes, length),
            None => length,
        });
        if let Some(frame) = length.and_then(|length| bytes.get(..length)) {
            self.sequence = self.sequence.wrapping_add(1);
            self.counters.sent = self.counters.sent.wrapping_add(1);
            self.budget.spend(frame.len());
            sink(frame);
        }
    }
}
