//! One connection a peer: its rates, its lists and its answers are its own.

use super::services::{Files, Host, Services, general_crc};
use std::collections::VecDeque;
use std::net::SocketAddr;
use std::time::{Duration, Instant};
use tautline_firmware::mavlink::{
    COMPONENT_AUTOPILOT, Connection, ConnectionCounters, Identity, Signing,
};
use tautline_firmware::param::Params;
use tautline_firmware::time::Micros;
use tautline_firmware::vehicle::StepOutput;

/// Most peers at a time; with so many there is no room for a stranger.
const PEERS: usize = 32;
/// Datagrams of one peer that wait for the vehicle; a flood drops its own.
const WAITING: usize = 256;
/// A peer that was silent this long is gone.
const SILENCE: Duration = Duration::from_secs(5);

/// Somebody at an address, and the vehicle's side of the talk with them.
#[derive(Debug)]
pub struct Peer {
    /// Number of the link; 0 is the simulator's own.
    pub link: u8,
    /// Local port by which it came.
    pub port: usize,
    /// Its address.
    pub address: SocketAddr,
    /// The vehicle's side.
    pub connection: Connection,
    services: Services,
    /// Not read yet.
    inbox: VecDeque<Vec<u8>>,
    /// Not sent yet.
    outbox: Vec<Vec<u8>>,
    heard_at: Option<Instant>,
    /// The vehicle calls it before it has spoken.
    is_called: bool,
}

/// All peers.
#[derive(Debug, Default)]
pub struct Links {
    peers: Vec<Peer>,
    /// What those have sent and received that are gone.
    past: ConnectionCounters,
    /// What they may read.
    pub files: Files,
    /// As AUTOPILOT_VERSION tells it.
    pub identity: Identity,
    /// The key that they share, if there is one.
    pub signing: Option<Signing>,
    /// Datagrams dropped: of too many peers, or too many of one.
    pub dropped: u64,
}

impl Links {
    /// Nobody yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// An address that the vehicle calls: it hears heartbeats until it answers.
    pub fn call(&mut self, port: usize, address: SocketAddr) {
        self.add(port, address, true);
    }

    fn add(&mut self, port: usize, address: SocketAddr, is_called: bool) -> Option<&mut Peer> {
        if self.peers.len() >= PEERS {
            return None;
        }
        let is_free = |link: &u8| self.peers.iter().all(|peer| peer.link != *link);
        let link = (1..=u8::MAX).find(is_free)?;
        self.peers.push(Peer {
            link,
            port,
            address,
            connection: connection(link, self.identity),
            services: Services::default(),
            inbox: VecDeque::new(),
            outbox: Vec::new(),
            heard_at: None,
            is_called,
        });
        self.peers.last_mut()
    }

    /// A datagram that came in.
    pub fn arrive(&mut self, port: usize, address: SocketAddr, datagram: &[u8]) {
        let at = self.peers.iter().position(|p| p.port == port && p.address == address);
        let peer = match at {
            Some(at) => self.peers.get_mut(at),
            None => self.add(port, address, false),
        };
        match peer {
            Some(peer) if peer.inbox.len() < WAITING => {
                peer.heard_at = Some(Instant::now());
                peer.inbox.push_back(datagram.to_vec());
            }
            _ => self.dropped += 1,
        }
    }

    /// Forgets whom nobody has heard for a while; those that are called are called again.
    pub fn expire(&mut self) {
        for peer in &mut self.peers {
            if peer.heard_at.is_some_and(|at| at.elapsed() > SILENCE) {
                peer.heard_at = None;
                peer.begin_anew(self.identity, &mut self.past);
            }
        }
        self.peers.retain(|peer| peer.is_called || peer.heard_at.is_some());
    }

    /// Who came last in this step comes first in the next.
    pub fn take_turns(&mut self) {
        if !self.peers.is_empty() {
            self.peers.rotate_left(1);
        }
    }

    /// The vehicle started anew: every talk begins again.
    pub fn renew(&mut self) {
        for peer in &mut self.peers {
            peer.begin_anew(self.identity, &mut self.past);
        }
    }

    /// Those that are there, whether they have spoken or not.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = &mut Peer> {
        self.peers.iter_mut()
    }

    /// By its link.
    pub fn peer(&mut self, link: u8) -> Option<&mut Peer> {
        self.peers.iter_mut().find(|peer| peer.link == link)
    }

    /// What all have sent and received.
    #[must_use]
    pub fn counters(&self) -> ConnectionCounters {
        let all = self.peers.iter().map(|peer| peer.connection.counters());
        all.fold(self.past, ConnectionCounters::plus)
    }

    /// How many there are, whether they have spoken or not.
    #[must_use]
    pub fn count(&self) -> usize {
        self.peers.len()
    }
}

fn connection(link: u8, identity: Identity) -> Connection {
    let mut connection = Connection::of_link(link);
    connection.leave_services(general_crc());
    connection.identify(identity);
    connection
}

impl Peer {
    fn begin_anew(&mut self, identity: Identity, past: &mut ConnectionCounters) {
        let last = std::mem::replace(&mut self.connection, connection(self.link, identity));
        *past = past.plus(last.counters());
    }

    /// Hands a datagram to the vehicle's side; false if it holds what only the holder of the key may say.
    pub fn receive(
        &mut self,
        (now, datagram): (Micros, &[u8]),
        params: &Params,
        signing: &mut Option<Signing>,
    ) -> bool {
        let connection = &mut self.connection;
        let before = connection.counters().unsigned;
        let mut frames = Vec::new();
        connection.with_key(signing, |connection| {
            connection
                .receive_datagram(now, datagram, params, &mut |frame| frames.push(frame.to_vec()));
        });
        let is_admitted = connection.counters().unsigned == before;
        frames.iter().for_each(|frame| self.write(frame));
        is_admitted
    }

    /// Serves what a datagram asks of the vehicle's computer.
    pub fn serve(&mut self, datagram: &[u8], host: &Host) {
        let outbox = &mut self.outbox;
        self.services.take(datagram, host, &mut |frame| outbox.push(frame.to_vec()));
    }

    /// A millisecond of the transfers under way.
    pub fn transfer(&mut self, host: &Host) {
        let outbox = &mut self.outbox;
        self.services.step(host, &mut |frame| outbox.push(frame.to_vec()));
    }

    /// What the vehicle's step has to say to it.
    pub fn transmit(&mut self, out: &StepOutput, params: &Params, signing: &mut Option<Signing>) {
        let mut frames = Vec::new();
        self.connection.with_key(signing, |connection| {
            connection.transmit(out, params, &mut |frame| frames.push(frame.to_vec()));
        });
        frames.iter().for_each(|frame| self.write(frame));
    }

    /// The next datagram, if the vehicle has room for what it may ask.
    pub fn read(&mut self) -> Option<Vec<u8>> {
        if self.connection.has_room() { self.inbox.pop_front() } else { None }
    }

    /// A frame for it; who has not answered yet is only called.
    pub fn write(&mut self, frame: &[u8]) {
        // Of the autopilot: component and message.
        const HEARTBEAT: &[u8] = &[COMPONENT_AUTOPILOT, 0, 0, 0];
        if self.heard_at.is_some() || frame.get(6..10) == Some(HEARTBEAT) {
            self.outbox.push(frame.to_vec());
        }
    }

    /// Frames to send now.
    pub fn take_outbox(&mut self) -> Vec<Vec<u8>> {
        std::mem::take(&mut self.outbox)
    }
}
