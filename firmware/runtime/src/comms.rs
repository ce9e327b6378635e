//! MAVLink on every port, and the flight log: everything that only reads what the step said.

use crate::inbox::Inbox;
use crate::keys::KeyBox;
use heapless::String;
use tautline_firmware::log::{self, FlightLog};
use tautline_firmware::mavlink::{Connection, Identity, Kept, NewKey, Signing, is_to_reboot};
use tautline_firmware::param::Params;
use tautline_firmware::signal::{Event, Severity};
use tautline_firmware::time::Micros;
use tautline_firmware::vehicle::StepOutput;

/// Where bytes go; false when there is no room for all of them, and then none went.
pub type Port<'a> = &'a mut dyn FnMut(&[u8]) -> bool;

/// One connection per port, and the log of the present flight.
#[derive(Debug)]
pub struct Comms<const PORTS: usize> {
    connections: [Connection; PORTS],
    /// Which connections have been told the notice.
    told: [bool; PORTS],
    notice: Option<String<50>>,
    params: Params,
    signing: Option<Signing>,
    /// In force when it is kept.
    new_key: Option<NewKey>,
    log: Log,
    reboot_at: Option<Micros>,
}

/// From the answer to the restart, µs.
const REBOOT_US: u64 = 200_000;

/// The log from arming to disarming.
#[derive(Debug, Default)]
struct Log {
    log: Option<FlightLog>,
    /// Since when messages have been left out.
    full_since: Option<Micros>,
}

impl<const PORTS: usize> Comms<PORTS> {
    /// `notice` goes to everybody who connects: what was left of a crash, say. `kept` is the signing key.
    #[must_use]
    pub fn new(
        params: Params,
        identity: Identity,
        notice: Option<String<50>>,
        kept: Option<&Kept>,
    ) -> Self {
        let connection = |port: usize| {
            let mut connection = Connection::of_link(port as u8);
            connection.identify(identity);
            // The first is USB; behind it are serial lines, which may be radios.
            if port == 0 { connection.local() } else { connection.narrow() }
        };
        Self {
            connections: core::array::from_fn(connection),
            told: [false; PORTS],
            notice,
            params,
            signing: kept.and_then(Signing::resume),
            new_key: None,
            log: Log::default(),
            reboot_at: None,
        }
    }

    /// Bytes that arrived at a port.
    pub fn receive(&mut self, port: usize, now: Micros, bytes: &[u8], out: Port) {
        if let Some(connection) = self.connections.get_mut(port) {
            connection.with_key(&mut self.signing, |connection| {
                connection.receive(now, bytes, &self.params, &mut |frame| {
                    out(frame);
                });
            });
        }
    }

    /// What of signing is to be in flash, and what came of it.
    pub fn keep(&mut self, keys: &mut KeyBox, is_armed: bool) {
        for new in self.connections.iter_mut().filter_map(Connection::take_new_key) {
            let new = new.after(self.signing.as_ref());
            keys.want(new.kept());
            self.new_key = Some(new);
        }
        if let Some((kept, is_stored)) = keys.take_done() {
            self.note_kept(&kept, is_stored);
        }
        let is_free = self.new_key.is_none() && !is_armed;
        if let Some(kept) = self.signing.as_ref().and_then(Signing::to_keep).filter(|_| is_free) {
            keys.want(kept);
        }
    }

    fn note_kept(&mut self, kept: &Kept, is_stored: bool) {
        let Some(new) = self.new_key.take_if(|new| new.kept() == *kept) else {
            return match &mut self.signing {
                Some(signing) if is_stored => signing.note_kept(kept),
                Some(signing) => signing.keep_nothing(),
                None => {}
            };
        };
        let (severity, text) = if is_stored {
            self.signing = new.in_force();
            let is_on = self.signing.is_some();
            (Severity::Info, if is_on { "Signing key set" } else { "Signing off" })
        } else {
            (Severity::Error, "Signing key not set: the flash fails")
        };
        let event = Event { severity, text, amount: None };
        self.connections.iter_mut().for_each(|connection| connection.tell(event));
    }

    /// Hands over what the connections received.
    pub fn collect(&mut self, inbox: &mut Inbox) {
        for connection in &mut self.connections {
            inbox.receive(connection);
        }
    }

    /// The parameters have changed.
    pub fn set_params(&mut self, params: &Params) {
        self.params = *params;
    }

    /// Tells a port what the step said.
    pub fn transmit(&mut self, port: usize, out: &StepOutput, sink: Port) {
        let (Some(connection), Some(told)) =
            (self.connections.get_mut(port), self.told.get_mut(port))
        else {
            return;
        };
        let mut send = |frame: &[u8]| {
            sink(frame);
        };
        connection.with_key(&mut self.signing, |connection| {
            connection.transmit(out, &self.params, &mut send);
            if !*told && connection.heartbeat_at().is_some() {
                *told = true;
                if let Some(notice) = &self.notice {
                    connection.say(Severity::Critical, notice, &mut send);
                }
            }
        });
    }

    /// Whether it is time to start anew, as somebody asked: what was said of it has gone out.
    pub fn is_to_reboot(&mut self, out: &StepOutput) -> bool {
        if is_to_reboot(out) {
            self.reboot_at = Some(Micros(out.now.0 + REBOOT_US));
        }
        self.reboot_at.is_some_and(|at| out.now >= at) && !out.is_armed
    }

    /// Logs what the step said, from arming to disarming.
    pub fn log(&mut self, out: &StepOutput, file: &mut LogFile) {
        self.log.write(out, &self.params, file);
    }
}

/// Room at which a log that was full goes on, bytes: twice what a step may have to say, so that the next fits too.
pub const STEP_BYTES: usize = 2 * log::STEP_BYTES;

/// What a log is told.
pub struct LogFile<'a> {
    /// There is room for a whole step: [`STEP_BYTES`].
    pub has_room: bool,
    /// A new file shall begin; false when it cannot yet.
    pub begin: &'a mut dyn FnMut() -> bool,
    /// Bytes for it.
    pub write: Port<'a>,
    /// It ends.
    pub end: &'a mut dyn FnMut(),
}

impl Log {
    fn write(&mut self, out: &StepOutput, params: &Params, file: &mut LogFile) {
        if out.is_armed && self.log.is_none() && (file.begin)() {
            self.full_since = None;
            let write = &mut file.write;
            self.log = Some(FlightLog::start(out.now, params, |_, _| {}, &mut |bytes| {
                write(bytes);
            }));
        }
        let Some(log) = &mut self.log else { return };
        let mut fits = true;
        let mut write = |bytes: &[u8]| fits &= (file.write)(bytes);
        // With less room the mark would go and what follows it would not: a mark a millisecond instead of one a gap.
        if let Some(since) = self.full_since.take_if(|_| file.has_room || !out.is_armed) {
            let gap = (out.now.0.saturating_sub(since.0) / 1000).min(u64::from(u16::MAX)) as u16;
            log.ulog.dropout(gap, &mut write);
        }
        if self.full_since.is_none() {
            log.write(out, &mut write);
            self.full_since = (!fits).then_some(out.now);
        }
        if !out.is_armed {
            (file.end)();
            self.log = None;
        }
    }
}
