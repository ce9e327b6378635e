//! MAVLink over UDP, on PX4's ports: 18570+i → 14550 for ground stations, 14580+i → 14540+i for
//! programs. The vehicle sends first; whoever answers is added.

use std::io;
use std::net::{Ipv4Addr, SocketAddr, UdpSocket};

/// Most peers per socket; the one that spoke least recently makes room.
const PEERS: usize = 8;
const LONGEST: usize = 2_048;
/// Datagrams taken per call and socket: a flood may not stop the world.
const AT_ONCE: usize = 256;

/// One socket and those it talks to, most recent first; the last is where it calls out to.
#[derive(Debug)]
struct Port {
    socket: UdpSocket,
    home: SocketAddr,
    peers: Vec<SocketAddr>,
}

/// Both sockets.
#[derive(Debug)]
pub struct Udp {
    ports: Vec<Port>,
    /// Datagrams that could not be sent.
    pub send_errors: u64,
}

impl Udp {
    /// Binds for instance `i`.
    ///
    /// # Errors
    /// A port that is taken, named.
    pub fn bind(instance: u16) -> Result<Self, String> {
        let port = |local: u16, remote: u16| {
            let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, local))
                .and_then(|socket| socket.set_nonblocking(true).map(|()| socket))
                .map_err(|e| format!("UDP port {local}: {e} (another instance? try --instance)"))?;
            let home = SocketAddr::from((Ipv4Addr::LOCALHOST, remote));
            Ok::<_, String>(Port { socket, home, peers: Vec::new() })
        };
        let ports =
            vec![port(18_570 + instance, 14_550)?, port(14_580 + instance, 14_540 + instance)?];
        Ok(Self { ports, send_errors: 0 })
    }

    /// Where the vehicle calls out to.
    #[must_use]
    pub fn homes(&self) -> Vec<SocketAddr> {
        self.ports.iter().map(|port| port.home).collect()
    }

    /// All datagrams that have arrived.
    pub fn receive(&mut self, mut each: impl FnMut(&[u8])) {
        let mut buffer = [0; LONGEST];
        for port in &mut self.ports {
            // An unreachable peer shows up here as an error once; it does not end the reading.
            for _ in 0..AT_ONCE {
                match port.socket.recv_from(&mut buffer) {
                    Ok((length, from)) => {
                        port.remember(from);
                        each(buffer.get(..length).unwrap_or(&[]));
                    }
                    Err(e) if e.kind() == io::ErrorKind::WouldBlock => break,
                    Err(_) => {}
                }
            }
        }
    }

    /// To everybody.
    pub fn send(&mut self, frame: &[u8]) {
        for port in &self.ports {
            let others = port.peers.iter().filter(|peer| **peer != port.home);
            for peer in others.chain([&port.home]) {
                if port.socket.send_to(frame, peer).is_err() {
                    self.send_errors += 1;
                }
            }
        }
    }
}

impl Port {
    fn remember(&mut self, peer: SocketAddr) {
        if self.peers.first() == Some(&peer) {
            return;
        }
        self.peers.retain(|known| *known != peer);
        self.peers.insert(0, peer);
        self.peers.truncate(PEERS);
    }
}
