//! ArduPilot's JSON backend: a binary packet of pulses out, a line of JSON back, over UDP.

use super::px4::unit;
use super::{Command, Frame, LARGEST, SILENCE, START, WINCH_CHANNEL, Winch};
use crate::plant::{Truth, V3};
use crate::sensor::RANGE_OFFSET;
use nalgebra::{Quaternion, UnitQuaternion};
use serde::Deserialize;
use std::io::ErrorKind;
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr, ToSocketAddrs, UdpSocket};
use std::time::{Duration, Instant};

/// Of a packet with sixteen channels.
const MAGIC: u16 = 18_458;
const CHANNELS: usize = 16;
/// Frames per second that the firmware wants.
const FRAME_RATE: u16 = 1_000;
/// Pulse of a motor at rest, and what full throttle adds, µs.
const PULSE: (f64, f64) = (1_000.0, 1_000.0);
/// Pulse per tension of the winch, µs/N.
const PULSE_PER_NEWTON: f64 = 10.0;
/// A packet that nobody answers is sent again: the first until somebody listens, the others in case they were lost.
const POLL: Duration = Duration::from_millis(100);
const RESEND: Duration = Duration::from_secs(1);
const LONGEST: usize = 65_536;
/// Timestamp, s: seconds since 1970 are welcome.
const LATEST: f64 = 1e10;
/// Characters shown of a bad line.
const SHOWN: usize = 60;

#[derive(Debug, Deserialize)]
struct Line {
    timestamp: f64,
    imu: Imu,
    position: [f64; 3],
    attitude: Option<[f64; 3]>,
    quaternion: Option<[f64; 4]>,
    velocity: [f64; 3],
    rng_1: Option<f64>,
    battery: Option<Battery>,
    winch: Option<Reel>,
}

#[derive(Debug, Deserialize)]
struct Imu {
    gyro: [f64; 3],
    accel_body: [f64; 3],
}

#[derive(Debug, Deserialize)]
struct Battery {
    voltage: f64,
    #[serde(default)]
    current: f64,
}

#[derive(Debug, Deserialize)]
struct Reel {
    length: f64,
    #[serde(default)]
    tension: f64,
}

/// The last line of a datagram.
fn parse(datagram: &[u8]) -> Result<Frame, String> {
    let text = str::from_utf8(datagram).map_err(|_| "the answer is no text")?;
    let text = text.trim().lines().last().unwrap_or("");
    let line: Line = serde_json::from_str(text).map_err(|e| {
        let shown: String = text.chars().take(SHOWN).flat_map(char::escape_default).collect();
        format!("bad JSON: {e}: {shown}")
    })?;
    if !(0.0..LATEST).contains(&line.timestamp) {
        return Err(format!("timestamp is {}", line.timestamp));
    }
    let attitude = match (line.quaternion, line.attitude) {
        (Some([w, x, y, z]), _) => {
            unit(Quaternion::new(w, x, y, z)).ok_or("the quaternion is no rotation")?
        }
        (None, Some([roll, pitch, yaw])) => UnitQuaternion::from_euler_angles(roll, pitch, yaw),
        (None, None) => return Err("bad JSON: neither attitude nor quaternion".into()),
    };
    let position = V3::from(line.position);
    let down = (attitude * V3::z()).z;
    // Flat ground at the anchor's height, where nobody measures it.
    let flat = if down > 0.05 { -position.z / down - RANGE_OFFSET } else { f64::MAX };
    Ok(Frame {
        time_us: (line.timestamp * 1e6).round() as u64,
        accel: line.imu.accel_body.into(),
        gyro: line.imu.gyro.into(),
        height: None,
        range: Some(line.rng_1.unwrap_or(flat).clamp(0.0, 0.5 * LARGEST)),
        winch: line.winch.map(|reel| Winch { length: reel.length, tension: reel.tension }),
        battery: line.battery.map(|battery| (battery.voltage, battery.current)),
        truth: Some(Truth { position, velocity: line.velocity.into(), attitude }),
    })
}

fn packet(count: u32, command: &Command) -> Vec<u8> {
    let mut pulses = [0_u16; CHANNELS];
    for (pulse, throttle) in pulses.iter_mut().zip(command.throttle) {
        *pulse = (PULSE.0 + PULSE.1 * throttle).round() as u16;
    }
    if let Some(pulse) = pulses.get_mut(WINCH_CHANNEL) {
        *pulse = (PULSE.0 + PULSE_PER_NEWTON * command.winch).round() as u16;
    }
    let head = [MAGIC.to_le_bytes(), FRAME_RATE.to_le_bytes()].concat();
    let body = pulses.iter().flat_map(|pulse| pulse.to_le_bytes());
    head.into_iter().chain(count.to_le_bytes()).chain(body).collect()
}

