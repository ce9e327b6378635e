//! A running flight and the pages that show and fly it.

use super::server::{Event, SEATS, open};
use super::{Ask, Asked, Message, Panel, Pilot, Snapshot, answers};
use crate::flight::Flight;
use crate::ground::Links;
use crate::scenario::Scenario;
use std::io::Write;
use std::net::SocketAddr;
use std::sync::mpsc::{Receiver, SyncSender};
use std::time::{Duration, Instant};
use tautline_firmware::mavlink::Parser;
use tungstenite::Utf8Bytes;

/// Between two snapshots, in real time.
const PERIOD: Duration = Duration::from_micros(33_333);
/// Port of the pages among [`Links`], beside those of the sockets.
const PORT: usize = usize::MAX;
/// Requests of all pages that are taken at once: a flood may not stop the world.
const AT_ONCE: usize = 256;
const HEARTBEAT: Duration = Duration::from_millis(500);

/// One page.
#[derive(Debug)]
struct Page {
    address: SocketAddr,
    seat: u8,
    pilot: Pilot,
    parser: Parser,
    outbox: SyncSender<Utf8Bytes>,
    beat_at: Option<Instant>,
}

impl Page {
    /// One that does not keep up misses it.
    fn send(&self, text: &Utf8Bytes) {
        let _ = self.outbox.try_send(text.clone());
    }

    fn note(&self, text: impl Into<String>) {
        self.send(&Message::note(text).json().into());
    }
}

/// The server, seen from the flight.
#[derive(Debug)]
pub struct View {
    port: u16,
    scenario: Scenario,
    events: Receiver<Event>,
    pages: Vec<Page>,
    due: Instant,
}

impl View {
    /// Opens the port for a flight of the scenario; 0 is any free one.
    ///
    /// # Errors
    /// A port that is taken, named.
    pub fn open(port: u16, scenario: &Scenario) -> Result<Self, String> {
        let (port, events) = open(port)?;
        let (scenario, pages) = (scenario.clone(), Vec::new());
        Ok(Self { port, scenario, events, pages, due: Instant::now() })
    }

    /// Where it is.
    #[must_use]
    pub fn url(&self) -> String {
        format!("http://127.0.0.1:{}/", self.port)
    }

    /// What pages have asked since the last call, and what is new for them.
    pub fn serve<W: Write>(&mut self, flight: &mut Flight<W>) {
        for _ in 0..AT_ONCE {
            match self.events.try_recv() {
                Ok(Event::Joined(address, outbox)) => self.join(address, outbox, flight),
                Ok(Event::Said(address, text)) => self.hear(address, &text, flight),
                Ok(Event::Left(address)) => self.pages.retain(|page| page.address != address),
                Err(_) => break,
            }
        }
        flight.world.links.expire();
        self.answer(&mut flight.world.links);
        let now = Instant::now();
        if now >= self.due {
            // Late is late: nothing is sent twice to catch up.
            self.due = (self.due + PERIOD).max(now);
            if !self.pages.is_empty() {
                let text = Message::Snapshot(Box::new(Snapshot::of(flight))).json().into();
                self.pages.iter().for_each(|page| page.send(&text));
            }
        }
    }

    fn join<W: Write>(
        &mut self,
        address: SocketAddr,
        outbox: SyncSender<Utf8Bytes>,
        flight: &Flight<W>,
    ) {
        let is_free = |seat: &u8| self.pages.iter().all(|page| page.seat != *seat);
        let Some(seat) = (0..SEATS as u8).find(is_free) else {
            let text = format!("{SEATS} pages are open already");
            let _ = outbox.try_send(Message::note(text).json().into());
            return;
        };
        let pilot = Pilot::new(seat, flight.world.vehicle.params().system_id as u8);
        let panel = Panel::of(&self.scenario, &flight.world, pilot.system());
        let page = Page { address, seat, pilot, parser: Parser::new(), outbox, beat_at: None };
        page.send(&Message::Panel(panel).json().into());
        self.pages.push(page);
    }

    fn hear<W: Write>(&mut self, address: SocketAddr, text: &str, flight: &mut Flight<W>) {
        let Some(page) = self.pages.iter_mut().find(|page| page.address == address) else {
            return;
        };
        let ask = match Ask::parse(text) {
            Ok(ask) => ask,
            Err(why) => return page.note(why),
        };
        let commander = flight.world.vehicle.output().commander;
        let links = &mut flight.world.links;
        // Whoever speaks is there: what it asks is nothing to a vehicle that has not heard its heartbeat.
        if page.beat_at.is_none_or(|at| at.elapsed() > HEARTBEAT) {
            page.beat_at = Some(Instant::now());
            let heartbeat = page.pilot.heartbeat();
            links.arrive(PORT, address, &heartbeat);
        }
        if ask == Ask::Beat {
            return;
        }
        match ask.act(&mut page.pilot, &mut flight.world.environment, commander) {
            Asked::Frame(frame) => flight.world.links.arrive(PORT, address, &frame),
            Asked::Note(text) => page.note(text),
        }
    }

    /// What the vehicle answers; its telemetry the snapshots show better.
    fn answer(&mut self, links: &mut Links) {
        for peer in links.iter_mut().filter(|peer| peer.port == PORT) {
            let page = self.pages.iter_mut().find(|page| page.address == peer.address);
            let frames = peer.take_outbox();
            let Some(page) = page else { continue };
            let mut notes = Vec::new();
            for frame in frames {
                answers(&mut page.parser, &frame, |text| notes.push(text));
            }
            notes.into_iter().for_each(|text| page.note(text));
        }
    }
}
