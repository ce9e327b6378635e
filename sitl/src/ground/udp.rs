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

#[cfg(test)]
mod tests {
    use super::*;

    /// Of this instance no other test is.
    const INSTANCE: u16 = 93;
    /// Of a network that is kept for examples.
    const STATION: [u8; 4] = [192, 0, 2, 7];
    const STRANGER: [u8; 4] = [192, 0, 2, 8];

    fn heard(at: Option<IpAddr>, stations: &[SocketAddr]) -> [bool; 3] {
        let udp = Udp::bind(INSTANCE, at, stations, &mut Links::new()).unwrap();
        [[127, 0, 0, 1], STATION, STRANGER].map(|address| udp.hears(IpAddr::from(address)))
    }

    /// One of this machine's addresses on a network, if it is on one. Nothing is sent.
    fn own_address() -> Option<IpAddr> {
        let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0)).ok()?;
        socket.connect((Ipv4Addr::from(STATION), 9)).ok()?;
        socket.local_addr().ok().map(|address| address.ip()).filter(|ip| !ip.is_loopback())
    }

    /// Peers after a datagram to a vehicle that calls this station, from here and from a network's address.
    fn peers(station: SocketAddr) -> Option<[usize; 2]> {
        let mut links = Links::new();
        let udp = Udp::bind(INSTANCE, None, &[station], &mut links).unwrap();
        let called = links.count();
        let mut say = |from: IpAddr| {
            let socket = UdpSocket::bind((from, 0)).unwrap();
            socket.send_to(b"x", (from, 18_570 + INSTANCE)).unwrap();
            std::thread::sleep(std::time::Duration::from_millis(50));
            udp.receive(&mut links);
            links.count() - called
        };
        Some([say(Ipv4Addr::LOCALHOST.into()), say(own_address()?)])
    }

    /// One test: its parts share the ports.
    #[test]
    fn bound_for_the_sake_of_one_station_the_vehicle_hears_no_stranger() {
        let station = SocketAddr::from((STATION, STATIONS));
        let any = IpAddr::from(Ipv4Addr::UNSPECIFIED);
        assert_eq!(heard(None, &[]), [true, false, false]);
        assert_eq!(heard(None, &[station]), [true, true, false]);
        assert_eq!(heard(Some(any), &[station]), [true, true, true]);
        assert_eq!(heard(Some(any), &[]), [true, true, true]);
        // The same over the wire, where there is one: another address of this machine is a stranger's.
        if let Some(peers) = peers(station) {
            assert_eq!(peers, [1, 1], "a stranger became a peer");
        }
        let own = own_address().map(|ip| peers(SocketAddr::new(ip, STATIONS)));
        if let Some(Some(peers)) = own {
            assert_eq!(peers, [1, 2], "the station that is called is no stranger");
        }
    }
}