/// Nothing yet, or Ctrl-C: the flight ends after this frame.
fn is_passing(kind: ErrorKind) -> bool {
    matches!(kind, ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}

/// The connection.
#[derive(Debug)]
pub(super) struct Json {
    socket: UdpSocket,
    count: u32,
    /// Of the last frame, µs.
    last_us: Option<u64>,
    buffer: Vec<u8>,
}

impl Json {
    pub(super) fn connect(at: &str) -> Result<Self, String> {
        let to = at.to_socket_addrs().map_err(|e| e.to_string())?.next().ok_or("no such host")?;
        let from = match to {
            SocketAddr::V4(_) => SocketAddr::from((Ipv4Addr::UNSPECIFIED, 0)),
            SocketAddr::V6(_) => SocketAddr::from((Ipv6Addr::UNSPECIFIED, 0)),
        };
        let connect = || {
            let socket = UdpSocket::bind(from)?;
            socket.connect(to)?;
            socket.set_read_timeout(Some(POLL))?;
            Ok(socket)
        };
        let socket = connect().map_err(|e: std::io::Error| e.to_string())?;
        Ok(Self { socket, count: 0, last_us: None, buffer: vec![0; LONGEST] })
    }

    pub(super) fn exchange(&mut self, command: &Command) -> Result<Frame, String> {
        let packet = packet(self.count, command);
        self.count = self.count.wrapping_add(1);
        let patience = if self.last_us.is_some() { SILENCE } else { START };
        let began = Instant::now();
        let mut sent: Option<Instant> = None;
        loop {
            if sent.is_none_or(|sent| sent.elapsed() > RESEND) {
                // Nobody listens yet: shows as an error of a later call, and is tried again.
                let _ = self.socket.send(&packet);
                sent = Some(Instant::now());
            }
            match self.socket.recv(&mut self.buffer) {
                Ok(length) => {
                    let frame = parse(self.buffer.get(..length).unwrap_or(&[]))?;
                    // The second answer to a packet that was sent twice.
                    if self.last_us != Some(frame.time_us) {
                        self.last_us = Some(frame.time_us);
                        return Ok(frame);
                    }
                }
                Err(e) if e.kind() == ErrorKind::ConnectionRefused => {
                    std::thread::sleep(POLL);
                    sent = None;
                }
                Err(e) if is_passing(e.kind()) => {}
                Err(e) => return Err(e.to_string()),
            }
            if began.elapsed() > patience {
                return Err(format!("no new frame for {} s", patience.as_secs()));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = r#"{"timestamp":1.5,"imu":{"gyro":[0.1,0,0],"accel_body":[0,0,-9.81]},
"position":[1,2,-3],"attitude":[0,0,0],"velocity":[0,0,0]}"#;

    fn refused(from: &str, to: &str) -> String {
        let text = GOOD.replace('\n', "").replace(from, to);
        let frame = parse(text.as_bytes());
        frame.and_then(|frame| frame.check()).unwrap_err()
    }

    #[test]
    fn the_last_line_is_read_with_what_is_optional() {
        let line = GOOD.replace('\n', "");
        let more = line.replace("}}", "}").replace(
            "\"velocity\"",
            "\"rng_1\":2.5,\"windvane\":{},\"winch\":{\"length\":9,\"speed\":0,\"tension\":6},\"velocity\"",
        );
        let frame = parse(format!("\n{line}\n{more}\n").as_bytes()).unwrap();
        assert_eq!(frame.time_us, 1_500_000);
        assert_eq!(frame.winch, Some(Winch { length: 9.0, tension: 6.0 }));
        assert!((frame.range.unwrap() - 2.5).abs() < 1e-12);
        let frame = parse(line.as_bytes()).unwrap();
        assert!((frame.range.unwrap() - 2.97).abs() < 1e-12 && frame.winch.is_none());
        assert!(frame.check().is_ok());
    }

    #[test]
    fn bad_lines_are_refused_in_one_line_that_says_why() {
        for (from, to, why) in [
            ("{", "", "bad JSON"),
            ("\"imu\"", "\"imv\"", "missing field `imu`"),
            ("1.5", "NaN", "bad JSON"),
            ("1.5", "-1.0", "timestamp is -1"),
            ("[1,2,-3]", "[1e300,2,-3]", "position is 1000"),
            ("[1,2,-3]", "[1,2]", "bad JSON"),
            ("\"attitude\"", "\"altitude\"", "neither attitude nor quaternion"),
            ("\"attitude\":[0,0,0]", "\"quaternion\":[0,0,0,0]", "no rotation"),
        ] {
            let got = refused(from, to);
            assert!(got.contains(why) && !got.contains('\n'), "{got:?} should contain {why:?}");
        }
        assert!(parse(&[0xff, 0xfe]).is_err() && parse(b"").is_err());
    }

    #[test]
    fn a_packet_has_the_backends_layout() {
        let sent = packet(7, &Command { throttle: [0.5; 8], winch: 6.5 });
        assert_eq!(sent.len(), 40);
        assert_eq!(sent[..8], [0x1a, 0x48, 0xe8, 3, 7, 0, 0, 0]);
        assert_eq!(sent[8..10], 1_500_u16.to_le_bytes());
        assert_eq!(sent[38..40], 1_065_u16.to_le_bytes());
    }
}
