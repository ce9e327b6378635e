//! The simulator on the network: sockets, what may be read, and the key.

use super::Failure;
use crate::ground::{Files, Keys, Links, STATIONS, Udp};
use clap::Args;
use std::net::{IpAddr, SocketAddr, ToSocketAddrs};
use std::path::{Path, PathBuf};
use tautline_firmware::mavlink::Identity;

/// Options of the network.
#[derive(Debug, Args)]
pub struct NetworkOptions {
    /// Instance: shifts the UDP ports and the MAVLink system id
    #[arg(long, value_name = "I", default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=99))]
    pub instance: u16,
    /// Address of this machine at which others may speak to the vehicle; 0.0.0.0 = any [default: 127.0.0.1]
    #[arg(long, value_name = "ADDR")]
    pub bind: Option<IpAddr>,
    /// Call a ground station on another machine too; without a port, 14550 (repeatable)
    #[arg(long, value_name = "HOST[:PORT]", value_parser = station)]
    pub gcs: Vec<SocketAddr>,
    /// Only who signs with this key may ask, others may look: 32 bytes, or 64 hexadecimal digits
    #[arg(long, value_name = "FILE")]
    pub signing_key: Option<PathBuf>,
}

/// Of a simulated vehicle, by its instance.
fn uid(instance: u16) -> u64 {
    u64::from_be_bytes(*b"tautline").wrapping_add(u64::from(instance))
}

/// `--gcs`.
fn station(text: &str) -> Result<SocketAddr, String> {
    let has_port = text.parse::<SocketAddr>().is_ok()
        || (text.matches(':').count() == 1 && !text.ends_with(':'));
    let found = if has_port {
        text.to_socket_addrs()
    } else {
        (text.trim_matches(['[', ']']), STATIONS).to_socket_addrs()
    };
    let mut found = found.map_err(|e| format!("expected HOST or HOST:PORT ({e})"))?;
    // The vehicle's sockets speak IPv4.
    found.find(SocketAddr::is_ipv4).ok_or_else(|| "no IPv4 address".to_owned())
}

/// Open sockets.
pub struct Network {
    udp: Udp,
    keys: Option<Keys>,
}

impl Network {
    /// Opens them for `links`, who may read the logs of a folder.
    pub fn open(options: &NetworkOptions, logs: &Path, links: &mut Links) -> Result<Self, Failure> {
        let loaded = options.signing_key.as_deref().map(Keys::load).transpose();
        let (keys, signing) = loaded.map_err(Failure::Usage)?.unzip();
        links.files = Files::with_logs(logs);
        links.signing = signing;
        links.identity = Identity::new(uid(options.instance), env!("TAUTLINE_REVISION"));
        let udp = Udp::bind(options.instance, options.bind, &options.gcs, links);
        let udp = udp.map_err(Failure::Usage)?;
        Ok(Self { udp, keys })
    }

    /// Where the vehicle calls out to.
    pub fn homes(&self) -> &[SocketAddr] {
        self.udp.homes()
    }

    /// What has arrived.
    pub fn receive(&self, links: &mut Links) {
        self.udp.receive(links);
    }

    /// What is to go, and what is to be kept of the senders' times.
    pub fn send(&mut self, links: &mut Links) -> Result<(), Failure> {
        self.udp.send(links);
        self.keep(links, false)
    }

    /// The end: datagrams that could not be sent.
    pub fn close(mut self, links: &Links) -> Result<u64, Failure> {
        self.keep(links, true)?;
        Ok(self.udp.send_errors)
    }

    fn keep(&mut self, links: &Links, always: bool) -> Result<(), Failure> {
        match (&mut self.keys, &links.signing) {
            (Some(keys), Some(signing)) => keys.keep(signing, always).map_err(Failure::Run),
            _ => Ok(()),
        }
    }
}
