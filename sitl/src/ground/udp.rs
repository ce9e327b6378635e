//! MAVLink over UDP, on PX4's ports: 18570+i → 14550 for ground stations, 14580+i → 14540+i for
//! programs. The vehicle calls first; whoever answers is a peer of its own.

use super::Links;
use std::io;
use std::net::{IpAddr, Ipv4Addr, SocketAddr, UdpSocket};

const LONGEST: usize = 2_048;
/// Datagrams taken per call and socket: a flood may not stop the world.
const AT_ONCE: usize = 256;
/// Where ground stations listen.
pub const STATIONS: u16 = 14_550;

/// Both sockets.
#[derive(Debug)]
pub struct Udp {
    sockets: Vec<UdpSocket>,
    homes: Vec<SocketAddr>,
    /// Who may speak, if not everybody: bound for the sake of one station, the vehicle hears no stranger.
    heard: Option<Vec<IpAddr>>,
    /// Datagrams that could not be sent.
    pub send_errors: u64,
}

impl Udp {
    /// Binds for instance `i`, and calls the usual ports of the loopback and further `stations`. Without an address of
    /// this machine to bind `at`, only those that are called are heard.
    ///
    /// # Errors
    /// A port that is taken, named.
    pub fn bind(
        instance: u16,
        at: Option<IpAddr>,
        stations: &[SocketAddr],
        links: &mut Links,
    ) -> Result<Self, String> {
        let loopback = IpAddr::from(Ipv4Addr::LOCALHOST);
        let is_near = stations.iter().all(|station| station.ip().is_loopback());
        let usual = if is_near { loopback } else { Ipv4Addr::UNSPECIFIED.into() };
        let heard = at
            .is_none()
            .then(|| stations.iter().map(SocketAddr::ip).chain([loopback]).collect::<Vec<_>>());
        let at = at.unwrap_or(usual);
        let mut udp = Self { sockets: Vec::new(), homes: Vec::new(), heard, send_errors: 0 };
        for (local, remote) in
            [(18_570 + instance, STATIONS), (14_580 + instance, 14_540 + instance)]
        {
            let socket = UdpSocket::bind((at, local))
                .and_then(|socket| socket.set_nonblocking(true).map(|()| socket))
                .map_err(|e| format!("UDP port {local}: {e} (another instance? try --instance)"))?;
            let home = SocketAddr::from((Ipv4Addr::LOCALHOST, remote));
            // The programs' port of the tenth instance is the ground stations'.
            if !udp.homes.contains(&home) {
                links.call(udp.sockets.len(), home);
                udp.homes.push(home);
            }
            udp.sockets.push(socket);
        }
        for station in stations {
            if !udp.homes.contains(station) {
                links.call(0, *station);
                udp.homes.push(*station);
            }
        }
        Ok(udp)
    }

    /// Where the vehicle calls out to.
    #[must_use]
    pub fn homes(&self) -> &[SocketAddr] {
        &self.homes
    }

    fn hears(&self, from: IpAddr) -> bool {
        self.heard.as_ref().is_none_or(|heard| from.is_loopback() || heard.contains(&from))
    }

    /// All datagrams that have arrived.
    pub fn receive(&self, links: &mut Links) {
        let mut buffer = [0; LONGEST];
        for (port, socket) in self.sockets.iter().enumerate() {
            // An unreachable peer shows up here as an error once; it does not end the reading.
            for _ in 0..AT_ONCE {
                match socket.recv_from(&mut buffer) {
                    Ok((_, from)) if !self.hears(from.ip()) => {}
                    Ok((length, from)) => {
                        links.arrive(port, from, buffer.get(..length).unwrap_or(&[]));
                    }
                    Err(e) if e.kind() == io::ErrorKind::WouldBlock => break,
                    Err(_) => {}
                }
            }
        }
        links.expire();
    }

    /// To each what is for them.
    pub fn send(&mut self, links: &mut Links) {
        for peer in links.iter_mut() {
            let Some(socket) = self.sockets.get(peer.port) else { continue };
            for frame in peer.take_outbox() {
                if socket.send_to(&frame, peer.address).is_err() {
                    self.send_errors += 1;
                }
            }
        }
    }
}
